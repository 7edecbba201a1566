#!/usr/bin/env python3
"""Repeats each sample."""
import rospy
from std_msgs.msg import Float64


class Repeater:
    def __init__(self):
        self.copies = rospy.get_param("~copies", 2)
        self.echoes = rospy.get_param("~echoes", 3)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.echo_pub = rospy.Publisher("echo", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        sent = 0
        while sent < self.copies:
            self.pub.publish(msg.data)
            sent += 1
        for number in range(self.echoes):
            self.echo_pub.publish(msg.data / (number + 1))


if __name__ == "__main__":
    rospy.init_node("ctl_loop_bounds")
    repeater = Repeater()
    rospy.spin()
