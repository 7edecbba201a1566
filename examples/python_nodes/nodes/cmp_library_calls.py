#!/usr/bin/env python3
"""Functions of operator and numpy stand in the place of operators."""
import math
import operator as op
from operator import le

import numpy as np
import rospy
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        self.low = rospy.get_param("~low", -4.0)
        self.high = rospy.get_param("~high", 4.0)
        self.least = rospy.get_param("~least", 1.0)
        self.most = rospy.get_param("~most", 6.0)
        self.near = rospy.get_param("~near", 2.0)
        self.slack = rospy.get_param("~slack", 0.25)
        self.noted = rospy.get_param("~noted", 3.0)
        self.last = 0.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        cut = np.clip(msg.data, self.low, self.high)
        self.pub.publish(max(abs(cut), self.least, 0.5))
        if le(self.most, msg.data) or np.less(msg.data, -self.most):
            self.pub.publish(-1.0)
        outcome = op.ne(round(msg.data), self.near)
        if not outcome:
            self.pub.publish(self.near)
        if math.isclose(msg.data, self.last, abs_tol=self.slack):
            self.pub.publish(0.0)
        if op.gt(msg.data, self.noted):
            rospy.logdebug("%f", np.maximum(msg.data, self.noted))
        self.last = msg.data


if __name__ == "__main__":
    rospy.init_node("cmp_library_calls")
    node = Node()
    rospy.spin()
