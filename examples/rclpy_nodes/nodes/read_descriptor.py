#!/usr/bin/env python3
"""Publishes between limits that have descriptors."""
import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_descriptor")
        asked = ParameterDescriptor(description="the upper limit")
        self.limit = self.declare_parameter("limit", 5.0, asked).value
        free = ParameterDescriptor(dynamic_typing=True)
        self.low = self.declare_parameter("low", -3, free).value
        self.declare_parameter("top", Parameter.Type.DOUBLE)
        span = FloatingPointRange(from_value=0.0, to_value=8.0)
        self.noted = self.declare_parameter(
            "noted", 2.0, ParameterDescriptor(floating_point_range=[span])
        ).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data < self.low:
            self.pub.publish(msg)
        if msg.data > self.get_parameter("top").value:
            self.pub.publish(msg)
        if msg.data > self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
