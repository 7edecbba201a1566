#!/usr/bin/env python3
"""Publishes high samples and low ones."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_declare")
        self.limit = self.declare_parameter("limit", 5.0).value
        low = self.declare_parameter(name="low", value=-3.0)
        self.low = low.value
        self.noted = self.declare_parameter("noted", 0.0).value
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
