#!/usr/bin/env python3
"""Values from the parameter server, or from here."""
import rospy
from std_msgs.msg import Float64


def read(name, default):
    try:
        return rospy.get_param(name)
    except KeyError:
        rospy.logdebug("%s is not set", name)
        return default


class Node:
    def __init__(self):
        try:
            self.limit = rospy.get_param("~limit")
        except KeyError:
            self.limit = 4.0
        self.floor = read("~floor", -4.0)
        self.noted = read("~noted", 0.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(self.limit)
        if msg.data < self.floor:
            self.pub.publish(self.floor)
        if msg.data > self.noted:
            rospy.logdebug("noted")


if __name__ == "__main__":
    rospy.init_node("read_key_error")
    node = Node()
    rospy.spin()
