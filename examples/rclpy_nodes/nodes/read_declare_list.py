#!/usr/bin/env python3
"""Declares its parameters in one go."""
import rclpy
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_declare_list")
        both = self.declare_parameters("", [("limit", 5.0), ("low", -3.0)])
        self.limit = both[0].value
        self.low = both[1].value
        top, noted = self.declare_parameters(
            namespace="", parameters=[("top", 8.0), ("noted", 2.0, ParameterDescriptor())]
        )
        self.top = top.value
        self.noted = noted.value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data < self.low:
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
