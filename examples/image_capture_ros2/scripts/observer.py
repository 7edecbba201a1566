#!/usr/bin/env python3
"""A scripted observer: sees what a person beside the field sees, and sets marks.

    PYTHONPATH=examples/simulated_world/src observer.py [SEED]

It sees the UAV, the person and the shutter; no parameter, report or treatment. What is wrong is
said by the rules that it shares with the observer of the robot in C++.
"""

from __future__ import annotations

import math
import sys

import rclpy
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, PoseStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import CompressedImage
from simulated_world.field import FieldRules, Sight
from simulated_world.person import TYPE_I, TYPE_II, Person


class Observer(Node):
    """One person with two keys."""

    def __init__(self, seed: int) -> None:
        super().__init__("observer")
        self._mind = Person(FieldRules(), seed)
        self._somebody: Point | None = None
        self._pictures = 0
        self._keys = {key: self.create_publisher(Time, f"/{key}", 10) for key in (TYPE_I, TYPE_II)}
        self.create_subscription(PoseStamped, "/truth/person", self._on_person, 100)
        self.create_subscription(CompressedImage, "/camera/picture", self._on_click, 10)
        self.create_subscription(PoseStamped, "/truth/uav", self._on_uav, 100)

    def _on_person(self, message: PoseStamped) -> None:
        self._somebody = message.pose.position

    def _on_click(self, _: CompressedImage) -> None:
        self._pictures += 1

    def _on_uav(self, message: PoseStamped) -> None:
        if self._somebody is None:
            return
        place, turn = message.pose.position, message.pose.orientation
        stamp = message.header.stamp
        time = stamp.sec + 1e-9 * stamp.nanosec
        yaw = 2.0 * math.atan2(turn.z, turn.w)
        person = self._somebody
        sight = Sight(time, place.x, place.y, place.z, yaw, person.x, person.y, self._pictures)
        for mark in self._mind.see(sight):
            self.get_logger().info(f"{mark.topic} at {mark.time:.2f}: {mark.reason}")
            whole = math.floor(mark.time)
            pressed = Time(sec=whole, nanosec=int((mark.time - whole) * 1e9))
            self._keys[mark.topic].publish(pressed)


def main(words: list[str]) -> None:
    """Watch until the node is told to stop."""
    rclpy.init()
    node = Observer(int(words[0]) if words else 1)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1:])
