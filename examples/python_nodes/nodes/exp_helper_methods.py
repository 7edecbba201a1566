#!/usr/bin/env python3
"""Publishes through methods."""
import rospy
from std_msgs.msg import Float64


class Speaker:
    def __init__(self):
        self.one = rospy.get_param("~one", 2.0)
        self.two = rospy.get_param("~two", 5.0)
        self.three = rospy.get_param("~three", -5.0)
        self.none = rospy.get_param("~none", 0.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def emit(self, value):
        self.pub.publish(value)

    def emit_half(self, value):
        self.emit(value / 2)

    def emit_quarter(self, value):
        self.emit_half(value / 2)

    def forget(self, value):
        rospy.logdebug("forgotten: %f", value)

    def on_input(self, msg):
        if msg.data > self.one:
            self.emit(msg.data)
        if msg.data > self.two:
            self.emit_half(msg.data)
        if msg.data < self.three:
            self.emit_quarter(msg.data)
        if msg.data < self.none:
            self.forget(msg.data)


if __name__ == "__main__":
    rospy.init_node("exp_helper_methods")
    speaker = Speaker()
    rospy.spin()
