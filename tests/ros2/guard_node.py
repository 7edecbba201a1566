"""A node of rclpy that reports as an instrumented one does, with its hidden node of settings.

Arguments: reports a second, seconds, and the key of its comparison.
"""

import sys
import time

import rclpy
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

KEY = sys.argv[3] if len(sys.argv) > 3 else "00000001-0000-5000-8000-000000000000"
TURN_S = 0.02


class Guard:
    """Compares 0 to 9 with the parameter limits.speed, again and again."""

    def __init__(self, name, rate):
        self.node = Node(name, namespace="/robot1")
        self.node.declare_parameter("limits.speed", 6.5)
        self.node.add_on_set_parameters_callback(self.allow)
        self.publisher = self.node.create_publisher(String, "/threshold_information", 512)
        self.count = round(rate * TURN_S)
        self.sent = 0
        self.settings = Node("_tpc", namespace=f"/robot1/{name}")
        for setting, value in (("sink", "topic"), ("policy", "light"), ("period", 1.0)):
            self.settings.declare_parameter(setting, value)
        read_only = ParameterDescriptor(read_only=True)
        self.settings.declare_parameter("status", "sink=topic sites=3 dropped=0", read_only)
        self.settings.add_on_set_parameters_callback(self.allow_setting)

    @staticmethod
    def allow(parameters):
        good = all(one.value <= 10 for one in parameters if one.name == "limits.speed")
        return SetParametersResult(successful=good, reason="" if good else "at most 10")

    @staticmethod
    def allow_setting(parameters):
        good = all(one.value != "file" for one in parameters if one.name == "sink")
        return SetParametersResult(successful=good, reason="" if good else "no folder")

    def report(self):
        limit = self.node.get_parameter("limits.speed").value
        now = self.node.get_clock().now().nanoseconds
        stamp = f"{now // 10**9}.{now % 10**9:09d}"
        head = f"#seq:{self.sent},count:{self.count},dropped:0,pid:7,steady:1.0"
        head += f",node:{self.node.get_fully_qualified_name()}"
        lines = [
            f"{stamp},{KEY},{int(at % 10 > limit)},cmp:{at % 10},thresh:{limit:g},res:1"
            for at in range(self.sent, self.sent + self.count)
        ]
        self.publisher.publish(String(data="\n".join([head, *lines])))
        self.sent += self.count


def main():
    rate, seconds = int(sys.argv[1]), float(sys.argv[2])
    rclpy.init()
    guard = Guard("guard", rate)
    executor = SingleThreadedExecutor()
    executor.add_node(guard.node)
    executor.add_node(guard.settings)
    print("ready", flush=True)
    while guard.publisher.get_subscription_count() == 0:
        executor.spin_once(timeout_sec=0.05)
    began = time.monotonic()
    turn = 0
    while time.monotonic() < began + seconds:
        guard.report()
        turn += 1
        while time.monotonic() < began + turn * TURN_S:
            executor.spin_once(timeout_sec=0.002)
    print(guard.sent, flush=True)
    # What was published last is still on its way.
    sys.stdin.readline()
    rclpy.shutdown()


main()
