#!/usr/bin/env python3
"""Notes new limits after they were set."""
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("val_pre_post_callbacks")
        self.declare_parameter("limit", 0.0)
        self.declare_parameter("low", -3.0)
        self.limit = 0.0
        self.asked = 0.0
        self.add_pre_set_parameters_callback(self.before_set)
        self.add_post_set_parameters_callback(self.after_set)
        self.set_parameters([Parameter("limit", value=5.0)])
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def before_set(self, params):
        for param in params:
            if param.name == "limit":
                self.asked = param.value
        return params

    def after_set(self, params):
        for param in params:
            if param.name == "limit":
                self.limit = param.value

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data < -self.asked:
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
