#!/usr/bin/env python3
"""Takes its limits from arrays."""
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("read_arrays")
        self.declare_parameter("limits", [-3.0, 5.0])
        self.declare_parameter("counts", [1, 2, 3])
        self.low, self.high = self.get_parameter("limits").value
        counts = self.get_parameter("counts").get_parameter_value().integer_array_value
        self.count = counts[1]
        self.tops = self.declare_parameter("tops", [7.0, 8.0]).value
        self.noted = self.declare_parameter("noted", [2.0]).value
        self.seen = 0
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_input(self, msg):
        self.seen += 1
        if msg.data < self.low:
            self.pub.publish(msg)
        if msg.data > self.high:
            self.pub.publish(msg)
        if self.seen <= self.count:
            self.pub.publish(msg)
        for top in self.tops:
            if msg.data > top:
                self.pub.publish(msg)
        if msg.data > self.noted[0]:
            self.get_logger().debug("noted")


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
