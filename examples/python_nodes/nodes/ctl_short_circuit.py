#!/usr/bin/env python3
"""Decides by several conditions at once."""
import rospy
from std_msgs.msg import Float64


class Decision:
    def __init__(self):
        self.enabled = rospy.get_param("enabled", True)
        self.low = rospy.get_param("low", -5.0)
        self.high = rospy.get_param("high", 5.0)
        self.mute = rospy.get_param("mute", False)
        self.alarm = rospy.get_param("alarm", 8.0)
        self.verbose = rospy.get_param("verbose", False)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.alarm_pub = rospy.Publisher("alarm_state", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v = msg.data
        if self.enabled and (v > self.low and not v > self.high):
            self.pub.publish(v)
        if not (self.mute or v < self.alarm):
            self.alarm_pub.publish(v)
        if self.verbose and v > self.alarm:
            rospy.logdebug("alarm")


if __name__ == "__main__":
    rospy.init_node("ctl_short_circuit")
    decision = Decision()
    rospy.spin()
