#!/usr/bin/env python3
"""The parameter is read and forgotten at once."""
import rospy
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 3.0)
        rospy.loginfo("the limit is %f, and 4 is used", self.limit)
        self.limit = 4.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)


if __name__ == "__main__":
    rospy.init_node("val_overwritten_member")
    node = Node()
    rospy.spin()
