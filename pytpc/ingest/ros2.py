"""Decodes the messages that TPC reads from ROS 2's serialised form (CDR).

A message begins with four bytes; the second gives the byte order. Behind them numbers are aligned
to their size, and a string is a uint32 length, which counts the NUL at its end, and bytes (OMG,
Common Data Representation). The layouts are those of rcl_interfaces/Log, std_msgs/String,
builtin_interfaces/Time and (ROS 1's, bridged) std_msgs/Time.
"""

from __future__ import annotations

import struct

from pytpc.ingest.ros1 import LogMessage

HEAD = 4
_TIME = {0: struct.Struct(">iI"), 1: struct.Struct("<iI")}
_LENGTH = {0: struct.Struct(">I"), 1: struct.Struct("<I")}


def decode_log(raw: bytes) -> LogMessage:
    """Read an rcl_interfaces/Log up to its text; it has no number.

    Its name is a logger's (``robot1.guard``), from which that of the node is made.

    Raises:
        ValueError: the bytes end too early.
    """
    try:
        order = raw[1] & 1
        seconds, nanoseconds = _TIME[order].unpack_from(raw, HEAD)
        # One byte, the level, precedes the name.
        node, at = _string(raw, HEAD + 9, order)
        msg, _ = _string(raw, at, order)
    except (struct.error, IndexError) as error:
        raise ValueError(f"a log message of {len(raw)} bytes ends too early") from error
    return LogMessage(0, seconds * 10**9 + nanoseconds, node_of_logger(node), msg)


def node_of_logger(logger: bytes) -> bytes:
    """The full name of a node whose logger has this name.

    >>> node_of_logger(b"robot1.guard")
    b'/robot1/guard'
    """
    if not logger or logger.startswith(b"/"):
        return logger
    return b"/" + logger.replace(b".", b"/")


def decode_string(raw: bytes) -> bytes:
    """Read a std_msgs/String; its text as it was sent.

    Raises:
        ValueError: the bytes end too early.
    """
    try:
        return _string(raw, HEAD, raw[1] & 1)[0]
    except (struct.error, IndexError) as error:
        raise ValueError(f"a string message of {len(raw)} bytes ends too early") from error


def decode_time(raw: bytes) -> int:
    """Read a builtin_interfaces/Time, as nanoseconds.

    Raises:
        ValueError: the bytes end too early.
    """
    try:
        seconds, nanoseconds = _TIME[raw[1] & 1].unpack_from(raw, HEAD)
    except (struct.error, IndexError) as error:
        raise ValueError(f"a time message of {len(raw)} bytes ends too early") from error
    return int(seconds) * 10**9 + int(nanoseconds)


def _string(raw: bytes, at: int, order: int) -> tuple[bytes, int]:
    at += -(at - HEAD) % 4
    (length,) = _LENGTH[order].unpack_from(raw, at)
    begin = at + 4
    if begin + length > len(raw):
        raise struct.error
    return raw[begin : begin + max(0, length - 1)], begin + length
