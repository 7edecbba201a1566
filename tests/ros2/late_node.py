"""A node of rclpy that is slow, for test_record_slow_ros2.py: each line of its input is a step.

It has a latched topic, and answers nobody before ``answer``. Then topics come with other qualities
of service: the second publisher of /scan offers less than the first one.
"""

import sys
import threading

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = Node("late", namespace="/robot1")
    node.declare_parameter("limits.speed", 6.5)
    node.declare_parameter("qos_overrides./scan.publisher.depth", 7)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_publisher(String, "/map", latched).publish(String(data="once"))
    reliable = node.create_publisher(String, "/scan", 10)
    node.create_timer(0.05, lambda: reliable.publish(String(data="reliable")))
    print("ready", flush=True)
    sys.stdin.readline()
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    sys.stdin.readline()
    best = node.create_publisher(
        String, "/scan", QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    )
    node.create_timer(0.05, lambda: best.publish(String(data="best effort")))
    sys.stdin.readline()


main()
