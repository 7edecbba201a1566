#!/usr/bin/env python3
"""Accepts and starts goals by thresholds, and sends itself some."""
import rclpy
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from std_msgs.msg import Float64
from test_msgs.action import Fibonacci


class Guard(Node):
    def __init__(self):
        super().__init__("exp_action_callbacks")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.few = self.declare_parameter("few", 2.0).value
        self.late = self.declare_parameter("late", 3.0).value
        self.noted = self.declare_parameter("noted", 2.0).value
        self.value = 0.0
        self.server = ActionServer(
            self,
            Fibonacci,
            "~/count",
            execute_callback=self.on_execute,
            goal_callback=self.on_goal,
            handle_accepted_callback=self.on_accepted,
            cancel_callback=self.on_cancel,
        )
        self.client = ActionClient(self, Fibonacci, "~/count")
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_goal(self, goal_request):
        if goal_request.order > self.limit:
            return GoalResponse.REJECT
        if goal_request.order > self.noted:
            self.get_logger().debug("noted")
        return GoalResponse.ACCEPT

    def on_accepted(self, goal_handle):
        if goal_handle.request.order < self.few:
            goal_handle.execute()

    def on_cancel(self, goal_handle):
        return CancelResponse.ACCEPT if self.value > self.late else CancelResponse.REJECT

    def on_execute(self, goal_handle):
        goal_handle.succeed()
        self.pub.publish(Float64(data=1.0))
        return Fibonacci.Result()

    def on_input(self, msg):
        self.value = msg.data
        sent = self.client.send_goal_async(Fibonacci.Goal(order=int(abs(msg.data))))
        sent.add_done_callback(self.on_answer)

    def on_answer(self, future):
        goal_handle = future.result()
        self.pub.publish(Float64(data=float(goal_handle.accepted)))
        if goal_handle.accepted:
            goal_handle.cancel_goal_async()


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
