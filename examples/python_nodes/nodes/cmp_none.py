#!/usr/bin/env python3
"""Limits that need not be there."""
import rospy
from std_msgs.msg import Float64


class Optional:
    def __init__(self):
        self.limit = rospy.get_param("~limit", None)
        self.floor = rospy.get_param("~floor", None)
        self.shown = rospy.get_param("~shown", None)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if self.floor is None:
            self.pub.publish(0.0)
        if self.limit is not None and msg.data > self.limit:
            self.pub.publish(self.limit)
        if self.shown is not None:
            rospy.logdebug("shown: %s", self.shown)


if __name__ == "__main__":
    rospy.init_node("cmp_none")
    optional = Optional()
    rospy.spin()
