#!/usr/bin/env python3
"""Compares samples with samples."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("val_measured")
        self.declare_parameter("limit", 5.0)
        self.limit = self.get_parameter("limit").value
        self.limit = 4.0
        self.last = 0.0
        self.top = self.declare_parameter("top", 8.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data > self.last + 2.5:
            self.pub.publish(msg)
        self.last = msg.data
        if msg.data > self.top:
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
