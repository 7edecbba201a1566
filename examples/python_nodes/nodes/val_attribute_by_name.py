#!/usr/bin/env python3
"""Attributes are made of the names of parameters."""
import rospy
from std_msgs.msg import Float64


class Settings:
    pass


class Node:
    def __init__(self):
        self.settings = Settings()
        for name, default in (("high", 5.0), ("low", -5.0)):
            setattr(self.settings, name, rospy.get_param("~" + name, default))
        setattr(self, "step", rospy.get_param("~step", 3.0))
        setattr(self, "noted", rospy.get_param("~noted", 1.0))
        self.last = 0.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if abs(msg.data - self.last) > self.step:
            self.pub.publish(msg)
        self.last = msg.data
        if msg.data > self.settings.high:
            self.pub.publish(1.0)
        if msg.data < getattr(self.settings, "low"):
            self.pub.publish(-1.0)
        if msg.data > getattr(self, "noted", 0.0):
            rospy.logdebug("noted")


if __name__ == "__main__":
    rospy.init_node("val_attribute_by_name")
    node = Node()
    rospy.spin()
