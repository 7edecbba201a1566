#!/usr/bin/env python3
"""Chooses by a mode."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("cmp_strings")
        self.mode = self.declare_parameter("mode", "fast").value
        self.kind = self.declare_parameter("kind", "a").value
        self.noted = self.declare_parameter("noted", "yes").value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if self.mode == "fast":
            self.pub.publish(msg)
        if self.kind in ("a", "b"):
            self.pub.publish(msg)
        if self.noted == "yes":
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
