#!/usr/bin/env python3
"""Limits that can change while the node runs."""
import rospy
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 4.0)
        floor = rospy.get_param("~floor", -4.0)
        if rospy.get_param("~strict", False):
            floor = 0.0
        self.floor = floor
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)
        self.limit_sub = rospy.Subscriber("limit", Float64, self.on_limit)

    def on_limit(self, msg):
        self.limit = msg.data

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg.data)
        if msg.data < self.floor:
            self.pub.publish(self.floor)


if __name__ == "__main__":
    rospy.init_node("val_maybe_overwritten")
    node = Node()
    rospy.spin()
