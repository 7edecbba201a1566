#!/usr/bin/env python3
"""Reads through a function of its own."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


def declared(node, name, value):
    if not node.has_parameter(name):
        node.declare_parameter(name, value)
    return node.get_parameter(name).value


class Guard(Node):
    def __init__(self):
        super().__init__("read_helper")
        self.limit = declared(self, "limit", 5.0)
        self.low = declared(self, "low", -3.0)
        self.noted = declared(self, "noted", 2.0)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data < self.low:
            self.pub.publish(msg)
        if msg.data > self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
