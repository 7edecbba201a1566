#!/usr/bin/env python3
"""Publishes again only after a while."""
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("drv_times")
        self.patience = self.declare_parameter("patience", 3600.0).value
        self.wait = self.declare_parameter("wait", 3.5).value
        self.first = self.declare_parameter("first", 1.0).value
        self.began = self.get_clock().now()
        self.last = Time(seconds=90)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        now = Time(seconds=100.0 + msg.data)
        if self.get_clock().now() - self.began > Duration(seconds=self.patience):
            self.pub.publish(Float64(data=1.0))
        if now > self.last + Duration(seconds=self.wait):
            self.last = now
            self.pub.publish(msg)
        if now < Time(seconds=100) + Duration(seconds=self.first):
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
