#!/usr/bin/env python3
"""Reads behind properties."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("val_property")
        self.declare_parameter("limit", 5.0)
        self.declare_parameter("low", -3.0)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    @property
    def limit(self):
        return self.get_parameter("limit").value

    def low(self):
        return self.get_parameter("low").get_parameter_value().double_value

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data < self.low():
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
