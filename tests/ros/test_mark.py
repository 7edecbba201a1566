"""`pytpc mark` on a real graph: keys in two terminals, messages in a bag, marks read from it."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest
from recorded_robot import make_workspace

from pytpc.ingest.reading import read
from pytpc.recording.marks import Mark, read_marks
from pytpc.ros.ros1.graph import GraphProcess, RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.publisher import MessageType, RawPublisher, encode_time
from pytpc.ros.ros1.subscriber import RawSubscriber
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


def test_marks_that_no_recorder_got_are_not_promised(graph: RosGraph, tmp_path: Path):
    with mark(graph, tmp_path, "ana") as ana:
        ana.wait_for("no recorder listens")
        ana.press("1")
        ana.wait_for("1 message kept")
        end(ana)
        assert "no recorder on this graph got all of them; to add them to a recording: " in ana.text
        assert "a recording of this graph has them" not in ana.text


def test_keys_of_two_observers_are_marks_in_the_bag(graph: RosGraph, tmp_path: Path):
    bag = tmp_path / "marks.bag"
    begin = time.time_ns()
    with mark(graph, tmp_path, "ana") as ana, mark(graph, tmp_path, "lab/ben") as ben:
        ana.wait_for("no recorder listens; start one with: pytpc record; wall time")
        # Nobody listens to this one yet: the recorder gets it when it comes.
        ana.press("1")
        ana.wait_for("1 message kept for a recorder that starts within 60 s")
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
        assert "a recording of this graph has them" in ana.text
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


def test_where_it_was_wrong_is_chosen_from_the_graph_and_goes_with_the_note(
    graph: RosGraph, tmp_path: Path
):
    talker = RawPublisher(Master(graph.uri, "/talker"), {"/out": CLOCK})
    heard = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", ["/ana/mark_note"])
    try:
        talker.register()
        with mark(graph, tmp_path, "ana") as ana:
            ana.wait_for("1 node listening")
            ana.press("1w")
            ana.wait_for("1 /out (")
            ana.press("ou\r")
            ana.wait_for("wrong at /out")
            end(ana)
        until = time.monotonic() + 10
        while not (notes := [message for _, message in heard.poll(0.1)]):
            assert time.monotonic() < until
    finally:
        heard.close()
        talker.close()
    assert notes[0].endswith(b",@/out")
    assert [one.where for one in read_marks(tmp_path / "ana.csv")] == [("/out",)]


# The listener hears of the topics from the master at once; rosbag asks it once a second.
# The first mark has to wait for both, although the observer leaves right after it.
@pytest.mark.parametrize("command", ["mark", "watch"])
def test_the_first_mark_is_in_the_bag_of_all_topics(graph: RosGraph, tmp_path: Path, command: str):
    bag = tmp_path / "all.bag"
    recorder = graph.start("record", ["rosbag", "record", "-a", "-O", str(bag)], patience_s=20.0)
    until = time.monotonic() + 30
    while not any("/record_" in name for name in Master(graph.uri, "/t").state().nodes):
        assert time.monotonic() < until
        time.sleep(0.05)
    given = ["--static", str(make_workspace(tmp_path / "ws"))] if command == "watch" else []
    environment = {**graph.env, "PYTHONPATH": str(Path(__file__).parents[2])}
    heard = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", ["/mark_action"])
    try:
        words = pytpc(command, *given, "-o", "marks.csv")
        with Terminal(words, tmp_path, env=environment, columns=120, lines=30) as terminal:
            terminal.wait_for("connected;")
            terminal.press("1q")
            assert terminal.wait() == 0
        until = time.monotonic() + 10
        while not list(heard.poll(0.1)):
            assert time.monotonic() < until
    finally:
        heard.close()
    graph.stop(recorder)
    until = time.monotonic() + 10
    while not bag.exists() and time.monotonic() < until:
        time.sleep(0.1)
    assert [mark.type for mark in read(bag).marks] == ["I"]
    assert read(bag).marks == read_marks(tmp_path / "marks.csv")


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
            # With simulated time, rosout listens, too.
            while not any("tpc_mark" in name for name in clock.listeners()):
                assert time.monotonic() < until
                time.sleep(0.05)
            clock.publish("/clock", encode_time(1000_500_000_000))
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
