#!/usr/bin/env python3
"""A skeleton with hooks."""
from abc import ABC, abstractmethod

import rospy
from std_msgs.msg import Float64


class Skeleton(ABC):
    def __init__(self):
        self.lowest = rospy.get_param("~lowest", -7.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if self.accepts(msg.data):
            self.pub.publish(self.changed(msg.data))
        self.after(msg.data)

    def accepts(self, value):
        return value > self.lowest

    @abstractmethod
    def changed(self, value):
        """What is published for a value."""

    def after(self, value):
        """Called at the end."""


class Clipper(Skeleton):
    def __init__(self):
        self.highest = rospy.get_param("~highest", 7.0)
        self.ceiling = rospy.get_param("~ceiling", 3.0)
        self.shown = rospy.get_param("~shown", 0.0)
        super().__init__()

    def accepts(self, value):
        return super().accepts(value) and value < self.highest

    def changed(self, value):
        if value > self.ceiling:
            return self.ceiling
        return value

    def after(self, value):
        if value > self.shown:
            rospy.logdebug("shown")


if __name__ == "__main__":
    rospy.init_node("val_template_method")
    clipper = Clipper()
    rospy.spin()
