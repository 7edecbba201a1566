#!/usr/bin/env python3
"""Publishes first, then decides how much of the bookkeeping is worth it."""
import rospy
from std_msgs.msg import Float64


class Recorder:
    def __init__(self):
        self.boring = rospy.get_param("~boring", 2.0)
        self.history = rospy.get_param("~history", 50)
        self.seen = []
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.pub.publish(msg)
        if abs(msg.data) < self.boring:
            return
        self.seen.append(msg.data)
        if len(self.seen) > self.history:
            self.seen.pop(0)
        rospy.logdebug("remembered %d", len(self.seen))


if __name__ == "__main__":
    rospy.init_node("ctl_return_after_publish")
    recorder = Recorder()
    rospy.spin()
