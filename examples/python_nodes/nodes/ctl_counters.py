#!/usr/bin/env python3
"""Counts samples of three kinds."""
import rospy
from std_msgs.msg import Float64, Int32


class Counters:
    def __init__(self):
        self.high = rospy.get_param("~high", 5.0)
        self.low = rospy.get_param("~low", -5.0)
        self.patience = rospy.get_param("~patience", 3)
        self.loud = rospy.get_param("~loud", 8.0)
        self.highs = self.lows = self.louds = 0
        self.pub = rospy.Publisher("output", Int32, queue_size=1000)
        self.alarm_pub = rospy.Publisher("alarm_state", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > self.high:
            self.highs += 1
        if msg.data < self.low:
            self.lows += 1
        if abs(msg.data) > self.loud:
            self.louds += 1
        self.pub.publish(self.highs)
        if self.lows >= self.patience:
            self.alarm_pub.publish(msg.data)
            self.lows = 0
        rospy.logdebug("%d loud ones", self.louds)


if __name__ == "__main__":
    rospy.init_node("ctl_counters")
    counters = Counters()
    rospy.spin()
