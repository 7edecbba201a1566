#!/usr/bin/env python3
"""Publishes for each limit that a sample exceeds."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_by_prefix_items")
        self.declare_parameters("limits", [("high", 5.0), ("top", 8.0)])
        self.declare_parameter("noted", 2.0)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        for name, limit in self.get_parameters_by_prefix("limits").items():
            if msg.data > limit.value:
                self.pub.publish(msg)
        for limit in self.get_parameters_by_prefix("limits").values():
            if msg.data < -limit.value:
                self.pub.publish(msg)
        for name, limit in self.get_parameters_by_prefix("noted").items():
            if msg.data > limit.value:
                self.get_logger().debug(name)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
