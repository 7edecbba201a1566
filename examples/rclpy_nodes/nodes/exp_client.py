#!/usr/bin/env python3
"""Calls a service for high samples."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64
from std_srvs.srv import Trigger


class Guard(Node):
    def __init__(self):
        super().__init__("exp_client")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.low = self.declare_parameter("low", -3.0).value
        self.noted = self.declare_parameter("noted", 2.0).value
        self.service = self.create_service(Trigger, "~/alarm", self.on_alarm)
        self.client = self.create_client(Trigger, "~/alarm")
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_alarm(self, request, response):
        self.pub.publish(Float64(data=1.0))
        return response

    def on_input(self, msg):
        if msg.data > self.limit:
            self.client.call_async(Trigger.Request())
        if msg.data > self.noted and self.client.service_is_ready():
            self.client.wait_for_service(timeout_sec=0.0)
        request = Trigger.Request()
        if msg.data < self.low:
            asked = self.client.call_async(request)
            asked.add_done_callback(lambda future: None)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
