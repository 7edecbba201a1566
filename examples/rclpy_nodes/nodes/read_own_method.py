#!/usr/bin/env python3
"""Its get_parameters_by_prefix is not rclpy's."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Settings:
    def __init__(self):
        self.value = -3.0

    def get_parameter(self, name):
        return self


class Guard(Node):
    def __init__(self):
        super().__init__("read_own_method")
        self.declare_parameter("limit", 5.0)
        self.settings = Settings()
        self.limit = self.get_parameters_by_prefix("limits")["high"]
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def get_parameters_by_prefix(self, prefix):
        return {"high": len(prefix) - 1.0}

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data < self.settings.get_parameter("low").value:
            self.pub.publish(msg)
        if msg.data > super().get_parameter("limit").value:
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
