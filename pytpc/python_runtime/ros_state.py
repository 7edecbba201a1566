"""The node of this process and its ROS time, under the ROS that the program has imported."""

from __future__ import annotations

import sys
from typing import NamedTuple

from pytpc.python_runtime import ros1_state, ros2_state


class Now(NamedTuple):
    """The node's name and its ROS time (0: not known)."""

    node: str
    ros_ns: int
    is_simulated: bool


_UNKNOWN = Now("", 0, False)


def is_ros2() -> bool:
    """Whether reports go the way of ROS 2: the program has imported rclpy, and not rospy."""
    if ros2_state.has_node():
        return ros1_state.rospy() is None
    return "rclpy" in sys.modules and "rospy" not in sys.modules


def has_node() -> bool:
    """Whether the program has made a node."""
    return ros2_state.has_node() or ros1_state.rospy() is not None


def time_now_ns() -> int:
    """The node's time where it is simulated, else the wall clock's."""
    return ros2_state.time_now_ns() if ros2_state.has_node() else ros1_state.time_now_ns()


def now() -> Now:
    """The node, and its time in ns."""
    if ros1_state.rospy() is None and ros2_state.has_node():
        return Now(ros2_state.name(), ros2_state.time_now_ns(), ros2_state.is_simulated())
    known = ros1_state.now()
    return _UNKNOWN if known is None else Now(*known)
