#!/usr/bin/env python3
"""Looks at arrays as a whole."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_array_size")
        self.allowed = self.declare_parameter("allowed", [1.0, 3.0]).value
        self.names = self.declare_parameter("names", ["a", "b", "c"]).value
        self.steps = self.declare_parameter("steps", [1, 2]).value
        self.noted = self.declare_parameter("noted", [2.0]).value
        self.seen = 0
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        self.seen += 1
        if msg.data in self.allowed:
            self.pub.publish(msg)
        if self.seen > len(self.names):
            self.pub.publish(msg)
        if self.steps and self.seen == 1:
            self.pub.publish(msg)
        if msg.data in self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
