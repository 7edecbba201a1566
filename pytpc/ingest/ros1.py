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
_HEADER = struct.Struct("<III")
_TIME = struct.Struct("<II")


class Log(NamedTuple):
    """A log message: ``seq`` is the publisher's own counter, ``stamp_ns`` 0 where unstamped."""

    seq: int
    stamp_ns: int
    node: str
    msg: str


def decode_log(raw: bytes) -> Log:
    """Read a rosgraph_msgs/Log up to its text.

    Raises:
        ValueError: the bytes end too early.
    """
    try:
        seq, seconds, nanoseconds = _HEADER.unpack_from(raw)
        _, place = _string(raw, _HEADER.size)
        node, place = _string(raw, place + 1)
        msg, _ = _string(raw, place)
    except struct.error as error:
        raise ValueError(f"a log message of {len(raw)} bytes ends too early") from error
    return Log(seq, seconds * 10**9 + nanoseconds, node, msg)


def decode_string(raw: bytes) -> str:
    """Read a std_msgs/String.

    Raises:
        ValueError: the bytes end too early.
    """
    try:
        return _string(raw, 0)[0]
    except struct.error as error:
        raise ValueError(f"a string message of {len(raw)} bytes ends too early") from error


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


def _string(raw: bytes, place: int) -> tuple[str, int]:
    (length,) = _LENGTH.unpack_from(raw, place)
    start = place + _LENGTH.size
    end = start + length
    if end > len(raw):
        raise struct.error
    return raw[start:end].decode("utf-8", "replace"), end
