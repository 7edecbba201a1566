"""`pytpc mark` on a real graph: keys in two terminals, messages in a bag, marks read from it."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from pytpc.ingest.reading import read
from pytpc.recording.marks import Mark, read_marks
from pytpc.ros.ros1.graph import GraphProcess, RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.publisher import MessageType, RawPublisher, encode_time
from terminals import Terminal, pytpc

# The layout is that of std_msgs/Time under another name; rosbag needs the definition.
CLOCK = MessageType("rosgraph_msgs/Clock", "a9c97c1d230cfc112e270351a944ee47", "time clock\n")


@pytest.fixture
def graph(tmp_path: Path):
    with RosGraph(dict(os.environ), tmp_path / "graph") as started:
        yield started


def record(graph: RosGraph, bag: Path) -> GraphProcess:
    """rosbag's own recorder, as a user would have it; on return it has connected to nobody yet."""
    regex = "(.*/)?mark_.*"
    command = ["rosbag", "record", "-O", str(bag), "-e", regex]
    return graph.start("record", command, patience_s=20.0)


def mark(graph: RosGraph, folder: Path, observer: str) -> Terminal:
    folder.mkdir(exist_ok=True)
    command = pytpc("mark", "--observer", observer, "-o", f"{observer}.csv")
    environment = {**graph.env, "PYTHONPATH": str(Path(__file__).parents[2])}
    return Terminal(command, folder, env=environment, columns=120)


def end(*terminals: Terminal) -> None:
    for terminal in terminals:
        terminal.press("q")
        assert terminal.wait() == 0


def test_keys_of_two_observers_are_marks_in_the_bag(graph: RosGraph, tmp_path: Path):
    bag = tmp_path / "marks.bag"
    begin = time.time_ns()
    with mark(graph, tmp_path, "ana") as ana, mark(graph, tmp_path, "lab/ben") as ben:
        ana.wait_for("nobody listens; wall time")
        # Nobody listens to this one yet: the recorder gets it when it comes.
        ana.press("1")
        ana.wait_for("1 message kept for later listeners")
        recorder = record(graph, bag)
        for terminal in (ana, ben):
            terminal.wait_for("1 node listening; wall time")
        ben.press("2")
        ben.wait_for("marked: type II")
        ana.press("3n")
        ana.wait_for("note: _")
        ana.press("it turned left, twice\r")
        ana.wait_for("noted")
        ben.press("1")
        ben.wait_for("marked: type I")
        ben.press("u")
        ben.wait_for("taken back: type I")
        end(ana, ben)
        time.sleep(0.5)
        graph.stop(recorder)
    # `rosbag` may end before the recorder that it started has given the bag its name.
    until = time.monotonic() + 10
    while not bag.exists() and time.monotonic() < until:
        time.sleep(0.1)
    found = read(bag).marks
    assert [(one.type, one.observer, one.note) for one in found] == [
        ("I", "ana", ""),
        ("II", "lab/ben", ""),
        (None, "ana", "it turned left, twice"),
    ]
    assert all(begin <= one.time_ns <= time.time_ns() for one in found)
    # What is in the observers' own files is the same.
    files = read_marks(tmp_path / "ana.csv") + read_marks(tmp_path / "lab" / "ben.csv")
    assert sorted(files, key=Mark.order) == list(found)


# A clock at 1,000.5 s as rosbag play --clock publishes it, whether or not somebody has thought of
# /use_sim_time. Both marks are made while it stands.
@pytest.mark.parametrize("said_so", [True, False])
def test_the_time_is_that_of_clock(graph: RosGraph, tmp_path: Path, said_so: bool):
    if said_so:
        graph.call("setParam", "/use_sim_time", True)
    clock = RawPublisher(Master(graph.uri, "/player"), {"/clock": CLOCK})
    try:
        with mark(graph, tmp_path, "ana") as terminal:
            terminal.wait_for("no /clock yet" if said_so else "wall time")
            if said_so:
                terminal.press("1")
                terminal.wait_for("not marked: the graph has no time yet")
            clock.register()
            until = time.monotonic() + 10
            while clock.publish("/clock", encode_time(1000_500_000_000)) == 0:
                assert time.monotonic() < until
                time.sleep(0.05)
            terminal.wait_for("simulated time")
            terminal.press("12")
            terminal.wait_for("marked: type II")
            end(terminal)
    finally:
        clock.close()
    assert read_marks(tmp_path / "ana.csv") == (
        Mark(1000_500_000_000, "I", "ana"),
        Mark(1000_500_000_000 + 1, "II", "ana"),
    )


def test_a_master_that_is_restarted(tmp_path: Path):
    bag = tmp_path / "marks.bag"
    with RosGraph(dict(os.environ), tmp_path / "first") as graph:
        master = graph._processes[0]
        port = graph.uri.rpartition(":")[2]
        with mark(graph, tmp_path, "ana") as terminal:
            terminal.wait_for("connected")
            graph.stop(master)
            terminal.wait_for("the ROS master is gone")
            terminal.press("1")
            terminal.wait_for("marked: type I")
            graph.start("again", ["rosmaster", "--core", "-p", port])
            terminal.wait_for("connected")
            recorder = record(graph, bag)
            terminal.wait_for("1 node listening")
            terminal.press("2")
            terminal.wait_for("marked: type II")
            end(terminal)
            time.sleep(0.5)
            graph.stop(recorder)
    assert [one.type for one in read(bag).marks] == ["I", "II"]
    assert [one.type for one in read_marks(tmp_path / "ana.csv")] == ["I", "II"]
