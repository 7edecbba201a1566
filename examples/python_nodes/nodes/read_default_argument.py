#!/usr/bin/env python3
"""Default arguments are read once, when the function is made."""
import rospy
from std_msgs.msg import Float64

rospy.init_node("read_default_argument")
pub = rospy.Publisher("output", Float64, queue_size=1000)


def is_high(value, limit=rospy.get_param("~limit", 5.0)):
    return value > limit


def clipped(value, *, floor=rospy.get_param("~floor", -5.0)):
    if value < floor:
        return floor
    return value


def is_noise(value, noise=rospy.get_param("~noise", 1.0)):
    return abs(value) < noise


def on_input(msg):
    if is_high(msg.data):
        pub.publish(msg.data)
    pub.publish(clipped(msg.data))
    if is_noise(msg.data, 0.5):
        pub.publish(0.0)


rospy.Subscriber("input", Float64, on_input)
rospy.spin()
