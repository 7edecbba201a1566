#!/usr/bin/env python3
"""Keeps the last samples and publishes the usable ones of them."""
from collections import deque

import rospy
from std_msgs.msg import Float64


class Window:
    def __init__(self):
        self.floor = rospy.get_param("~floor", -5.0)
        self.stop = rospy.get_param("~stop", 8.0)
        self.loud = rospy.get_param("~loud", 9.0)
        self.last = deque(maxlen=4)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.last.append(msg.data)
        for value in self.last:
            if value < self.floor:
                continue
            if value > self.stop:
                break
            self.pub.publish(value)
        for value in self.last:
            if value > self.loud:
                rospy.logdebug("loud")
                break


if __name__ == "__main__":
    rospy.init_node("ctl_break_continue")
    window = Window()
    rospy.spin()
