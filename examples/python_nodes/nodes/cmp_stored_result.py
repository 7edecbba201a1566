#!/usr/bin/env python3
"""Compares first and decides later."""
import rospy
from std_msgs.msg import Bool, Float64


class Latch:
    def __init__(self):
        self.trip = rospy.get_param("trip", 7.0)
        self.release = rospy.get_param("release", -2.0)
        self.low = rospy.get_param("low", -9.0)
        self.high = rospy.get_param("high", 9.0)
        self.step = rospy.get_param("step", 1.0)
        self.reported = rospy.get_param("reported", 1.0)
        self.latched = self.released = False
        self.last = 0.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.state_pub = rospy.Publisher("state", Bool, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        v = msg.data
        tripped = v > self.trip
        self.released = not v >= self.release
        inside = (v > self.low) & (v < self.high)
        moved = inside and abs(v - self.last) > self.step
        self.last = v
        if tripped:
            self.latched = True
        elif self.released:
            self.latched = False
        if not self.latched and moved:
            self.pub.publish(v)
        self.state_pub.publish(v > self.reported)


if __name__ == "__main__":
    rospy.init_node("cmp_stored_result")
    latch = Latch()
    rospy.spin()
