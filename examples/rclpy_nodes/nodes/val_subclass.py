#!/usr/bin/env python3
"""Inherits its parameters and its publisher."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Reading(Node):
    def __init__(self, name):
        super().__init__(name)
        self.limit = self.declare_parameter("limit", 5.0).value
        self.noted = self.declare_parameter("noted", 2.0).value

    def show(self, msg):
        self.pub.publish(msg)


class Guard(Reading):
    def __init__(self):
        super().__init__("val_subclass")
        self.low = self.declare_parameter("low", -3.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.show(msg)
        if msg.data < self.low:
            self.show(msg)
        if msg.data > self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
