#!/usr/bin/env python3
"""Hears of new limits from the events."""
import rclpy
from rclpy.node import Node
from rclpy.parameter import parameter_value_to_python
from rclpy.parameter_event_handler import ParameterEventHandler
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("val_event_handler")
        self.declare_parameter("limit", 5.0)
        self.declare_parameter("low", -3.0)
        self.limit = self.get_parameter("limit").value
        self.low = self.get_parameter("low").value
        self.far = 100.0
        self.handler = ParameterEventHandler(self)
        self.handler.add_parameter_callback("limit", self.get_fully_qualified_name(), self.on_limit)
        self.handler.add_parameter_callback("far", "/another_node", self.on_far)
        self.handler.add_parameter_event_callback(self.on_event)
        self.pub = self.create_publisher(Float64, "~/output", 10)
        self.sub = self.create_subscription(Float64, "input", self.on_input, 10)

    def on_limit(self, param):
        self.limit = param.value.double_value

    def on_far(self, param):
        self.far = parameter_value_to_python(param.value)

    def on_event(self, event):
        own = self.get_fully_qualified_name()
        param = ParameterEventHandler.get_parameter_from_event(event, "low", own)
        if param is not None:
            self.low = parameter_value_to_python(param.value)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.pub.publish(msg)
        if msg.data < self.low:
            self.pub.publish(msg)
        if msg.data > self.far:
            self.pub.publish(msg)


def main():
    rclpy.init()
    rclpy.spin(Guard())


if __name__ == "__main__":
    main()
