#!/usr/bin/env python3
"""Fetches, checks and publishes in functions of their own."""
import rospy
from std_msgs.msg import Float64


def fetch(name, default):
    return float(rospy.get_param("~" + name, default))


def read_limit():
    return rospy.get_param("~limit", 3.0)


def exceeds(value, limit):
    return value > limit


def is_small(value, *, below):
    if abs(value) < below:
        return True
    return False


def note(value, limit):
    if value > limit:
        rospy.logdebug("noted")


def main():
    rospy.init_node("val_arguments_returns")
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    limit = read_limit()
    small = fetch("small", 1.0)
    noted = fetch("noted", 5.0)

    def on_input(msg):
        note(msg.data, noted)
        if exceeds(msg.data, limit):
            pub.publish(msg.data)
        if is_small(msg.data, below=small):
            pub.publish(0.0)

    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
