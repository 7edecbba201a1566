#!/usr/bin/env python3
"""Compares samples with the entries of one map of parameters."""
import rospy
from std_msgs.msg import Float64, String

DEFAULTS = {"low": -4.0, "high": 4.0, "note": 0.0, "inner": {"dead": 1.0}}


class Levels:
    def __init__(self):
        self.limits = rospy.get_param("~limits", DEFAULTS)
        self.high = self.limits.get("high", 4.0)
        inner = self.limits["inner"]
        self.dead = inner["dead"]
        self.pub = rospy.Publisher("output", String, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if abs(msg.data) < self.dead:
            return
        if msg.data < self.limits["low"]:
            self.pub.publish("low")
        if msg.data > self.high:
            self.pub.publish("high")
        if msg.data > self.limits["note"]:
            rospy.logdebug("positive")


if __name__ == "__main__":
    rospy.init_node("read_dict")
    levels = Levels()
    rospy.spin()
