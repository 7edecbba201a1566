#!/usr/bin/env python3
"""Limits that stand in lists and dicts."""
import rospy
from std_msgs.msg import Float64


class Lists:
    def __init__(self):
        limits = rospy.get_param("~limits", {"low": -2.0, "high": {"soft": 4.0}})
        self.limits = limits
        self.steps = rospy.get_param("~steps", [1.0, 3.0])
        self.first, self.second = rospy.get_param("~pair", [5.0, -5.0])
        self.shown = rospy.get_param("~shown", {"most": 1.0})
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v = msg.data
        if v < self.limits["low"]:
            self.pub.publish(1.0)
        if v > self.limits["high"]["soft"]:
            self.pub.publish(2.0)
        if v > self.steps[0]:
            self.pub.publish(3.0)
        if v > self.steps[-1] * abs(msg.data):
            self.pub.publish(4.0)
        if v > self.first:
            self.pub.publish(5.0)
        for step in self.steps:
            if v == step:
                self.pub.publish(6.0)
        if v > self.shown["most"]:
            rospy.logdebug("high")


if __name__ == "__main__":
    rospy.init_node("read_lists")
    lists = Lists()
    rospy.spin()
