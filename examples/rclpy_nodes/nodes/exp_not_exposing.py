#!/usr/bin/env python3
"""Does much, and publishes the same in any case."""
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Blackboard:
    """Notes for people in the same process."""

    def __init__(self):
        self.notes = []

    def publish(self, text):
        self.notes.append(text)

    def call_async(self):
        self.notes.clear()


class Guard(Node):
    def __init__(self):
        super().__init__("exp_not_exposing")
        self.stored = self.declare_parameter("stored", 8.0).value
        self.printed = self.declare_parameter("printed", 2.0).value
        self.warned = self.declare_parameter("warned", -5.0).value
        self.posted = self.declare_parameter("posted", 2.0).value
        self.full = self.declare_parameter("full", 20).value
        self.declare_parameter("last", 0.0)
        self.board = Blackboard()
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        self.pub.publish(msg)
        if msg.data > self.stored:
            self.set_parameters([Parameter("last", value=msg.data)])
        if msg.data > self.printed:
            print("high")
        if msg.data < self.warned:
            self.get_logger().debug("low", throttle_duration_sec=1.0)
        if msg.data > self.posted:
            self.board.publish("posted")
        if len(self.board.notes) > self.full:
            self.board.call_async()


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
