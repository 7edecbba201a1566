#!/usr/bin/env python3
"""Turns its parameters into other units."""
import math

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("drv_rate")
        self.period = 1.0 / self.declare_parameter("rate", 0.2).value
        self.angle = math.radians(self.declare_parameter("angle", 180.0).value)
        self.radius = self.declare_parameter("radius", 3.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.period:
            self.pub.publish(msg)
        if msg.data < -self.angle:
            self.pub.publish(msg)
        if msg.data**2 < self.radius**2:
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
