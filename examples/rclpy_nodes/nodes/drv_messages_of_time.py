#!/usr/bin/env python3
"""Takes its ages out of messages."""
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("drv_messages_of_time")
        patience = self.declare_parameter("patience", 5.0).value
        self.asked = Duration(seconds=patience).to_msg()
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        stamp = Time(seconds=100.0 + msg.data).to_msg()
        age = Time.from_msg(stamp) - Time.from_msg(Time(seconds=100).to_msg())
        if age > Duration.from_msg(self.asked):
            self.pub.publish(msg)
        if age >= Duration(seconds=0):
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
