#!/usr/bin/env python3
"""Compares squared distances."""
import math

import rospy
from std_msgs.msg import Float64


def squared(x):
    return x * x


class Distance:
    def __init__(self):
        self.radius_sq = rospy.get_param("radius", 8.0) ** 2
        self.near = rospy.get_param("near", 1.0)
        self.far = rospy.get_param("far", 9.0)
        self.deviation = math.sqrt(rospy.get_param("variance", 4.0))
        self.shown = math.pow(rospy.get_param("shown", 2.0), 2)
        self.mean = 0.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        sq = msg.data**2
        if sq < math.pow(self.near, 2):
            return
        if sq > squared(self.far):
            return
        if sq < self.radius_sq:
            self.pub.publish(sq)
        if sq > self.shown:
            rospy.logdebug("shown")
        self.mean = 0.9 * self.mean + 0.1 * msg.data
        if abs(msg.data - self.mean) > self.deviation:
            self.pub.publish(self.mean)


if __name__ == "__main__":
    rospy.init_node("drv_squares")
    distance = Distance()
    rospy.spin()
