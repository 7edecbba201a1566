#!/usr/bin/env python3
"""Publishes whether a sample is high."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


class Guard(Node):
    def __init__(self):
        super().__init__("exp_outcome")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.low = self.declare_parameter("low", -3.0).value
        self.shown = self.create_publisher(Bool, "~/shown", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        self.shown.publish(Bool(data=msg.data > self.limit))
        answer = Bool()
        answer.data = msg.data < self.low
        self.shown.publish(answer)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
