"""Angles and poses."""

import math

from geometry_msgs.msg import Pose


def wrap_angle(angle: float) -> float:
    """The same angle in [-pi, pi]."""
    return math.remainder(angle, 2.0 * math.pi)


def pose_at(x: float, y: float, z: float, yaw: float) -> Pose:
    """An upright pose."""
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z = float(x), float(y), float(z)
    pose.orientation.z, pose.orientation.w = math.sin(0.5 * yaw), math.cos(0.5 * yaw)
    return pose


def yaw_of(pose: Pose) -> float:
    """The heading of an upright pose, rad."""
    return wrap_angle(2.0 * math.atan2(pose.orientation.z, pose.orientation.w))
