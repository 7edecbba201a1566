#!/usr/bin/env python3
"""Limits and routes samples by conditional expressions."""
import rospy
from std_msgs.msg import Float64


class Router:
    def __init__(self):
        self.upper = rospy.get_param("upper", 6.0)
        self.lower = rospy.get_param("lower", -6.0)
        self.split = rospy.get_param("split", 0.0)
        self.note = rospy.get_param("note", 1.0)
        self.a_pub = rospy.Publisher("a", Float64, queue_size=1000)
        self.b_pub = rospy.Publisher("b", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v = msg.data
        limited = self.upper if v > self.upper else -1.0 if v < self.lower else v
        pub = self.a_pub if self.split >= v else self.b_pub
        word = "much" if v > self.note else "little"
        pub.publish(limited)
        rospy.logdebug(word)


if __name__ == "__main__":
    rospy.init_node("ctl_ternary")
    router = Router()
    rospy.spin()
