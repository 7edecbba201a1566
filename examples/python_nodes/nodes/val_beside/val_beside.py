#!/usr/bin/env python3
"""Two modules stand beside the script, one of them is imported inside a function."""
import rospy
from limits_beside import LIMITS, read_limits
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        from check_beside import Check

        read_limits()
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.check = Check(self.pub)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > LIMITS["high"]:
            self.pub.publish(msg)
        self.check.look_at(msg.data)


if __name__ == "__main__":
    rospy.init_node("val_beside")
    node = Node()
    rospy.spin()
