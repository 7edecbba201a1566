#!/usr/bin/env python3
"""Reads four parameters and uses none of them in a decision about what is published."""
import rospy
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        rospy.get_param("~ignored", 1.0)
        limit = rospy.get_param("~limit", 2.0)
        limit = 4.0
        self.limit = limit
        self.offset = rospy.get_param("~offset", 0.5)
        self.rate = rospy.get_param("~rate", 10)
        rospy.loginfo("rate %d", self.rate)
        self.floor = rospy.get_param("~floor", -1.0)
        self.floor = -5.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg.data + self.offset)
        if self.rate > 100:
            rospy.logdebug("a high rate")
        elif msg.data < -9.0:
            rospy.logdebug("low")


if __name__ == "__main__":
    rospy.init_node("read_discarded")
    node = Node()
    rospy.spin()
