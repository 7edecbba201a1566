#!/usr/bin/env python3
"""Compares ages in nanoseconds."""
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("drv_nanoseconds")
        self.patience = self.declare_parameter("patience", 5.0).value
        self.grace = self.declare_parameter("grace", 2.0).value
        self.far = Duration(seconds=self.declare_parameter("far", 8.0).value)
        self.noted = self.declare_parameter("noted", 1.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        age = Time(seconds=100.0 + msg.data) - Time(seconds=100)
        if age.nanoseconds > self.patience * 1e9:
            self.pub.publish(msg)
        if age.nanoseconds / 1e9 > self.grace:
            self.pub.publish(msg)
        if age.nanoseconds > self.far.nanoseconds:
            self.pub.publish(msg)
        if age.nanoseconds * 1e-9 > self.noted:
            self.get_logger().debug("old")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
