#!/usr/bin/env python3
"""Sends goals for high samples, and cancels long ones."""
import rclpy
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.node import Node
from std_msgs.msg import Float64
from test_msgs.action import Fibonacci


class Guard(Node):
    def __init__(self):
        super().__init__("exp_action_client")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.most = self.declare_parameter("most", 7.0).value
        self.noted = self.declare_parameter("noted", 2.0).value
        self.order = 0
        self.server = ActionServer(
            self, Fibonacci, "~/count", self.on_execute, cancel_callback=self.on_cancel
        )
        self.client = ActionClient(self, Fibonacci, "~/count")
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_execute(self, goal_handle):
        goal_handle.succeed()
        self.pub.publish(Float64(data=1.0))
        return Fibonacci.Result()

    def on_cancel(self, goal_handle):
        return CancelResponse.ACCEPT

    def on_input(self, msg):
        if msg.data > self.noted and self.client.server_is_ready():
            self.client.wait_for_server(timeout_sec=0.0)
        if msg.data > self.limit:
            self.order = int(msg.data)
            sent = self.client.send_goal_async(Fibonacci.Goal(order=self.order))
            sent.add_done_callback(self.on_accepted)

    def on_accepted(self, future):
        goal_handle = future.result()
        if self.order > self.most:
            goal_handle.cancel_goal_async()


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
