"""Decodes messages of either ROS."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pytpc.ingest import ros1, ros2
from pytpc.ingest.ros1 import LogMessage


@dataclass(frozen=True, slots=True)
class Decoders:
    """Decodes the three kinds of messages; each raises ValueError if bytes are missing.

    ``head`` is how many bytes stand before the first field.
    """

    log: Callable[[bytes], LogMessage]
    text: Callable[[bytes], bytes]
    time: Callable[[bytes], int]
    head: int = 0


ROS1 = Decoders(ros1.decode_log, ros1.decode_string, ros1.decode_time)
ROS2 = Decoders(ros2.decode_log, ros2.decode_string, ros2.decode_time, ros2.HEAD)
