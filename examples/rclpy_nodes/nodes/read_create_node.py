#!/usr/bin/env python3
"""Watches samples with functions alone."""
import rclpy
from std_msgs.msg import Float64


def main():
    rclpy.init()
    node = rclpy.create_node("read_create_node")
    limit = node.declare_parameter("limit", 5.0).value
    node.declare_parameter("low", -3.0)
    node.declare_parameter("noted", 2.0)
    pub = node.create_publisher(Float64, "~/output", 10)

    def on_input(msg):
        if msg.data > limit:
            pub.publish(msg)
        if msg.data < node.get_parameter("low").value:
            pub.publish(msg)
        if msg.data > node.get_parameter("noted").value:
            node.get_logger().debug("noted")

    node.create_subscription(Float64, "input", on_input, 10)
    rclpy.spin(node)


if __name__ == "__main__":
    main()
