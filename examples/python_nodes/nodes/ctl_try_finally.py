#!/usr/bin/env python3
"""Checks samples by exceptions."""
import rospy
from std_msgs.msg import Float64, String


class TooHigh(Exception):
    """A sample was above the limit."""


class Checker:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 5.0)
        self.noted = rospy.get_param("~noted", 0.0)
        self.notes = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.fault_pub = rospy.Publisher("faults", String, queue_size=1000)
        self.all_pub = rospy.Publisher("all", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        try:
            if msg.data > self.limit:
                raise TooHigh("above the limit")
            self.pub.publish(msg.data)
        except TooHigh as error:
            self.fault_pub.publish(str(error))
        try:
            if msg.data < self.noted:
                self.notes += 1
        finally:
            self.all_pub.publish(msg.data)


if __name__ == "__main__":
    rospy.init_node("ctl_try_finally")
    checker = Checker()
    rospy.spin()
