#!/usr/bin/env python3
"""Parameter names that are put together."""
import sys

import rospy
from std_msgs.msg import Float64, Int32

SIDE = "left"
PREFIX = "~" + SIDE


class Arm:
    NAMESPACE = "arm"

    def __init__(self, which):
        self.lift = rospy.get_param(f"{PREFIX}/lift", 1.0)
        self.grip = rospy.get_param("~" + SIDE + "/grip", 2.0)
        self.turn = rospy.get_param("%s/turn" % self.NAMESPACE, 3.0)
        self.push = rospy.get_param("{}/push".format(SIDE), 4.0)
        self.pull = rospy.get_param("other_" + which + "/pull", 5.0)
        self.pub = rospy.Publisher("output", Int32, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > self.lift:
            self.pub.publish(1)
        if msg.data > self.grip:
            self.pub.publish(2)
        if msg.data > self.turn:
            self.pub.publish(3)
        if msg.data > self.push:
            self.pub.publish(4)
        if msg.data > self.pull:
            self.pub.publish(5)


if __name__ == "__main__":
    rospy.init_node("read_assembled_names")
    arm = Arm(str(len(sys.argv)))
    rospy.spin()
