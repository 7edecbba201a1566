#!/usr/bin/env python3
"""Counts by a timer, and publishes some of it."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("ctl_timer")
        self.limit = self.declare_parameter("limit", 3).value
        self.noted = self.declare_parameter("noted", 2).value
        self.most = self.declare_parameter("most", 5).value
        self.count = 0
        self.timer = self.create_timer(0.01, self.on_timer)
        self.pub = self.create_publisher(Float64, "~/output", 10)

    def on_timer(self):
        self.count += 1
        if self.count > self.limit:
            self.pub.publish(Float64(data=float(self.count)))
        if self.count > self.noted:
            self.get_logger().debug("noted")
        if self.count == self.most:
            self.timer.cancel()


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
