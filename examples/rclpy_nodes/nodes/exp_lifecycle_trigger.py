#!/usr/bin/env python3
"""Deactivates itself at high samples."""
import rclpy
from rclpy.lifecycle import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("exp_lifecycle_trigger")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.noted = self.declare_parameter("noted", 2.0).value
        self.pub = self.create_lifecycle_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        self.pub.publish(msg)
        if msg.data > self.limit:
            self.trigger_deactivate()
        if msg.data > self.noted:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    node = Guard()
    node.trigger_configure()
    node.trigger_activate()
    rclpy.spin(node)


if __name__ == "__main__":
    main()
