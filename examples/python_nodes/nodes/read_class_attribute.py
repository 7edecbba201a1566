#!/usr/bin/env python3
"""Limits that all instances share."""
import rospy
from std_msgs.msg import Float64

rospy.init_node("read_class_attribute")


class Filter:
    limit = rospy.get_param("filter/limit", 4.0)
    dead = rospy.get_param("filter/dead", 1.0)
    cap = rospy.get_param("filter/cap", 9.0)

    def __init__(self):
        self.cap = 8.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if abs(msg.data) <= Filter.dead:
            return
        if msg.data >= self.limit:
            self.pub.publish(msg.data)
        if msg.data > self.cap:
            self.pub.publish(self.cap)


filter_node = Filter()
rospy.spin()
