#!/usr/bin/env python3
"""Looks its limits up whenever a sample comes."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_get_parameter")
        self.declare_parameter("limit", 5.0)
        self.declare_parameter("low", -3.0)
        self.declare_parameter("noted", 2.0)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        limit = self.get_parameter("limit").value
        if msg.data > limit:
            self.pub.publish(msg)
        if msg.data < self.get_parameter(name="low").value:
            self.pub.publish(msg)
        if msg.data > self.get_parameter("noted").value:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
