#!/usr/bin/env python3
"""Publishes between two limits that may be turned around."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("cmp_two_parameters")
        self.low = self.declare_parameter("low", -3.0).value
        self.high = self.declare_parameter("high", 5.0).value
        self.noted = self.declare_parameter("noted", 2.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if self.low < msg.data < self.high:
            self.pub.publish(msg)
        if self.low < self.high:
            self.pub.publish(msg)
        if self.low < msg.data < self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
