#!/usr/bin/env python3
"""Levels are objects that compare themselves."""
import functools

import rospy
from std_msgs.msg import Float64


@functools.total_ordering
class Level:
    def __init__(self, value):
        self.value = value

    def __eq__(self, other):
        return isinstance(other, Level) and self.value == other.value

    def __lt__(self, other):
        return self.value < other.value

    __hash__ = None


class Gate:
    def __init__(self, threshold):
        self.threshold = threshold
        self.current = 0.0

    def __bool__(self):
        return self.current >= self.threshold


class Node:
    def __init__(self):
        self.limit = Level(rospy.get_param("~limit", 5.0))
        self.gate = Gate(rospy.get_param("~gate", 2.0))
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if Level(msg.data) < self.limit:
            self.pub.publish(msg.data)
        self.gate.current = abs(msg.data)
        if self.gate:
            self.pub.publish(self.gate.current)


if __name__ == "__main__":
    rospy.init_node("cmp_own_class")
    node = Node()
    rospy.spin()
