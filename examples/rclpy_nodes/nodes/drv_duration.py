#!/usr/bin/env python3
"""Looks at the age of samples; the samples themselves are the ages."""
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("drv_duration")
        self.patience = self.declare_parameter("patience", 5.0).value
        self.grace = Duration(seconds=self.declare_parameter("grace", 2.0).value)
        self.short = Duration(nanoseconds=self.declare_parameter("short", -3000000000).value)
        self.declare_parameter("minutes", 0.1)
        self.noted = Duration(seconds=self.declare_parameter("noted", 1.0).value)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        age = Time(seconds=100.0 + msg.data) - Time(seconds=100)
        if age > Duration(seconds=self.patience):
            self.pub.publish(msg)
        if age > self.grace:
            self.pub.publish(msg)
        if age < self.short:
            self.pub.publish(msg)
        if age > Duration(seconds=60 * self.get_parameter("minutes").value):
            self.pub.publish(msg)
        if age > self.noted:
            self.get_logger().debug("old")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
