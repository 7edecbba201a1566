#!/usr/bin/env python3
"""Reads again for each sample, and a parameter of some namespace above."""
import rospy
from std_msgs.msg import Float64


class Reader:
    def __init__(self):
        name = rospy.search_param("padding") or "padding"
        self.padding = rospy.get_param(name, 6.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        if rospy.has_param("~start"):
            self.pub.publish(0.0)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        limit = rospy.get_param_cached("~limit", 3.0)
        if msg.data > limit:
            self.pub.publish(msg)
        if msg.data < rospy.get_param("~lowest", -3.0):
            self.pub.publish(-3.0)
        if abs(msg.data) > self.padding:
            self.pub.publish(0.0)


if __name__ == "__main__":
    rospy.init_node("read_cached_and_searched")
    reader = Reader()
    rospy.spin()
