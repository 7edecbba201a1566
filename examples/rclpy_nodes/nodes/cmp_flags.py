#!/usr/bin/env python3
"""Is switched on and off."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("cmp_flags")
        self.is_on = self.declare_parameter("is_on", True).value
        self.declare_parameter("is_loud", False)
        self.noted = self.declare_parameter("noted", True).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if self.is_on:
            self.pub.publish(msg)
        if not self.get_parameter("is_loud").get_parameter_value().bool_value:
            self.pub.publish(msg)
        if self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
