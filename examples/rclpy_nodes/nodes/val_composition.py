#!/usr/bin/env python3
"""Its parts declare their parameters themselves."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Limit:
    def __init__(self, node, name, value):
        self.value = node.declare_parameter(name, value).value

    def is_above(self, sample):
        return sample < self.value


class Guard(Node):
    def __init__(self):
        super().__init__("val_composition")
        self.high = Limit(self, "high", 5.0)
        self.low = Limit(self, "low", -3.0)
        self.noted = Limit(self, "noted", 2.0)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.high.value:
            self.pub.publish(msg)
        if self.low.is_above(msg.data):
            self.pub.publish(msg)
        if msg.data > self.noted.value:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
