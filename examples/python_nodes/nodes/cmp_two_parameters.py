#!/usr/bin/env python3
"""Checks its limits against each other."""
import rospy
from std_msgs.msg import Float64


class Limits:
    def __init__(self):
        self.lower = rospy.get_param("lower", -1.0)
        self.upper = rospy.get_param("upper", 1.0)
        warm, cold = rospy.get_param("warm", 3.0), rospy.get_param("cold", 2.0)
        self.usable = True
        if self.lower >= self.upper:
            self.usable = False
        if warm > cold:
            rospy.loginfo("warm is above cold")
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if self.usable:
            self.pub.publish(msg.data)


if __name__ == "__main__":
    rospy.init_node("cmp_two_parameters")
    limits = Limits()
    rospy.spin()
