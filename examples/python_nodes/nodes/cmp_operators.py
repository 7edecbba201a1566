#!/usr/bin/env python3
"""Compares with six limits."""
import rospy
from std_msgs.msg import Float64, Int32


class Comparisons:
    def __init__(self):
        self.a = rospy.get_param("a", 8.0)
        self.b = rospy.get_param("b", 6.0)
        self.c = rospy.get_param("c", -8.0)
        self.d = rospy.get_param("d", -6.0)
        self.e = rospy.get_param("e", 1)
        self.f = rospy.get_param("f", 2)
        self.g = rospy.get_param("g", 3)
        self.pub = rospy.Publisher("output", Int32, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v, n = msg.data, int(msg.data)
        if self.a < v:
            self.pub.publish(1)
        if self.b <= v:
            self.pub.publish(2)
        if self.c > v:
            self.pub.publish(3)
        if v <= self.d:
            self.pub.publish(4)
        if self.e == n:
            self.pub.publish(5)
        if n != self.f:
            self.pub.publish(6)
        if n != self.g:
            rospy.logdebug("not %d", self.g)


if __name__ == "__main__":
    rospy.init_node("cmp_operators")
    comparisons = Comparisons()
    rospy.spin()
