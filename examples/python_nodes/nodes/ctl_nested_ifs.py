#!/usr/bin/env python3
"""Warns of heat while a load is on."""
import rospy
from std_msgs.msg import Float64


class Guard:
    def __init__(self):
        self.load_limit = rospy.get_param("load/limit", 1.0)
        self.heat_limit = rospy.get_param("heat/limit", 4.0)
        self.shown = rospy.get_param("heat/shown", 5.0)
        self.shown_count = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        load = abs(msg.data)
        if load > self.load_limit:
            if load * 1.5 > self.heat_limit:
                self.pub.publish(load)
            if load > self.shown:
                self.shown_count += 1
                rospy.logdebug("shown %d times", self.shown_count)


if __name__ == "__main__":
    rospy.init_node("ctl_nested_ifs")
    guard = Guard()
    rospy.spin()
