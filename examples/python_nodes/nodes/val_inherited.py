#!/usr/bin/env python3
"""The base class has the limits and the publisher."""
import rospy
from std_msgs.msg import Float64


class Base:
    def __init__(self, limit_name):
        self.limit = rospy.get_param("~limit", 3.0)
        self.floor = rospy.get_param(limit_name, -3.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        raise NotImplementedError

    def emit(self, value):
        self.pub.publish(value)


class Middle(Base):
    def is_below(self, value):
        return value < self.floor


class Derived(Middle):
    def __init__(self):
        super().__init__("~floor")
        self.shown = rospy.get_param("~shown", 0.0)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.emit(msg.data)
        if self.is_below(msg.data):
            super().emit(self.floor)
        if msg.data > self.shown:
            rospy.logdebug("shown")


if __name__ == "__main__":
    rospy.init_node("val_inherited")
    derived = Derived()
    rospy.spin()
