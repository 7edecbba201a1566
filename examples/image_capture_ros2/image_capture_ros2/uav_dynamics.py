"""How the UAV flies."""

import math
from dataclasses import dataclass
from random import Random

from geometry_msgs.msg import Twist
from rclpy.node import Node

from image_capture_ros2.geometry import wrap_angle

GRAVITY = 9.81
FULL_VOLTAGE = 12.4
EMPTY_VOLTAGE = 10.2
VELOCITY_LAG = 0.25
YAW_LAG = 0.15


@dataclass
class UavState:
    """Place and velocity in the world's frame."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    vx: float = 0.0
    vy: float = 0.0
    vz: float = 0.0
    yaw: float = 0.0
    yaw_rate: float = 0.0


class UavDynamics:
    """Follows commanded velocities with a delay, in the wind."""

    def __init__(self, node: Node, noise: Random) -> None:
        self._battery_seconds = node.declare_parameter("battery_seconds", 600.0).value
        self._battery_empty_voltage = node.declare_parameter("battery_empty_voltage", 10.3).value
        self._enable_wind = node.declare_parameter("enable_wind", True).value
        self._noise = noise
        self._gust_x = self._gust_y = 0.0
        self._charge = 1.0
        self._empty = False
        self.state = UavState()
        self.motors_on = False

    def step(self, command: Twist, seconds: float) -> None:
        """Fly for a moment."""
        uav = self.state
        powered = self.motors_on and not self._empty
        if powered:
            self._charge -= seconds / self._battery_seconds
            uav.vz += (command.linear.z - uav.vz) * seconds / VELOCITY_LAG
        else:
            uav.vz -= GRAVITY * seconds
        uav.z += uav.vz * seconds
        if uav.z <= 0.0 and uav.vz <= 0.0:
            uav.z = uav.vx = uav.vy = uav.vz = uav.yaw_rate = 0.0
            return
        self._blow(seconds)
        uav.vx += (command.linear.x - uav.vx) * seconds / VELOCITY_LAG + self._gust_x * seconds
        uav.vy += (command.linear.y - uav.vy) * seconds / VELOCITY_LAG + self._gust_y * seconds
        uav.yaw_rate += (command.angular.z - uav.yaw_rate) * seconds / YAW_LAG
        uav.x += uav.vx * seconds
        uav.y += uav.vy * seconds
        uav.yaw = wrap_angle(uav.yaw + uav.yaw_rate * seconds)

    def voltage(self) -> float:
        """What the battery gives, V."""
        sag = 0.2 if self.motors_on else 0.0
        voltage = EMPTY_VOLTAGE + (FULL_VOLTAGE - EMPTY_VOLTAGE) * self._charge - sag
        if voltage < self._battery_empty_voltage:
            self._empty = True
        return voltage + self._noise.gauss(0.0, 0.03)

    def _blow(self, seconds: float) -> None:
        if not self._enable_wind:
            return
        keep = math.exp(-seconds / 2.0)
        self._gust_x = keep * self._gust_x + self._noise.gauss(0.0, 0.01)
        self._gust_y = keep * self._gust_y + self._noise.gauss(0.0, 0.01)
