#!/usr/bin/env python3
"""Keeps its limits in messages."""
import rospy
from geometry_msgs.msg import Point
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        self.limit = Float64(data=rospy.get_param("~limit", 4.0))
        self.corner = Point()
        self.corner.x = rospy.get_param("~corner_x", -4.0)
        self.corner.y = rospy.get_param("~corner_y", 0.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > self.limit.data:
            self.pub.publish(self.limit)
        if msg.data < self.corner.x:
            self.pub.publish(self.corner.x)
        if msg.data < self.corner.y:
            rospy.logdebug("below the corner")
        if msg.data > self.corner.z:
            self.pub.publish(msg)


if __name__ == "__main__":
    rospy.init_node("val_message_field")
    node = Node()
    rospy.spin()
