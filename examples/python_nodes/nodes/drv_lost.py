#!/usr/bin/env python3
"""Limits that follow the input."""
import rospy
from std_msgs.msg import Float64


class Adaptive:
    def __init__(self):
        self.gain = rospy.get_param("~gain", 1.5)
        self.bias = rospy.get_param("~bias", 2.0)
        self.total = rospy.get_param("~first", 3.0) + rospy.get_param("~second", 4.0)
        self.level = rospy.get_param("~start", 1.0)
        self.every = rospy.get_param("~every", 3)
        self.previous = 0.0
        self.count = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v = msg.data
        if v > self.gain * self.previous:
            self.pub.publish(1.0)
        if v < self.previous - self.bias:
            self.pub.publish(2.0)
        if abs(v) > self.total:
            self.pub.publish(3.0)
        self.count += 1
        if self.count % self.every == 0:
            self.pub.publish(4.0)
        level = 0.5 * self.level + 0.5 * v
        if v > level:
            self.pub.publish(level)
        self.previous = v


if __name__ == "__main__":
    rospy.init_node("drv_lost")
    adaptive = Adaptive()
    rospy.spin()
