"""How the UAV looks for somebody: it turns."""

import math

from rclpy.node import Node

from image_capture_ros2.geometry import wrap_angle


class SearchPattern:
    """The heading while it searches, and how far it has turned; rad and s."""

    def __init__(self, node: Node) -> None:
        self._search_yaw_rate = node.declare_parameter("search_yaw_rate", 0.45).value
        self._reacquire_delay = node.declare_parameter("reacquire_delay", 1.0).value
        self._max_search_rotations = node.declare_parameter("max_search_rotations", 3).value
        self._turned = 0.0
        self._resumed = 0.0
        self._yaw = 0.0

    def resume(self, yaw: float, now: float) -> None:
        """Turn on from here."""
        self._yaw = yaw
        self._resumed = now

    def advance(self, seconds: float) -> float:
        """Where to look next."""
        step = self._search_yaw_rate * seconds
        self._turned += abs(step)
        self._yaw = wrap_angle(self._yaw + step)
        return self._yaw

    def looking(self, now: float) -> bool:
        """Whether what is seen counts; a face that was just lost does not."""
        return now - self._resumed > self._reacquire_delay

    def exhausted(self) -> bool:
        """Whether it has turned often enough."""
        return self._turned > 2.0 * math.pi * self._max_search_rotations
