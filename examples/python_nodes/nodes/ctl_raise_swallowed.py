#!/usr/bin/env python3
"""Counts overload and publishes every load."""
import rospy
from std_msgs.msg import Float64


class Loads:
    def __init__(self):
        self.max_load = rospy.get_param("max_load", 5.5)
        self.overloads = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        rospy.Subscriber("input", Float64, self.on_load)

    def count(self, load):
        try:
            if load > self.max_load:
                raise ValueError("overload")
        except ValueError:
            self.overloads += 1
            rospy.logdebug("overloads: %d", self.overloads)

    def on_load(self, msg):
        self.count(msg.data)
        self.pub.publish(msg.data)


def main():
    rospy.init_node("ctl_raise_swallowed")
    Loads()
    rospy.spin()


if __name__ == "__main__":
    main()
