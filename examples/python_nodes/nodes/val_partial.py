#!/usr/bin/env python3
"""One function for several callbacks."""
from functools import partial

import rospy
from std_msgs.msg import Float64


def gate(limit, pub, msg):
    if msg.data > limit:
        pub.publish(msg)


def floor(msg, arguments):
    lowest, pub = arguments
    if msg.data >= lowest:
        pub.publish(msg.data)


def watch(msg, limit):
    if msg.data > limit:
        rospy.logdebug("watched")


def main():
    rospy.init_node("val_partial")
    pub = rospy.Publisher("output", Float64, queue_size=1000)
    floor_pub = rospy.Publisher("floor", Float64, queue_size=1000)
    bound = partial(gate, rospy.get_param("~limit", 5.0), pub)
    rospy.Subscriber("input", Float64, bound)
    rospy.Subscriber(
        "input", Float64, floor, callback_args=(rospy.get_param("~lowest", 0.0), floor_pub)
    )
    rospy.Subscriber("input", Float64, partial(watch, limit=rospy.get_param("~watched", 2.0)))
    rospy.spin()


if __name__ == "__main__":
    main()
