#!/usr/bin/env python3
"""Looks at places of comparisons: lines and columns."""
import rospy
from std_msgs.msg import Float64, String


class Places:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 7.0)
        self.low = rospy.get_param("~low", -5.0)
        self.high = rospy.get_param("~high", 5.0)
        self.far = rospy.get_param("~far", 8.0)
        self.shown = rospy.get_param("~shown", 1.0)
        self.pub = rospy.Publisher("output", String, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v = msg.data
        if v > self.limit or -v > self.limit: self.pub.publish("outside")
        if (
            v
            > self.low
            and (v
                 < self.high)
        ):
            self.pub.publish("inside")
        größe = abs(v); self.pub.publish("weit" if größe > self.far else "für nah")
        if v \
                > self.shown:
            rospy.logdebug("shown")


if __name__ == "__main__":
    rospy.init_node("cmp_many_lines")
    places = Places()
    rospy.spin()
