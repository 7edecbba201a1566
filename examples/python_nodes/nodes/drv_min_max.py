#!/usr/bin/env python3
"""Keeps its limits within bounds."""
import rospy
from std_msgs.msg import Float64


class Bounded:
    def __init__(self):
        self.high = min(rospy.get_param("high", 12.0), 8.0)
        self.low = max(-8.0, rospy.get_param("low", -12.0))
        self.depth = abs(rospy.get_param("depth", -6.0))
        self.both = max(1.0, min(5.0, rospy.get_param("both", 3.0)))
        self.shown = max(rospy.get_param("shown", 1.0), 0.5)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v = msg.data
        if v > self.high:
            return
        if v < self.low:
            return
        if v < -self.depth:
            v = -self.depth
        if v > self.both:
            v = self.both
        if v > self.shown:
            rospy.logdebug("shown")
        self.pub.publish(v)


if __name__ == "__main__":
    rospy.init_node("drv_min_max")
    bounded = Bounded()
    rospy.spin()
