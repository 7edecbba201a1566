#!/usr/bin/env python3
"""Takes values by their types."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_typed_values")
        self.declare_parameter("limit", 5.0)
        self.declare_parameter("count", 2)
        self.declare_parameter("is_on", True)
        self.declare_parameter("mode", "fast")
        self.declare_parameter("noted", 2.0)
        self.limit = self.get_parameter("limit").get_parameter_value().double_value
        self.count = self.get_parameter("count").get_parameter_value().integer_value
        self.is_on = self.get_parameter("is_on").get_parameter_value().bool_value
        value = self.get_parameter("mode").get_parameter_value()
        self.mode = value.string_value
        self.noted = self.get_parameter("noted").get_parameter_value().double_value
        self.seen = 0
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        self.seen += 1
        if msg.data > self.limit:
            self.pub.publish(msg)
        if self.seen <= self.count:
            self.pub.publish(msg)
        if self.is_on and self.mode == "fast":
            self.pub.publish(Float64(data=0.5))
        if msg.data > self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
