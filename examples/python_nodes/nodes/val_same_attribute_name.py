#!/usr/bin/env python3
"""The same words for different things."""
import rospy
from std_msgs.msg import Float64


class Monitor:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 3.0)

    def check(self, value):
        if value > self.limit:
            rospy.logdebug("above")


class Sender:
    def __init__(self):
        self.limit = 5.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)

    def check(self, value):
        if value > self.limit:
            self.pub.publish(value)


class Node:
    def __init__(self):
        self.monitor = Monitor()
        self.sender = Sender()
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.monitor.check(msg.data)
        self.sender.check(msg.data)


if __name__ == "__main__":
    rospy.init_node("val_same_attribute_name")
    node = Node()
    rospy.spin()
