#!/usr/bin/env python3
"""Reads limits under names that it puts together."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_names")
        for axis in ("x", "y"):
            self.declare_parameter(f"limits.{axis}.high", 5.0 if axis == "x" else 8.0)
        self.high_x = self.high("x")
        self.high_y = self.high("y")
        own = self.get_name() + ".low"
        self.low = self.declare_parameter(own, -3.0).value
        self.noted = self.declare_parameter("limits" + "." + "noted", 2.0).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def high(self, axis):
        return self.get_parameter("limits.%s.high" % axis).value

    def on_input(self, msg):
        if msg.data > self.high_x:
            self.pub.publish(msg)
        if msg.data > self.high_y:
            self.pub.publish(msg)
        if msg.data < self.low:
            self.pub.publish(msg)
        if msg.data > self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
