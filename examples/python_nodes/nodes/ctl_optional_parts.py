#!/usr/bin/env python3
"""Builds itself as its parameters say."""
import sys

import rospy
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        self.square_pub = None
        if rospy.get_param("~squares", True):
            self.square_pub = rospy.Publisher("squares", Float64, queue_size=1000)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        if rospy.get_param("~relay", True):
            self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if self.square_pub is not None:
            self.square_pub.publish(msg.data * msg.data)
        self.pub.publish(msg.data)


def main():
    rospy.init_node("ctl_optional_parts")
    low, high = rospy.get_param("~low", -1.0), rospy.get_param("~high", 1.0)
    if low >= high:
        rospy.logfatal("low has to be below high")
        sys.exit(1)
    if rospy.get_param("~banner", False):
        rospy.loginfo("between %f and %f", low, high)
    node = Node()
    rospy.spin()
    del node


if __name__ == "__main__":
    main()
