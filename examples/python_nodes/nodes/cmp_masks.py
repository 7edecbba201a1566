#!/usr/bin/env python3
"""Elements of a window are chosen by arrays of outcomes."""
from collections import deque

import numpy as np
import rospy
from std_msgs.msg import Float64


class Window:
    def __init__(self):
        self.far = rospy.get_param("~far", 6.0)
        self.near = rospy.get_param("~near", 2.0)
        self.peak = rospy.get_param("~peak", 9.0)
        self.shown = rospy.get_param("~shown", 5.0)
        self.values = deque(maxlen=8)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.values.append(msg.data)
        window = np.array(self.values)
        kept = window[window < self.far]
        self.pub.publish(float(len(kept)))
        self.pub.publish(float(np.sum(np.where(window > self.near, window, 0.0))))
        is_high = window > self.peak
        if is_high.any():
            self.pub.publish(window.max())
        rospy.logdebug("%s", window[window > self.shown])


if __name__ == "__main__":
    rospy.init_node("cmp_masks")
    window = Window()
    rospy.spin()
