#!/usr/bin/env python3
"""Callbacks are wrapped in checks."""
import functools

import rospy
from std_msgs.msg import Float64

rospy.init_node("val_decorator")
pub = rospy.Publisher("output", Float64, queue_size=1000)
counts = {"loud": 0}


def above(limit):
    def decorate(function):
        @functools.wraps(function)
        def wrapper(msg):
            if msg.data <= limit:
                return None
            return function(msg)

        return wrapper

    return decorate


def counted(function):
    loud = rospy.get_param("~loud", 8.0)

    @functools.wraps(function)
    def wrapper(msg):
        if msg.data > loud:
            counts["loud"] += 1
            rospy.logdebug("loud: %d", counts["loud"])
        return function(msg)

    return wrapper


@counted
@above(rospy.get_param("~floor", -2.0))
def on_input(msg):
    pub.publish(msg.data)


rospy.Subscriber("input", Float64, on_input)
rospy.spin()
