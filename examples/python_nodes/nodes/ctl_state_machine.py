#!/usr/bin/env python3
"""Switches on above one limit and off below another."""
from enum import Enum

import rospy
from std_msgs.msg import Bool, Float64


class State(Enum):
    OFF = 0
    ON = 1


class Switch:
    def __init__(self):
        self.on_above = rospy.get_param("~on_above", 4.0)
        self.off_below = rospy.get_param("~off_below", -4.0)
        self.warm_above = rospy.get_param("~warm_above", 2.0)
        self.state = State.OFF
        self.warm = False
        self.pub = rospy.Publisher("output", Bool, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def step(self, value):
        if self.state is State.OFF:
            if value > self.on_above:
                self.state = State.ON
        elif value < self.off_below:
            self.state = State.OFF
        if value > self.warm_above:
            self.warm = True

    def on_input(self, msg):
        self.step(msg.data)
        if self.state is State.ON:
            self.pub.publish(True)
        rospy.logdebug("warm: %s", self.warm)


if __name__ == "__main__":
    rospy.init_node("ctl_state_machine")
    switch = Switch()
    rospy.spin()
