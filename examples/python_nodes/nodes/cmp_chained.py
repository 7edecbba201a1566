#!/usr/bin/env python3
"""Bands are written as in mathematics."""
import rospy
from std_msgs.msg import Float64


class Bands:
    def __init__(self):
        self.low = rospy.get_param("~low", -6.0)
        self.high = rospy.get_param("~high", 6.0)
        self.middle = rospy.get_param("~middle", 2.0)
        self.bottom = rospy.get_param("~bottom", -9.0)
        self.top = rospy.get_param("~top", 9.0)
        self.last = 0.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v, last = msg.data, self.last
        if self.low < v < self.high:
            self.pub.publish(v)
        if last <= self.middle <= v:
            self.pub.publish(self.middle)
        if not self.bottom <= v:
            rospy.logdebug("below the bottom")
        self.last = v if -8.0 < v <= self.top != 0.0 else 0.0


if __name__ == "__main__":
    rospy.init_node("cmp_chained")
    bands = Bands()
    rospy.spin()
