"""A node of rclpy that reports, marks, and prints what it hears on /diagnostics as lines of JSON.

Runs under the interpreter that has rclpy. Its argument is the key of the comparison it reports.
"""

import json
import sys

import rclpy
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray

KEY = sys.argv[1]


class Dashboard:
    def __init__(self):
        rclpy.init()
        self.node = rclpy.create_node("guard", namespace="/arm")
        self.marks = self.node.create_publisher(Time, "/mark_action", 10)
        self.node.create_subscription(DiagnosticArray, "/diagnostics", self.told, 10)
        self.node.create_timer(0.2, self.report)
        self.reports = 0

    def report(self):
        """The value falls below its threshold of 3 once, after somebody listens to marks."""
        if self.marks.get_subscription_count():
            self.reports += 1
        value = 2 if self.reports == 20 else 4
        result = int(value > 3)
        said = f"{KEY},{result},cmp:{value},thresh:3,res:{result}"
        self.node.get_logger().info(f"threshold_information:{said}")
        if self.reports == 25:
            self.marks.publish(self.node.get_clock().now().to_msg())

    def told(self, message):
        statuses = {
            one.name: {
                "level": ord(one.level),
                "message": one.message,
                "values": {pair.key: pair.value for pair in one.values},
            }
            for one in message.status
        }
        print(json.dumps(statuses), flush=True)


rclpy.spin(Dashboard().node)
