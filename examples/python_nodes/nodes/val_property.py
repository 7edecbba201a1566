#!/usr/bin/env python3
"""Limits are attributes that are methods."""
import rospy
from std_msgs.msg import Float64


class Limits:
    def __init__(self):
        self._high = rospy.get_param("~high", 5.0)
        self._low = 0.0
        self.low = rospy.get_param("~low", -5.0)
        self._noise = rospy.get_param("~noise", 1.0)
        self.value = 0.0

    @property
    def high(self):
        return self._high

    @property
    def low(self):
        return self._low

    @low.setter
    def low(self, value):
        self._low = value

    @property
    def is_noise(self):
        return abs(self.value) < self._noise


limits = None
pub = None


def on_input(msg):
    limits.value = msg.data
    if msg.data > limits.high:
        pub.publish(msg.data)
    elif msg.data < limits.low:
        pub.publish(limits.low)
    if limits.is_noise:
        pub.publish(0.0)
    if msg.data > limits._noise:
        rospy.logdebug("no noise")


def main():
    global limits, pub
    rospy.init_node("val_property")
    limits = Limits()
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
