#!/usr/bin/env python3
"""Sorts samples into classes."""
import rospy
from std_msgs.msg import Float64, String


class Sorter:
    def __init__(self):
        self.high = rospy.get_param("~high", 6.0)
        self.middle = rospy.get_param("~middle", 2.0)
        self.low = rospy.get_param("~low", -2.0)
        self.noise = rospy.get_param("~noise", -6.0)
        self.pub = rospy.Publisher("output", String, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        value = msg.data
        if value >= self.high:
            self.pub.publish("high")
        elif value >= self.middle:
            self.pub.publish("middle")
        elif value <= self.low:
            if value < self.noise:
                rospy.logdebug("noise")
            self.pub.publish("low")
        else:
            rospy.logdebug("nothing to say")


if __name__ == "__main__":
    rospy.init_node("ctl_elif_chain")
    sorter = Sorter()
    rospy.spin()
