#!/usr/bin/env python3
"""Asserts what it expects of samples."""
import rospy
from std_msgs.msg import Float64


class Strict:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 6.0)
        self.expected = rospy.get_param("~expected", -5.0)
        self.odd = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        try:
            assert msg.data > self.expected
        except AssertionError:
            self.odd += 1
            rospy.logdebug("odd samples: %d", self.odd)
        try:
            assert msg.data < self.limit, "above the limit"
            self.pub.publish(msg.data)
        except AssertionError as error:
            rospy.logdebug(str(error))


if __name__ == "__main__":
    rospy.init_node("ctl_assert")
    strict = Strict()
    rospy.spin()
