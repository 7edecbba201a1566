"""The messages on /diagnostics, `diagnostic_msgs/DiagnosticArray`, for both ROS.

What their fields mean: https://www.ros.org/reps/rep-0107.html.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from pytpc.base.wording import plain, utf8_text
from pytpc.ros.ros1.publisher import MessageType

DIAGNOSTICS = "/diagnostics"
ROS2_TYPE = "diagnostic_msgs/msg/DiagnosticArray"
_LONGEST = 300
_LATEST_S = {1: 2**32 - 1, 2: 2**31 - 1}


class Level(IntEnum):
    """How well something is."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


class DiagnosticStatus(NamedTuple):
    """The state of one thing; ``values`` are words and what they are, in order."""

    level: Level
    name: str
    message: str
    hardware: str
    values: tuple[tuple[str, str], ...]


def ros1_type() -> MessageType:
    """The type as subscribers of ROS 1 ask for it."""
    definition, md5sum = _store(1).generate_msgdef(ROS2_TYPE, ros_version=1)
    return MessageType("diagnostic_msgs/DiagnosticArray", md5sum, definition)


def encode(statuses: Sequence[DiagnosticStatus], time_ns: int, seq: int, ros: int) -> bytes:
    """A message for ROS 1 or 2; long texts are cut, and control characters are replaced."""
    types: Any = _store(ros).types
    seconds, nanoseconds = divmod(max(0, time_ns), 10**9)
    stamp = types["builtin_interfaces/msg/Time"](min(seconds, _LATEST_S[ros]), nanoseconds)
    numbered = {"seq": seq % 2**32} if ros == 1 else {}
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="", **numbered)
    found = [
        types["diagnostic_msgs/msg/DiagnosticStatus"](
            level=int(one.level),
            name=_short(one.name),
            message=_short(one.message),
            hardware_id=_short(one.hardware),
            values=[
                types["diagnostic_msgs/msg/KeyValue"](key=_short(key), value=_short(value))
                for key, value in one.values
            ],
        )
        for one in statuses
    ]
    message = types[ROS2_TYPE](header=header, status=found)
    if ros == 1:
        return bytes(np.asarray(_store(1).serialize_ros1(message, ROS2_TYPE)))
    return bytes(_store(2).serialize_cdr(message, ROS2_TYPE))


@cache
def _store(ros: int) -> Typestore:
    return get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)


def _short(text: str) -> str:
    return utf8_text(plain(text))[:_LONGEST]
