#!/usr/bin/env python3
"""Publishes as far as parameters are declared."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_has_parameter")
        self.declare_parameter("limit", 5.0)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if self.has_parameter("limit"):
            if msg.data > self.get_parameter("limit").value:
                self.pub.publish(msg)
        if not self.has_parameter("low"):
            self.pub.publish(Float64(data=0.5))


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
