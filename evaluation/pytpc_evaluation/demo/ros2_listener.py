"""Tells what is heard on a ROS 2 graph, a line of JSON for each message, until it is stopped.

    .venv-ros2/bin/python ros2_listener.py TOPIC=PACKAGE/MESSAGE...

It runs under the interpreter of ROS 2 and imports nothing of TPC. A line has the ``topic``, the
times of the wall and of the graph at which it was heard, and of a time message also ``time``, all
in ns.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import DurabilityPolicy, QoSProfile

LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
VOLATILE = QoSProfile(depth=1000)
_TIMES = ("builtin_interfaces/Time", "rosgraph_msgs/Clock")


class Listener:
    """Hears some topics; of those whose type has a ``+`` also what was said before."""

    def __init__(self, words: list[str]) -> None:
        self.node = rclpy.create_node("demo_listener")
        self._now_ns = 0
        for word in words:
            topic, _, kind = word.partition("=")
            package, _, name = kind.lstrip("+").partition("/")
            message = getattr(importlib.import_module(f"{package}.msg"), name)
            qos = LATCHED if kind.startswith("+") else VOLATILE
            self.node.create_subscription(message, topic, self._hear(topic, kind), qos)

    def _hear(self, topic: str, kind: str) -> Callable[[Any], None]:
        def hear(message: Any) -> None:  # noqa: ANN401
            line: dict[str, object] = {"topic": topic, "wall_ns": time.time_ns()}
            if kind in _TIMES:
                stamp = getattr(message, "clock", message)
                line["time"] = stamp.sec * 10**9 + stamp.nanosec
                if topic == "/clock":
                    self._now_ns = stamp.sec * 10**9 + stamp.nanosec
            print(json.dumps({**line, "graph_ns": self._now_ns}), flush=True)

        return hear


def main(words: list[str]) -> None:
    """Listen until the process is told to stop."""
    rclpy.init()
    listener = Listener(words)
    try:
        rclpy.spin(listener.node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        listener.node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1:])
