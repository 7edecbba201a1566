"""Decodes the three messages that TPC reads from ROS 1's serialised form.

A mission has hundreds of thousands of log messages; only four fields of each are wanted, so they
are unpacked here and not through a general deserialiser. The layouts are those of
rosgraph_msgs/Log, std_msgs/String and std_msgs/Time (little endian, a string is a uint32 length and
bytes).
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from pytpc.base.columns import Int64s

_LENGTH = struct.Struct("<I")
_HEADER = struct.Struct("<IIII")
_TIME = struct.Struct("<II")


class LogMessage(NamedTuple):
    """A log message: ``seq`` is the publisher's own counter, ``stamp_ns`` is 0 if unstamped."""

    seq: int
    stamp_ns: int
    node: bytes
    msg: bytes


def decode_log(raw: bytes) -> LogMessage:
    """Read a rosgraph_msgs/Log up to its text.

    Raises:
        ValueError: the bytes end too early.
    """
    try:
        seq, seconds, nanoseconds, frame = _HEADER.unpack_from(raw)
        node_at = _HEADER.size + frame + 1 + _LENGTH.size
        msg_at = node_at + _LENGTH.unpack_from(raw, node_at - _LENGTH.size)[0] + _LENGTH.size
        end = msg_at + _LENGTH.unpack_from(raw, msg_at - _LENGTH.size)[0]
        if end > len(raw):
            raise struct.error
    except struct.error as error:
        raise ValueError(f"a log message of {len(raw)} bytes ends too early") from error
    stamp_ns = seconds * 10**9 + nanoseconds
    return LogMessage(seq, stamp_ns, raw[node_at : msg_at - _LENGTH.size], raw[msg_at:end])


@dataclass(frozen=True)
class Logs:
    """Log messages as columns: numbers, stamps, and where name and text are in their bytes."""

    seq: Int64s
    stamp_ns: Int64s
    node_begin: Int64s
    node_end: Int64s
    msg_begin: Int64s
    msg_end: Int64s


def decode_logs(data: npt.NDArray[np.uint8], begin: Int64s, end: Int64s) -> Logs | None:
    """Read many rosgraph_msgs/Log up to their texts: those at ``begin`` to ``end`` in ``data``.

    Returns:
        None where one of them ends too early.
    """
    room = np.minimum(end, data.size)
    if bool((begin + _HEADER.size > room).any()):
        return None
    seq, seconds, nanoseconds, frame = (_u32(data, begin + 4 * n) for n in range(4))
    at = begin + _HEADER.size + frame + 1
    if bool((at + _LENGTH.size > room).any()):
        return None
    node_begin = at + _LENGTH.size
    node_end = node_begin + _u32(data, at)
    if bool((node_end + _LENGTH.size > room).any()):
        return None
    msg_begin = node_end + _LENGTH.size
    msg_end = msg_begin + _u32(data, node_end)
    if bool((msg_end > room).any()):
        return None
    stamp_ns = seconds * 10**9 + nanoseconds
    return Logs(seq, stamp_ns, node_begin, node_end, msg_begin, msg_end)


def _u32(data: npt.NDArray[np.uint8], at: Int64s) -> Int64s:
    """int64[n]: the numbers at the bytes ``at``, which need not be aligned."""
    raw = np.ascontiguousarray(data[at[:, None] + np.arange(4)])
    return raw.view("<u4").reshape(-1).astype(np.int64)


def decode_string(raw: bytes) -> bytes:
    """Read a std_msgs/String; its text as it was sent.

    Raises:
        ValueError: the bytes end too early.
    """
    try:
        end = _LENGTH.size + _LENGTH.unpack_from(raw)[0]
    except struct.error:
        end = len(raw) + 1
    if end > len(raw):
        raise ValueError(f"a string message of {len(raw)} bytes ends too early")
    return raw[_LENGTH.size : end]


def decode_time(raw: bytes) -> int:
    """Read a std_msgs/Time, as nanoseconds.

    Raises:
        ValueError: the bytes end too early.
    """
    try:
        seconds, nanoseconds = _TIME.unpack_from(raw)
    except struct.error as error:
        raise ValueError(f"a time message of {len(raw)} bytes ends too early") from error
    return int(seconds) * 10**9 + int(nanoseconds)
