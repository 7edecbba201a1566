#!/usr/bin/env python3
"""Keeps parameter objects, and looks at their types."""
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_parameter_object")
        self.limit = self.declare_parameter("limit", 5.0)
        self.low = self.declare_parameter("low", -3.0)
        self.noted = self.declare_parameter("noted", 2.0)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.limit.value:
            self.pub.publish(msg)
        if self.low.type_ == Parameter.Type.DOUBLE and msg.data < self.low.value:
            self.pub.publish(msg)
        if self.low.name == "low":
            self.pub.publish(Float64(data=0.5))
        if msg.data > self.noted.value:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
