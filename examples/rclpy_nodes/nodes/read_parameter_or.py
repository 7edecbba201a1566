#!/usr/bin/env python3
"""Takes alternatives where nobody declared anything."""
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_parameter_or")
        self.declare_parameter("limit", 5.0)
        other = Parameter("limit", Parameter.Type.DOUBLE, 7.0)
        self.limit = self.get_parameter_or("limit", other).value
        self.low = self.get_parameter_or("low", Parameter("low", value=-3.0)).value
        self.noted = self.get_parameter_or("noted", Parameter("noted", value=2.0)).value
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        if msg.data > self.limit:
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
