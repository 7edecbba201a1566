#!/usr/bin/env python3
"""Limits that grow with what was seen before."""
import rospy
from std_msgs.msg import Float64


class Scaled:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 1.5)
        self.margin = rospy.get_param("~margin", 0.5)
        self.goal = rospy.get_param("~goal", 3.0)
        self.slack = rospy.get_param("~slack", 0.2)
        self.tolerance = rospy.get_param("~tolerance", 0.4)
        self.low = rospy.get_param("~low", 1.0)
        self.span = rospy.get_param("~span", 2.0)
        self.gain = rospy.get_param("~gain", 2.0)
        self.rate = rospy.get_param("~rate", 0.5)
        self.mean = rospy.get_param("~mean", 1.0)
        self.shown = rospy.get_param("~shown", 1.0)
        self.previous = 0.0
        self.total = 0.0
        self.ceiling = 0.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v = msg.data
        if v > self.limit * self.previous:
            self.pub.publish(1.0)
        if v < (1 + self.margin) * self.previous - 2:
            self.pub.publish(2.0)
        if v - self.goal > 0:
            self.pub.publish(3.0)
        if abs(v - self.previous) > self.tolerance * abs(self.previous):
            self.pub.publish(4.0)
        if v > self.low + self.span:
            self.pub.publish(5.0)
        if v > self.ceiling:
            self.pub.publish(6.0)
        self.ceiling = self.previous + self.slack
        if self.gain * v > 10:
            self.pub.publish(7.0)
        self.total += self.rate * v
        if self.total > self.previous:
            self.pub.publish(8.0)
        level = 0.5 * self.mean + 0.5 * v
        if v > level:
            self.pub.publish(9.0)
        if v > self.shown * self.previous:
            rospy.logdebug("above")
        self.previous = v


if __name__ == "__main__":
    rospy.init_node("drv_formulas")
    scaled = Scaled()
    rospy.spin()
