#!/usr/bin/env python3
"""The checks run, what they say is not asked for."""
import rospy
from std_msgs.msg import Float64


def is_high(value, limit):
    return value > limit


def describe(value, limit):
    return f"{value} of {limit}"


def choose(value, limit):
    del limit
    return value > 2.0


class Node:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 3.0)
        self.high = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        is_high(msg.data, self.limit)
        if is_high(msg.data, self.limit):
            self.high += 1
        rospy.logdebug("%s, %d", describe(msg.data, self.limit), self.high)
        if choose(msg.data, self.limit):
            self.pub.publish(msg.data)


if __name__ == "__main__":
    rospy.init_node("val_argument_unused")
    node = Node()
    rospy.spin()
