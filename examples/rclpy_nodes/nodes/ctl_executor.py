#!/usr/bin/env python3
"""Has two callbacks in a reentrant group."""
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("ctl_executor")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.low = self.declare_parameter("low", -3.0).value
        self.noted = self.declare_parameter("noted", 2.0).value
        group = ReentrantCallbackGroup()
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(
            Float64, "input", self.on_input, 10, callback_group=group
        )
        self.other = self.create_subscription(
            Float64, "input", lambda msg: self.on_other(msg, self.low), 10, callback_group=group
        )

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data > self.noted:
            self.get_logger().debug("noted")

    def on_other(self, msg, low):
        if msg.data < low:
            self.pub.publish(msg)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    node = Guard()
    executor.add_node(node)
    try:
        executor.spin()
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
