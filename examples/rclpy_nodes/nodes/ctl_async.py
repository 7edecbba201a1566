#!/usr/bin/env python3
"""Waits for an answer, and compares it."""
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import Float64
from std_srvs.srv import Trigger


class Guard(Node):
    def __init__(self):
        super().__init__("ctl_async")
        self.limit = self.declare_parameter("limit", 2).value
        self.low = self.declare_parameter("low", -3.0).value
        self.asked = 0
        group = ReentrantCallbackGroup()
        self.service = self.create_service(Trigger, "~/count", self.on_count, callback_group=group)
        self.client = self.create_client(Trigger, "~/count", callback_group=group)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    async def on_count(self, request, response):
        self.asked += 1
        response.message = "x" * self.asked
        return response

    async def on_input(self, msg):
        answer = await self.client.call_async(Trigger.Request())
        if len(answer.message) > self.limit:
            self.pub.publish(Float64(data=1.0))
        if msg.data < self.low:
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
