#!/usr/bin/env python3
"""Publishes answers that thresholds let through."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64
from std_srvs.srv import Trigger


class Guard(Node):
    def __init__(self):
        super().__init__("exp_client_answer")
        self.limit = self.declare_parameter("limit", 2).value
        self.low = self.declare_parameter("low", 1).value
        self.asked = 0
        self.service = self.create_service(Trigger, "~/count", self.on_count)
        self.client = self.create_client(Trigger, "~/count")
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_count(self, request, response):
        self.asked += 1
        response.message = "x" * self.asked
        return response

    def on_input(self, msg):
        self.client.call_async(Trigger.Request()).add_done_callback(self.on_answer)

    def on_answer(self, future):
        count = len(future.result().message)
        if count > self.limit:
            self.pub.publish(Float64(data=1.0))
        if count <= self.low:
            self.pub.publish(Float64(data=2.0))


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
