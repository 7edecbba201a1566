#!/usr/bin/env python3
"""Which limit counts follows from the direction: the attribute's name is put together."""
import rospy
from std_msgs.msg import Float64


class Box:
    def __init__(self):
        self.max_up = rospy.get_param("~max_up", 3.0)
        self.max_down = rospy.get_param("~max_down", 6.0)
        self.min_up = rospy.get_param("~min_up", 1.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        way = ["down", "up"][int(msg.data) % 2]
        if abs(msg.data) > getattr(self, "max_" + way):
            self.pub.publish(msg.data)
        if abs(msg.data) < getattr(self, f"min_{way}", 2.0):
            rospy.logdebug("near")


if __name__ == "__main__":
    rospy.init_node("val_attribute_half_name")
    box = Box()
    rospy.spin()
