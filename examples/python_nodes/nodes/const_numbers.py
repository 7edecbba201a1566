#!/usr/bin/env python3
"""A node without parameters."""
import rospy
from std_msgs.msg import Float64

CEILING = 7.5


class Fixed:
    FLOOR = -7.5

    def __init__(self):
        self.count = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > CEILING:
            self.pub.publish(CEILING)
        elif msg.data < self.FLOOR:
            self.pub.publish(self.FLOOR)
        self.count += 1
        if 3 <= self.count:
            self.count = 0
            self.pub.publish(msg.data)
        if msg.data > 9.0:
            rospy.logdebug("high")


if __name__ == "__main__":
    rospy.init_node("const_numbers")
    fixed = Fixed()
    rospy.spin()
