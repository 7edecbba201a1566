"""Which answers of nodes a recording of ROS 2 takes, and what the agent keeps for it."""

from __future__ import annotations

import os
import threading

from pytpc.base.errors import RunError
from pytpc.ros.ros2.agent import pipe
from pytpc.ros.ros2.agent_process import Take
from pytpc.ros.ros2.node_values import NodeValues


class Asked:
    """Keeps the questions, which a test answers."""

    def __init__(self) -> None:
        self.takes: list[tuple[str, Take]] = []
        self.has_ended = False

    def values_later(self, node: str, take: Take) -> None:
        if self.has_ended:
            raise RunError("ended")
        self.takes.append((node, take))

    def answer(self, body: bytes, **head: object) -> None:
        _, take = self.takes.pop(0)
        take({"id": 1, **head}, body)


def test_nodes_are_asked_once_and_again_when_they_have_come_back() -> None:
    asked = Asked()
    values = NodeValues(asked)
    for nodes in (["/a", "/a/_tpc"], ["/a", "/b"], ["/b"], ["/a", "/b"]):
        values.see(nodes)
    assert [node for node, _ in asked.takes] == ["/a", "/b", "/a"]
    # Nobody waits for a node that was asked long ago.
    assert values.are_asked_for(60.0)
    assert not values.are_asked_for(0.0)


def test_an_answer_that_crosses_an_event_is_asked_for_again() -> None:
    asked = Asked()
    values = NodeValues(asked)
    values.see(["/a"])
    asked.answer(b"first")
    assert list(values.told()) == [b"first"]
    values.see([])
    values.see(["/a"])
    values.see_event("/a")
    asked.answer(b"may be older than the event")
    assert list(values.told()) == []
    asked.answer(b"newer")
    assert list(values.told()) == [b"newer"]


def test_who_is_set_all_the_time_is_believed_in_the_end() -> None:
    asked = Asked()
    values = NodeValues(asked)
    values.see(["/a"])
    told: list[bytes] = []
    for turn in range(5):
        values.see_event("/a")
        asked.answer(b"%d" % turn)
        told += values.told()
    assert (told, asked.takes) == ([b"4"], [])


def test_errors_and_the_end_of_the_agent_are_no_values() -> None:
    asked = Asked()
    values = NodeValues(asked)
    values.see(["/a", "/b"])
    asked.answer(b"", error="/a does not offer /a/list_parameters")
    _, take = asked.takes.pop()
    take({}, b"")
    assert list(values.told()) == []
    asked.has_ended = True
    values.see(["/c"])
    assert not values.are_asked_for(60.0)


def test_a_stopped_reader_does_not_fill_the_memory(monkeypatch) -> None:
    monkeypatch.setattr(pipe, "MOST_BYTES", 1 << 20)
    reading, writing = os.pipe()
    writer = pipe.Writer(writing)
    for _ in range(64):
        if writer.has_room():
            writer.put(b"{}", b"x" * (1 << 16))
    assert not writer.has_room()
    # Who reads again gets all that was kept, and there is room again.
    frames = 0
    thread = threading.Thread(target=lambda: (writer.close(), os.close(writing)))
    thread.start()
    with os.fdopen(reading, "rb") as stream:
        while (frame := pipe.read_frame(stream)) is not None:
            assert len(frame[1]) == 1 << 16
            frames += 1
    thread.join()
    # 16 frames of 64 KiB and their heads are more than 1 MiB.
    assert frames == 16
    assert writer.has_room()
