#!/usr/bin/env python3
"""Counts as far as its limits let it, for a goal that it sends itself."""
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from std_msgs.msg import Float64
from test_msgs.action import Fibonacci


class Guard(Node):
    def __init__(self):
        super().__init__("exp_action_server")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.step = self.declare_parameter("step", 2).value
        self.most = self.declare_parameter("most", 3).value
        self.noted = self.declare_parameter("noted", 2.0).value
        self.value = 0.0
        self.server = ActionServer(self, Fibonacci, "~/count", self.on_execute)
        self.client = ActionClient(self, Fibonacci, "~/count")
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_execute(self, goal_handle):
        result = Fibonacci.Result()
        for at in range(goal_handle.request.order):
            if at >= self.step:
                goal_handle.publish_feedback(Fibonacci.Feedback())
        if goal_handle.request.order > self.most:
            result.sequence = [1]
        if goal_handle.request.order > self.noted:
            self.get_logger().debug("noted")
        if goal_handle.request.order > self.limit:
            goal_handle.abort()
            return result
        goal_handle.succeed()
        return result

    def on_input(self, msg):
        goal = Fibonacci.Goal(order=int(abs(msg.data)))
        self.client.send_goal_async(goal).add_done_callback(self.on_accepted)

    def on_accepted(self, future):
        future.result().get_result_async().add_done_callback(self.on_result)

    def on_result(self, future):
        self.pub.publish(Float64(data=float(future.result().status)))


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
