#!/usr/bin/env python3
"""A map of parameters becomes the attributes of an object, by __dict__."""
import rospy
from std_msgs.msg import Float64


class Guard:
    low = -4.0

    def __init__(self):
        self.high = 4.0
        self.__dict__.update(rospy.get_param("~guard"))
        vars(self)["peak"] = rospy.get_param("~peak", 8.0)
        self.seen = 0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        self.seen += 1
        if msg.data > self.high:
            self.pub.publish(msg.data)
        if msg.data < self.low:
            self.pub.publish(msg.data)
        if msg.data > self.peak:
            self.pub.publish(0.0)
        if self.seen > 20:
            self.pub.publish(1.0)
        if msg.data > self.shown:
            rospy.logdebug("shown")


if __name__ == "__main__":
    rospy.init_node("val_attribute_dict")
    guard = Guard()
    rospy.spin()
