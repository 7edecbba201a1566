#!/usr/bin/env python3
"""Becomes active if its limits are in order."""
import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class Guard(LifecycleNode):
    def __init__(self):
        super().__init__("exp_lifecycle")
        self.declare_parameter("limit", 5.0)
        self.declare_parameter("most", 8.0)
        self.declare_parameter("noted", 2.0)
        self.limit = 0.0
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_configure(self, state):
        self.pub = self.create_lifecycle_publisher(Float64, "~/output", 10)
        self.limit = self.get_parameter("limit").value
        if self.limit > self.get_parameter("noted").value:
            self.get_logger().debug("noted")
        return super().on_configure(state)

    def on_activate(self, state):
        if self.count_subscribers("input") > self.get_parameter("most").value:
            return TransitionCallbackReturn.FAILURE
        return super().on_activate(state)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)


def main():
    rclpy.init()
    node = Guard()
    node.trigger_configure()
    node.trigger_activate()
    rclpy.spin(node)


if __name__ == "__main__":
    main()
