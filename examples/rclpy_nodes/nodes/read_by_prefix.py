#!/usr/bin/env python3
"""Reads all limits by their prefix."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_by_prefix")
        declared = [("high", 5.0), ("arm.low", -3.0), ("top", 8.0), ("noted", 2.0)]
        self.declare_parameters("limits", declared)
        limits = self.get_parameters_by_prefix("limits")
        self.high = limits["high"].value
        self.low = limits["arm.low"].get_parameter_value().double_value
        self.limits = limits
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.high:
            self.pub.publish(msg)
        if msg.data < self.low:
            self.pub.publish(msg)
        if msg.data > self.limits.get("top").value:
            self.pub.publish(msg)
        if msg.data > self.limits["noted"].value:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
