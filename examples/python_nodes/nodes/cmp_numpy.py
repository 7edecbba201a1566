#!/usr/bin/env python3
"""Statistics of a window."""
from collections import deque

import numpy as np
import rospy
from std_msgs.msg import Float64


class Window:
    def __init__(self):
        self.spread = np.float64(rospy.get_param("~spread", 4.0))
        self.mean = rospy.get_param("~mean", 0.0)
        self.peak = rospy.get_param("~peak", 9.0)
        self.shown = rospy.get_param("~shown", 5.0)
        self.values = deque(maxlen=8)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.values.append(msg.data)
        window = np.array(self.values)
        if np.std(window) > self.spread:
            self.pub.publish(np.std(window))
        if window.mean() < self.mean:
            self.pub.publish(window.mean())
        if (np.abs(window) > self.peak).any():
            self.pub.publish(window.max())
        if np.median(window) > self.shown:
            rospy.logdebug("a high median")


if __name__ == "__main__":
    rospy.init_node("cmp_numpy")
    window = Window()
    rospy.spin()
