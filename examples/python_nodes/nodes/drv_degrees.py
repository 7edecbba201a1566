#!/usr/bin/env python3
"""Limits an angle that comes in radians."""
import math

import rospy
from std_msgs.msg import Float64

TO_RADIANS = math.pi / 180.0


def to_radians(degrees):
    return degrees * math.pi / 180


class Joint:
    def __init__(self):
        self.highest = math.radians(rospy.get_param("~highest", 120.0))
        self.lowest = rospy.get_param("~lowest", -120.0) * TO_RADIANS
        self.tolerance = to_radians(rospy.get_param("~tolerance", 5.0))
        self.shown = math.degrees(rospy.get_param("~shown", 1.0))
        self.target = 1.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        angle = msg.data / 3.0
        if angle > self.highest:
            return
        if angle < self.lowest:
            return
        if math.degrees(angle) > self.shown:
            rospy.logdebug("shown")
        if abs(angle - self.target) <= self.tolerance:
            return
        self.pub.publish(angle)


if __name__ == "__main__":
    rospy.init_node("drv_degrees")
    joint = Joint()
    rospy.spin()
