#!/usr/bin/env python3
"""Limits in units of their own."""
import rospy
from std_msgs.msg import Float64, Int32


class Units:
    def __init__(self):
        self.height = rospy.get_param("height_cm", 300.0) / 100.0
        self.fahrenheit = 1.8 * rospy.get_param("celsius", -20.0) + 32
        self.fraction = 0.01 * rospy.get_param("percent", 50)
        margin = rospy.get_param("margin", 2.0)
        self.inner = 10.0 - margin
        self.band = rospy.get_param("band", 6.0)
        self.half = rospy.get_param("half_count", 1)
        grown = rospy.get_param("grown", 1.0)
        grown += 3
        grown *= 2
        self.grown = grown
        self.shown = 2 * rospy.get_param("shown", 1.0)
        self.count = 0
        self.pub = rospy.Publisher("output", Int32, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v, code = msg.data, 0
        if v > self.height:
            code += 1
        if v < self.fahrenheit:
            code += 2
        if abs(v) / 10.0 > self.fraction:
            code += 4
        if v >= self.inner:
            code += 8
        if v < -self.band:
            code += 16
        if self.grown < v:
            code += 32
        if v > self.shown:
            rospy.logdebug("shown")
        self.count += 1
        if self.count >= 2 * self.half + 1:
            self.count = 0
            self.pub.publish(code)


if __name__ == "__main__":
    rospy.init_node("drv_affine")
    units = Units()
    rospy.spin()
