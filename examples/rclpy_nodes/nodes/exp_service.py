#!/usr/bin/env python3
"""Answers whether the last sample was good, and asks itself."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64
from std_srvs.srv import SetBool


class Guard(Node):
    def __init__(self):
        super().__init__("exp_service")
        self.limit = self.declare_parameter("limit", 5.0).value
        self.tolerance = self.declare_parameter("tolerance", 4.0).value
        self.noted = self.declare_parameter("noted", 2.0).value
        self.service = self.create_service(SetBool, "~/judge", self.on_judge)
        self.client = self.create_client(SetBool, "~/judge")
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_judge(self, request, response):
        self.value = float(request.data) * 6.0
        response.message = "high" if self.value > self.limit else "low"
        if request.data and abs(self.value) > self.tolerance:
            response.success = True
        if self.value > self.noted:
            self.get_logger().debug("noted")
        return response

    def on_input(self, msg):
        asked = self.client.call_async(SetBool.Request(data=msg.data > 0.0))
        asked.add_done_callback(self.on_answer)

    def on_answer(self, future):
        self.pub.publish(Float64(data=float(future.result().success)))


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
