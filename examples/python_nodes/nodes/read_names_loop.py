#!/usr/bin/env python3
"""Reads what it needs in loops."""
import rospy
from std_msgs.msg import Float64

NAMES = ["left", "right"]


class Steering:
    def __init__(self):
        self.limits = {}
        for name in NAMES:
            self.limits[name] = rospy.get_param("~" + name, 4.0)
        self.shown = {name: rospy.get_param(f"shown/{name}", 1.0) for name in NAMES}
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        side = "left" if msg.data < 0 else "right"
        if abs(msg.data) > self.limits[side]:
            self.pub.publish(msg.data)
        if abs(msg.data) > self.shown[side]:
            rospy.logdebug(side)


if __name__ == "__main__":
    rospy.init_node("read_names_loop")
    steering = Steering()
    rospy.spin()
