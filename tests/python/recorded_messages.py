"""Topics and messages of ROS 1 as a recorder gets them, for tests."""

from __future__ import annotations

import struct

from pytpc.ros.source import Source

CLOCK = Source("/clock", "/sim", "rosgraph_msgs/Clock", "a9c97c1d230cfc112e270351a944ee47", "")
CHAT = Source(
    "/chat", "/talker", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "string data\n"
)
DONE = Source("/done", "/boss", "std_msgs/Bool", "8b94c1b53db61fb6aed406028ad6332a", "bool data\n")
MARK = Source(
    "/a/mark_action", "/a", "std_msgs/Time", "cd7166c74c552c311fbcc2fe5a7bc289", "time data\n"
)
LOG_DEFINITION = """byte DEBUG=1
byte INFO=2
byte WARN=4
byte ERROR=8
byte FATAL=16
Header header
byte level
string name
string msg
string file
string function
uint32 line
string[] topics
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
"""
ROSOUT = Source(
    "/rosout", "/a", "rosgraph_msgs/Log", "acffd30cd6b6de30f120938c17c593fb", LOG_DEFINITION
)


def log(node: bytes, number: int, text: bytes = b"hello", frame: bytes = b"") -> bytes:
    """A rosgraph_msgs/Log as it goes over the wire."""
    texts = b"".join(struct.pack("<I", len(t)) + t for t in (node, text, b"f.cpp", b"run"))
    head = struct.pack("<IIII", number, 7, 500, len(frame)) + frame + b"\x02"
    return head + texts + struct.pack("<II", 12, 0)
