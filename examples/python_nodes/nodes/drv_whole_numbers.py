#!/usr/bin/env python3
"""Counts in whole numbers."""
import math

import rospy
from std_msgs.msg import Float64, Int32


class Whole:
    def __init__(self):
        self.size = int(rospy.get_param("~seconds", 0.35) * 10)
        self.half = rospy.get_param("~window", 7) // 2
        self.level = math.floor(rospy.get_param("~level", 4.5))
        self.near = round(rospy.get_param("~near", 1.4))
        self.limit = float(rospy.get_param("~limit", 8))
        self.shown = int(rospy.get_param("~shown", 2.5))
        self.count = 0
        self.pub = rospy.Publisher("output", Int32, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.count += 1
        if self.count >= self.size:
            self.count = 0
            self.pub.publish(1)
        if self.count == self.half:
            self.pub.publish(2)
        if msg.data > self.level:
            self.pub.publish(3)
        if abs(int(msg.data)) <= self.near:
            self.pub.publish(4)
        if msg.data > self.limit:
            self.pub.publish(5)
        if msg.data > self.shown:
            rospy.logdebug("shown")


if __name__ == "__main__":
    rospy.init_node("drv_whole_numbers")
    whole = Whole()
    rospy.spin()
