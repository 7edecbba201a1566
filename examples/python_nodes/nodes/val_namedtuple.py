#!/usr/bin/env python3
"""Three kinds of small records."""
from collections import namedtuple
from types import SimpleNamespace
from typing import NamedTuple

import rospy
from std_msgs.msg import Float64


class Band(NamedTuple):
    low: float
    high: float


Pair = namedtuple("Pair", ["first", "second"])


class Node:
    def __init__(self):
        self.band = Band(rospy.get_param("~low", -6.0), rospy.get_param("~high", 6.0))
        self.pair = Pair(first=rospy.get_param("~first", 8.0), second=2.0)
        self.more = SimpleNamespace(step=rospy.get_param("~step", 4.0), last=0.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        low, high = self.band
        if msg.data < low:
            self.pub.publish(low)
        if msg.data > self.band.high:
            self.pub.publish(high)
        if abs(msg.data - self.more.last) > self.more.step:
            self.pub.publish(msg.data)
        self.more.last = msg.data
        if msg.data > self.pair.first:
            rospy.logdebug("first")
        if msg.data > self.pair.second:
            self.pub.publish(self.pair.second)


if __name__ == "__main__":
    rospy.init_node("val_namedtuple")
    node = Node()
    rospy.spin()
