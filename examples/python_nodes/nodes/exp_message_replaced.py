#!/usr/bin/env python3
"""Prepares a message and sends another one."""
import rospy
from std_msgs.msg import ColorRGBA, Float64


class Light:
    def __init__(self):
        self.red_above = rospy.get_param("light/red_above", 6.0)
        self.dim_below = rospy.get_param("light/dim_below", 0.0)
        self.pub = rospy.Publisher("output", ColorRGBA, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        draft = ColorRGBA(a=1.0)
        if msg.data > self.red_above:
            draft.r = 1.0
        level = 1.0
        if msg.data < self.dim_below:
            level = 0.5
        rospy.logdebug("drafted: %s, %f", draft, level)
        level = 0.8
        color = ColorRGBA(r=0.1 * msg.data, a=level)
        self.pub.publish(color)


if __name__ == "__main__":
    rospy.init_node("exp_message_replaced")
    light = Light()
    rospy.spin()
