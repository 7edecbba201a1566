#!/usr/bin/env python3
"""Subscribes only where a limit says so."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("exp_registered")
        self.depth = self.declare_parameter("depth", 3).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        if self.depth > 2:
            self.sub = self.create_subscription(Float64, "input", self.on_input, 10)
        if self.declare_parameter("is_noted", True).value:
            self.timer = self.create_timer(3600.0, self.on_timer)

    def on_timer(self):
        self.get_logger().debug("noted")

    def on_input(self, msg):
        self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
