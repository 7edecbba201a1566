"""The three messages that TPC reads, from ROS 1's serialised form.

A mission has hundreds of thousands of log messages; only four fields of each are wanted, so they
are unpacked here and not through a general deserialiser. The layouts are those of
rosgraph_msgs/Log, std_msgs/String and std_msgs/Time (little endian, a string is a uint32 length and
bytes).
"""

from __future__ import annotations

import struct
from typing import NamedTuple

_LENGTH = struct.Struct("<I")
_HEADER = struct.Struct("<IIII")
_TIME = struct.Struct("<II")


class Log(NamedTuple):
    """A log message: ``seq`` is the publisher's own counter, ``stamp_ns`` 0 where unstamped."""

    seq: int
    stamp_ns: int
    node: bytes
    msg: bytes


def decode_log(raw: bytes) -> Log:
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
    return Log(seq, stamp_ns, raw[node_at : msg_at - _LENGTH.size], raw[msg_at:end])


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
