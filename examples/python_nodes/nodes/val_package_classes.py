#!/usr/bin/env python3
"""The script only puts the parts together."""
import python_nodes.monitors as monitors
import rospy
from std_msgs.msg import Float64


class Node(monitors.Monitor):
    def __init__(self):
        super().__init__("output")
        self.lowest = rospy.get_param("~lowest", -8.0)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data < self.lowest:
            return
        self.watch(msg.data)


if __name__ == "__main__":
    rospy.init_node("val_package_classes")
    node = Node()
    rospy.spin()
