#!/usr/bin/env python3
"""Asks a node (itself) for a parameter, and compares what it answers."""
import rclpy
from rclpy.node import Node
from rclpy.parameter_client import AsyncParameterClient
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_remote")
        self.declare_parameter("limit", 5.0)
        self.answered = 0.0
        self.asking = AsyncParameterClient(self, "read_remote")
        self.asking.get_parameters(["limit"], callback=self.on_answer)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_answer(self, future):
        self.answered = future.result().values[0].double_value
        self.get_logger().debug("answered")

    def on_input(self, msg):
        if msg.data > self.answered + 100.0:
            self.pub.publish(msg)
        self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
