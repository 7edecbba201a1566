#!/usr/bin/env python3
"""Lets the library compare."""
import math
import operator

import rospy
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        self.ceiling = rospy.get_param("~ceiling", 5.0)
        self.target = rospy.get_param("~target", 1.0)
        self.limit = rospy.get_param("~limit", 3.0)
        self.floor = rospy.get_param("~floor", -5.0)
        self.noted = rospy.get_param("~noted", 0.0)
        self.values = []
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.pub.publish(min(msg.data, self.ceiling))
        if math.isclose(msg.data, self.target, abs_tol=0.5):
            self.pub.publish(self.target)
        if operator.gt(msg.data, self.limit):
            self.pub.publish(self.limit)
        self.values = [*self.values[-3:], msg.data]
        for value in filter(lambda one: one < self.floor, self.values):
            self.pub.publish(value)
        rospy.logdebug("%f", max(msg.data, self.noted))


if __name__ == "__main__":
    rospy.init_node("cmp_inside_library")
    node = Node()
    rospy.spin()
