#!/usr/bin/env python3
"""Keeps its settings in one object."""
from dataclasses import dataclass

import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


@dataclass
class Settings:
    limit: float
    low: float
    noted: float


class Guard(Node):
    def __init__(self):
        super().__init__("val_dataclass")
        self.declare_parameters("", [("limit", 0.0), ("low", -3.0), ("noted", 2.0)])
        self.settings = self.read()
        self.add_post_set_parameters_callback(self.after_set)
        self.set_parameters([Parameter("limit", value=5.0)])
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def read(self):
        return Settings(
            limit=self.get_parameter("limit").value,
            low=self.get_parameter("low").value,
            noted=self.get_parameter("noted").value,
        )

    def after_set(self, params):
        self.settings = self.read()

    def on_input(self, msg):
        settings = self.settings
        if msg.data > settings.limit:
            self.pub.publish(msg)
        if msg.data < settings.low:
            self.pub.publish(msg)
        if msg.data > settings.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
