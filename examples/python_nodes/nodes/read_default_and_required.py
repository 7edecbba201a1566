#!/usr/bin/env python3
"""Thins samples out and passes on those outside of a band."""
import rospy
from std_msgs.msg import Float64


class Band:
    def __init__(self):
        self.upper = rospy.get_param("~upper", 2.0)
        self.lower = rospy.get_param("~lower")
        self.every = rospy.get_param("every", default=2)
        self.quiet = rospy.get_param("/fleet/quiet", False)
        self.title = rospy.get_param("~title", "band")
        self.count = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if self.quiet:
            return
        self.count += 1
        if self.count < self.every:
            return
        self.count = 0
        if msg.data > self.upper or msg.data < self.lower:
            self.pub.publish(msg)
        if self.title != "band":
            rospy.logdebug(self.title)


if __name__ == "__main__":
    rospy.init_node("read_default_and_required")
    band = Band()
    rospy.spin()
