#!/usr/bin/env python3
"""Declares its limits below a name."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_declare_namespace")
        self.limits = self.declare_parameters("limits", [("high", 5.0), ("low", -3.0)])
        self.declare_parameters(namespace="more.limits", parameters=[("top", 8.0), ("noted", 2.0)])
        self.high = self.limits[0].value
        self.top = self.get_parameter("more.limits.top").value
        self.noted = self.get_parameter("more.limits.noted").value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.high:
            self.pub.publish(msg)
        if msg.data < self.limits[1].value:
            self.pub.publish(msg)
        if msg.data > self.top:
            self.pub.publish(msg)
        if msg.data > self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
