#!/usr/bin/env python3
"""Gates of one class."""
import rospy
from std_msgs.msg import Float64


class Gate:
    def __init__(self, limit, pub):
        self.limit = limit
        self.pub = pub

    def pass_on(self, value):
        if value > self.limit:
            self.pub.publish(value)


class Silent:
    def __init__(self, limit):
        self.limit = limit

    def pass_on(self, value):
        if value > self.limit:
            rospy.logdebug("silent")


def main():
    rospy.init_node("val_two_objects")
    near = Gate(
        rospy.get_param("near/limit", 2.0), rospy.Publisher("near", Float64, queue_size=1000)
    )
    far = Gate(rospy.get_param("far/limit", 6.0), rospy.Publisher("far", Float64, queue_size=1000))
    fixed = Gate(9.0, rospy.Publisher("fixed", Float64, queue_size=1000))
    silent = Silent(rospy.get_param("silent/limit", 0.0))

    def on_input(msg):
        for gate in (near, far, fixed):
            gate.pass_on(msg.data)
        silent.pass_on(msg.data)

    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
