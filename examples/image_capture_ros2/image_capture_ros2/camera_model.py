"""What the camera sees: a person, a stone post, clutter, and sunlight that looks like a face."""

import math
from dataclasses import dataclass
from random import Random

from rclpy.node import Node

from image_capture_ros2.geometry import wrap_angle
from image_capture_ros2.sights import HALF_ANGLE, IMAGE_HEIGHT, IMAGE_WIDTH, Blob
from image_capture_ros2.uav_dynamics import UavState

FOCAL_LENGTH = 0.5 * IMAGE_WIDTH / math.tan(HALF_ANGLE)
POST = (6.5, 0.2)
MISSED_IMAGES = 0.03
CLUTTER_PER_IMAGE = 0.2
SUNLIGHT_PAUSE = 3.0
WALL_HALF_ANGLE = 0.65
"""The person stands before a wall without leaves."""


@dataclass(frozen=True)
class Look:
    """How an upright thing looks: m, m, and shares."""

    width: float
    height: float
    contrast: float
    response: float


HEAD = Look(0.45, 0.55, 0.6, 0.85)
STONE = Look(0.3, 0.66, 0.5, 0.8)
"""It has a face's features, but is too slim for one."""


class CameraModel:
    """The person, the other things in the field, and how they come into an image."""

    def __init__(self, node: Node, noise: Random, leaves: Random) -> None:
        self._person_x = node.declare_parameter("person_x", 2.0).value
        self._person_y = node.declare_parameter("person_y", 3.75).value
        self._person_sway = node.declare_parameter("person_sway", 0.01).value
        self._camera_range = node.declare_parameter("camera_range", 8.0).value
        self._noise, self._leaves = noise, leaves
        self._sunlight: tuple[float, float, float] | None = None
        self._begin, self._end = self._next_sunlight(0.0)

    def person(self, time: float) -> tuple[float, float]:
        """Where the person stands, m."""
        x = self._person_x + self._person_sway * math.sin(0.9 * time)
        y = self._person_y + self._person_sway * math.sin(1.3 * time + 1.0)
        return x, y

    def observe(self, uav: UavState, time: float) -> list[Blob]:
        """The blobs of one image."""
        blobs = self._clutter()
        blobs += self._leaves_in_the_sun(uav, time)
        blobs += self._upright(uav, self.person(time), HEAD)
        blobs += self._upright(uav, POST, STONE)
        return blobs

    def _upright(self, uav: UavState, place: tuple[float, float], look: Look) -> list[Blob]:
        dx, dy = place[0] - uav.x, place[1] - uav.y
        distance = math.hypot(dx, dy) + 0.01
        if distance > self._camera_range or self._noise.random() < MISSED_IMAGES:
            return []
        angle = wrap_angle(math.atan2(dy, dx) - uav.yaw)
        if abs(angle) + 0.5 * look.width / distance > HALF_ANGLE:
            return []
        scale = FOCAL_LENGTH / distance
        return [self._blob(angle, scale * look.width, scale * look.height, look)]

    def _leaves_in_the_sun(self, uav: UavState, time: float) -> list[Blob]:
        if time > self._end:
            self._begin, self._end = self._next_sunlight(time)
            self._sunlight = None
        if time < self._begin:
            return []
        if self._sunlight is None:
            bearing = uav.yaw + self._leaves.uniform(-0.8, 0.8) * HALF_ANGLE
            share = self._leaves.uniform(0.04, 0.16)
            self._sunlight = bearing, share, self._leaves.uniform(1.0, 1.5)
        bearing, share, aspect = self._sunlight
        angle = wrap_angle(bearing - uav.yaw)
        x, y = self.person(time)
        wall = math.atan2(y - uav.y, x - uav.x)
        if abs(angle) > HALF_ANGLE or abs(wrap_angle(bearing - wall)) < WALL_HALF_ANGLE:
            return []
        width = math.sqrt(share * IMAGE_WIDTH * IMAGE_HEIGHT / aspect)
        return [self._blob(angle, width, width * aspect, Look(0.0, 0.0, 0.4, 0.75))]

    def _next_sunlight(self, time: float) -> tuple[float, float]:
        begin = time + 1.0 + self._leaves.expovariate(1.0 / SUNLIGHT_PAUSE)
        return begin, begin + self._leaves.uniform(1.0, 1.8)

    def _clutter(self) -> list[Blob]:
        if self._noise.random() >= CLUTTER_PER_IMAGE:
            return []
        width = self._noise.uniform(16.0, 90.0)
        height = width * self._noise.uniform(0.4, 2.5)
        look = Look(0.0, 0.0, self._noise.uniform(0.1, 0.5), self._noise.uniform(0.1, 0.45))
        return [self._blob(self._noise.uniform(-1.0, 1.0) * HALF_ANGLE, width, height, look)]

    def _blob(self, angle: float, width: float, height: float, look: Look) -> Blob:
        gauss = self._noise.gauss
        return Blob(
            -angle / HALF_ANGLE + gauss(0.0, 0.01),
            width * (1.0 + gauss(0.0, 0.02)),
            height * (1.0 + gauss(0.0, 0.02)),
            look.contrast + gauss(0.0, 0.03),
            look.response + gauss(0.0, 0.03),
        )
