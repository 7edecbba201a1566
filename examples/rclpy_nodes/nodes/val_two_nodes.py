#!/usr/bin/env python3
"""Runs two nodes in one executor."""
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("val_two_nodes")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)


class Other(Node):
    def __init__(self):
        super().__init__("val_two_nodes_other")
        self.limit = self.declare_parameter("low", -3.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data < self.limit:
            self.pub.publish(msg)


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(Guard())
    executor.add_node(Other())
    executor.spin()


if __name__ == "__main__":
    main()
