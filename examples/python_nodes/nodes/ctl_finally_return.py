#!/usr/bin/env python3
"""Publishes in finally, whatever happened before."""
import rospy
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 3.0)
        self.floor = rospy.get_param("~floor", -3.0)
        self.small = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        try:
            if msg.data > self.limit:
                return
            self.small += 1
            if msg.data < self.floor:
                return
            rospy.logdebug("small ones: %d", self.small)
        finally:
            self.pub.publish(msg.data)


if __name__ == "__main__":
    rospy.init_node("ctl_finally_return")
    node = Node()
    rospy.spin()
