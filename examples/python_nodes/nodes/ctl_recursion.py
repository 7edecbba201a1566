#!/usr/bin/env python3
"""Halves values until they are small."""
import rospy
from std_msgs.msg import Float64


class Halver:
    def __init__(self):
        self.smallest = rospy.get_param("~smallest", 1.0)
        self.deepest = rospy.get_param("~deepest", 5)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def halve(self, value):
        if abs(value) < self.smallest:
            return
        self.pub.publish(value)
        self.halve(value / 2)

    def depth(self, value, level=0):
        if level >= self.deepest or value == 0:
            return level
        return self.depth(int(value / 2), level + 1)

    def on_input(self, msg):
        self.halve(msg.data)
        rospy.logdebug("depth %d", self.depth(msg.data))


if __name__ == "__main__":
    rospy.init_node("ctl_recursion")
    halver = Halver()
    rospy.spin()
