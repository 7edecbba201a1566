#!/usr/bin/env python3
"""Passes on what exceeds a limit."""
import rospy
from std_msgs.msg import Float64


class Gate:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 3.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)


if __name__ == "__main__":
    rospy.init_node("ctl_direct_if")
    gate = Gate()
    rospy.spin()
