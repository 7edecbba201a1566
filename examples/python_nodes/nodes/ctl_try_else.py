#!/usr/bin/env python3
"""Reads numbers out of texts."""
import rospy
from std_msgs.msg import Float64, String


class Refused(RuntimeError):
    """A number was too large."""


class Numbers:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 50.0)
        self.largest = rospy.get_param("~largest", 8.0)
        self.shown = rospy.get_param("~shown", 2.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.fault_pub = rospy.Publisher("faults", String, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def squared(self, text):
        try:
            value = float(text)
            if value > self.largest:
                raise Refused(text)
        except Refused as error:
            raise RuntimeError("refused") from error
        return value * value

    def on_input(self, msg):
        try:
            value = self.squared(f"{msg.data:.2f}")
        except RuntimeError as error:
            self.fault_pub.publish(str(error))
        else:
            if value < self.limit:
                self.pub.publish(value)
            if value > self.shown:
                rospy.logdebug("shown")


if __name__ == "__main__":
    rospy.init_node("ctl_try_else")
    numbers = Numbers()
    rospy.spin()
