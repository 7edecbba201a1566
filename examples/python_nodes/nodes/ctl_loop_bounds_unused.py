#!/usr/bin/env python3
"""Publishes each sample once; the loops work for the log."""
import rospy
from std_msgs.msg import Float64


class Repeater:
    def __init__(self):
        self.rounds = rospy.get_param("~rounds", 4)
        self.terms = rospy.get_param("~terms", 3)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        guess, turn = 1.0, 0
        while turn < self.rounds:
            guess = 0.5 * (guess + abs(msg.data) / guess)
            turn += 1
        total = 0.0
        for term in range(self.terms):
            total += msg.data / (term + 1)
        rospy.logdebug("root %f, sum %f", guess, total)
        self.pub.publish(msg.data)


if __name__ == "__main__":
    rospy.init_node("ctl_loop_bounds_unused")
    repeater = Repeater()
    rospy.spin()
