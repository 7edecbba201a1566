#!/usr/bin/env python3
"""Refuses values that are out of bounds."""
import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("exp_set_result")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.most = self.declare_parameter("most", 8.0).value
        self.noted = self.declare_parameter("noted", 2.0).value
        self.add_on_set_parameters_callback(self.on_set)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_set(self, params):
        for param in params:
            if param.name == "limit" and param.value > self.most:
                return SetParametersResult(successful=False, reason="too high")
            if param.name == "limit":
                self.limit = param.value
        if self.limit > self.noted:
            self.get_logger().debug("noted")
        return SetParametersResult(successful=True)

    def on_input(self, msg):
        (result,) = self.set_parameters([Parameter("limit", value=msg.data)])
        self.pub.publish(Float64(data=float(result.successful)))


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
