#!/usr/bin/env python3
"""Refuses overload."""
import rospy
from std_msgs.msg import Float64, String


class Loads:
    def __init__(self):
        self.max_load = rospy.get_param("max_load", 5.5)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.fault_pub = rospy.Publisher("faults", String, queue_size=1000)
        rospy.Subscriber("input", Float64, self.on_load)

    def require(self, load):
        if load > self.max_load:
            raise ValueError("overload")

    def on_load(self, msg):
        try:
            self.require(msg.data)
            self.pub.publish(msg.data)
        except ValueError as error:
            self.fault_pub.publish(String(data=str(error)))


def main():
    rospy.init_node("ctl_raise_callee")
    Loads()
    rospy.spin()


if __name__ == "__main__":
    main()
