"""Ends the flight outside of its limits."""

import math

from geometry_msgs.msg import Point
from rclpy.node import Node
from std_msgs.msg import String


class SafetyMonitor:
    """Publishes an alarm where the UAV is outside of its limits."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._geofence_radius = node.declare_parameter("geofence_radius", 12.0).value
        self._max_height = node.declare_parameter("max_height", 4.0).value
        self._battery_abort_voltage = node.declare_parameter("battery_abort_voltage", 10.6).value
        self._battery_abort_samples = node.declare_parameter("battery_abort_samples", 20).value
        self._battery_warn_voltage = node.declare_parameter("battery_warn_voltage", 11.0).value
        self._alarm_repeat_period = node.declare_parameter("alarm_repeat_period", 2.0).value
        self._alarm_pub = node.create_publisher(String, "/safety/alarm", 10)
        self._last_alarm: float | None = None
        self._voltage = 12.0
        self._empty_samples = 0
        self._warnings = 0

    def add_voltage(self, voltage: float) -> None:
        """Take in a reading of the battery, V."""
        self._voltage += 0.3 * (voltage - self._voltage)
        if self._voltage < self._battery_warn_voltage:
            self._warnings += 1
            self._node.get_logger().warning(f"{self._warnings} low readings of the battery")
        # A single reading below the limit is the motors' load, not the charge.
        if self._voltage < self._battery_abort_voltage:
            self._empty_samples += 1
        else:
            self._empty_samples = 0

    def check(self, place: Point, now: float) -> None:
        """Raise an alarm where one is due."""
        if not self._inside_fence(place):
            self._raise("outside the fence", now)
        elif place.z > self._max_height:
            self._raise("too high", now)
        elif self._empty_samples >= self._battery_abort_samples:
            self._raise("battery empty", now)

    def _inside_fence(self, place: Point) -> bool:
        return math.hypot(place.x, place.y) <= self._geofence_radius

    def _raise(self, text: str, now: float) -> None:
        if self._last_alarm is not None and now - self._last_alarm < self._alarm_repeat_period:
            return
        self._last_alarm = now
        self._alarm_pub.publish(String(data=text))
