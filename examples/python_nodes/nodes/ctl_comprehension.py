#!/usr/bin/env python3
"""Filters a window of samples by comprehensions."""
from collections import deque

import rospy
from std_msgs.msg import Float64, Float64MultiArray


class Window:
    def __init__(self):
        self.floor = rospy.get_param("~floor", -4.0)
        self.ceiling = rospy.get_param("~ceiling", 4.0)
        self.loud = rospy.get_param("~loud", 6.0)
        self.faint = rospy.get_param("~faint", 1.0)
        self.values = deque(maxlen=5)
        self.pub = rospy.Publisher("output", Float64MultiArray, queue_size=1000)
        self.alarm_pub = rospy.Publisher("alarm_state", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.values.append(msg.data)
        kept = [value for value in self.values if value > self.floor if value < self.ceiling]
        self.pub.publish(Float64MultiArray(data=kept))
        if any(abs(value) > self.loud for value in self.values):
            self.alarm_pub.publish(msg.data)
        faint = {round(value) for value in self.values if abs(value) < self.faint}
        rospy.logdebug("%d faint ones", len(faint))


if __name__ == "__main__":
    rospy.init_node("ctl_comprehension")
    window = Window()
    rospy.spin()
