#!/usr/bin/env python3
"""Reads parameters under three names."""
import rospy as ros
from rospy import Publisher as Pub
from rospy import get_param as fetch
from std_msgs.msg import Float64


class Store:
    """Values that are hard-coded; not the parameter server."""

    def __init__(self):
        self.values = {"cap": 9.0}

    def get_param(self, name, default):
        return self.values.get(name, default)


ros.init_node("read_aliases")
read = ros.get_param
low = ros.get_param("~low", -4.0)
high = fetch("~high", 4.0)
step = read("~step", 3.0)
cap = Store().get_param("~cap", 8.0)
pub = Pub("output", Float64, queue_size=1000)
last = 0.0


def on_input(msg):
    global last
    change, last = abs(msg.data - last), msg.data
    if msg.data < low:
        pub.publish(-1.0)
    if msg.data > high:
        pub.publish(1.0)
    if change > step:
        pub.publish(change)
    if msg.data > cap:
        pub.publish(cap)


ros.Subscriber("input", Float64, on_input)
ros.spin()
