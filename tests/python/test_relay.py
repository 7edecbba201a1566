"""The relay without ROS: what becomes of log messages, and a master that comes and goes."""

from __future__ import annotations

import struct

import pytest

from pytpc.base.errors import RunError
from pytpc.ros.ros1.relay import MasterWatch, Relay, line_of

KEY = "0d3f2c1e-0000-5000-8000-000000000001"


def text(value: str) -> bytes:
    data = value.encode()
    return struct.pack("<I", len(data)) + data


def log(seq: int, msg: str) -> bytes:
    """A rosgraph_msgs/Log of the node /n at 12.3456789 s."""
    header = struct.pack("<III", seq, 12, 345_678_999) + text("")
    return header + b"\x02" + text("/n") + text(msg) + text("f.cpp") + text("f") + bytes(8)


@pytest.mark.parametrize(
    ("message", "line"),
    [
        (f"threshold_information:{KEY},1,cmp:2,thresh:1,res:1", f"{KEY},1,cmp:2,thresh:1,res:1"),
        (f"threshold_summary:{KEY},1,count:3", f"threshold_summary:{KEY},1,count:3"),
        ("threshold_dropped:,count:3,flops:0,why:nested",) * 2,
        (f"threshold_name:{KEY},/n/arm/limit,of:2",) * 2,
    ],
)
def test_line_has_the_stamp_with_seven_decimals_cut_off(message, line):
    # 345,678,999 ns are 3,456,789 times 100 ns and 99 ns.
    assert line_of(message, 12_345_678_999) == f"12.3456789,{line}"


@pytest.mark.parametrize("message", ["", "threshold_information", "threshold: 3", "x threshold_a:"])
def test_other_log_messages_are_not_passed_on(message):
    assert line_of(message, 1) is None


def test_what_never_came_or_cannot_be_read_is_said():
    lines: list[str] = []
    relay = Relay(lines.append)
    # 0, 1, 4: 2 and 3 never came; what is cut off is counted, not passed on.
    for seq, msg in ((0, "hello"), (1, "threshold_information:a"), (4, "threshold_information:b")):
        relay.take(log(seq, msg))
    relay.take(log(5, "threshold_information:c")[:20])
    assert lines == ["12.3456789,a", "12.3456789,b"]
    assert relay.account() == (
        "2 reports passed on, 2 log messages never came, 1 log message could not be read"
    )


def test_watch_says_each_change_once_and_registers_where_it_is_not_known():
    answers: list[bool | None] = [True, None, None, True, None, False, True]
    left = list(answers)
    said: list[str] = []
    registered: list[int] = []

    def is_known() -> bool:
        answer = left.pop(0)
        if answer is None:
            raise RunError("no answer")
        return answer

    watch = MasterWatch(is_known, lambda: registered.append(len(left)), said.append)
    for _ in answers:
        watch.look()
    # One answer is left when the master does not know the node.
    assert registered == [1]
    gone = "waiting for the master, while connected nodes are still heard: no answer"
    again = "the ROS master was started again: registered with it"
    assert said == [gone, "the ROS master answers again", gone, again]
