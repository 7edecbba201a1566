#!/usr/bin/env python3
"""Gets several parameters at once."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_get_parameters")
        for name, value in (("high", 5.0), ("low", -3.0), ("top", 8.0), ("noted", 2.0)):
            self.declare_parameter(name, value)
        high, low = self.get_parameters(["high", "low"])
        self.high = high.value
        self.low = low.get_parameter_value().double_value
        self.top = self.get_parameters(["noted", "top"])[1].value
        self.noted = self.get_parameters(["noted"])[0].value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.high:
            self.pub.publish(msg)
        if msg.data < self.low:
            self.pub.publish(msg)
        if msg.data > self.top:
            self.pub.publish(msg)
        if msg.data > self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
