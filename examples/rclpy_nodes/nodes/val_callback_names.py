#!/usr/bin/env python3
"""Takes new limits from a dict of them."""
import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("val_callback_names")
        self.declare_parameter("limit", 5.0)
        self.declare_parameter("low", -3.0)
        self.limit = 0.0
        self.low = 0.0
        self.add_on_set_parameters_callback(self.on_set)
        self.set_parameters([Parameter("limit", value=5.0), Parameter("low", value=-3.0)])
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_set(self, params):
        given = {param.name: param.value for param in params}
        if "limit" in given:
            self.limit = given["limit"]
        self.low = given.get("low", self.low)
        return SetParametersResult(successful=True)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data < self.low:
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
