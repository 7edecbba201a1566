#!/usr/bin/env python3
"""Clamps samples."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("cmp_inside_library")
        self.high = self.declare_parameter("high", 5.0).value
        self.low = self.declare_parameter("low", -3.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        clamped = max(self.low, min(msg.data, self.high))
        self.pub.publish(Float64(data=clamped))


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
