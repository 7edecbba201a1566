#!/usr/bin/env python3
"""Allows parameters that it does not know."""
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__(
            "read_undeclared",
            allow_undeclared_parameters=True,
            automatically_declare_parameters_from_overrides=True,
        )
        self.limit = self.get_parameter("limit").value
        self.low = self.get_parameter_or("low", Parameter("low", value=-3.0)).value
        self.old = self.declare_parameter("old", 8.0).value
        self.undeclare_parameter("old")
        self.absent = self.get_parameter("absent").value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data < self.low:
            self.pub.publish(msg)
        if msg.data > self.old:
            self.pub.publish(msg)
        if self.absent is None:
            self.pub.publish(Float64(data=0.5))


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
