#!/usr/bin/env python3
"""A light that shows the level."""
import rospy
from std_msgs.msg import ColorRGBA, Float64, Float64MultiArray


class Light:
    def __init__(self):
        self.red_above = rospy.get_param("light/red_above", 6.0)
        self.green_below = rospy.get_param("light/green_below", 0.0)
        self.blink = rospy.get_param("light/blink", False)
        self.kept_above = rospy.get_param("light/kept_above", 3.0)
        self.pub = rospy.Publisher("output", ColorRGBA, queue_size=1000)
        self.list_pub = rospy.Publisher("kept", Float64MultiArray, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        color = ColorRGBA(a=1.0)
        if msg.data > self.red_above:
            color.r = 1.0
        elif msg.data < self.green_below:
            color.g = 1.0
        color.a = 0.5 if self.blink else 1.0
        self.pub.publish(color)
        kept = Float64MultiArray()
        if msg.data > self.kept_above:
            kept.data.append(msg.data)
        self.list_pub.publish(kept)


if __name__ == "__main__":
    rospy.init_node("exp_message_fields")
    light = Light()
    rospy.spin()
