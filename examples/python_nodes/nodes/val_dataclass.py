#!/usr/bin/env python3
"""Limits in a dataclass."""
from dataclasses import dataclass, field

import rospy
from std_msgs.msg import Float64


@dataclass
class Limits:
    low: float
    high: float = 5.0
    steps: list = field(default_factory=list)
    note: float = 1.0

    def is_inside(self, value):
        return self.low <= value


class Node:
    def __init__(self):
        self.limits = Limits(
            low=rospy.get_param("~low", -5.0),
            high=rospy.get_param("~high", 5.0),
            note=rospy.get_param("~note", 2.0),
        )
        self.fixed = Limits(-1.0, 1.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if not self.limits.is_inside(msg.data):
            return
        if msg.data > self.limits.high:
            self.pub.publish(self.limits.high)
        if msg.data > self.limits.note:
            rospy.logdebug("noted %d", len(self.limits.steps))
        self.pub.publish(msg.data)


if __name__ == "__main__":
    rospy.init_node("val_dataclass")
    node = Node()
    rospy.spin()
