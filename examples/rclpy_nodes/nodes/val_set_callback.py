#!/usr/bin/env python3
"""Takes new limits while it runs."""
import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("val_set_callback")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.low = self.declare_parameter("low", 0.0).value
        self.noted = self.declare_parameter("noted", 2.0).value
        self.add_on_set_parameters_callback(self.on_set)
        self.set_parameters([Parameter("low", value=-3.0)])
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_set(self, params):
        for param in params:
            if param.name == "limit":
                self.limit = param.value
            elif param.name == "low" and param.type_ == Parameter.Type.DOUBLE:
                self.low = param.value
            elif param.name == "noted":
                self.noted = param.value
        return SetParametersResult(successful=True)

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
