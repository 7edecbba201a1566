#!/usr/bin/env python3
"""Lets only samples between its limits through."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("ctl_early_return")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.low = self.declare_parameter("low", -3.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def check(self, value):
        if value < self.low:
            raise ValueError("too low")

    def on_input(self, msg):
        if msg.data > self.limit:
            return
        try:
            self.check(msg.data)
        except ValueError:
            return
        self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
