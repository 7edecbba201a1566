"""`pytpc watch` on a real graph: reports by three ways, marks, and a master that is restarted."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from patience import PATIENCE_S
from pytpc.recording.marks import read_marks
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.publisher import STRING, MessageType, RawPublisher, encode_string
from pytpc.ros.ros1.subscriber import RawSubscriber
from screens import Screen
from terminals import Terminal, pytpc

sys.path.insert(0, str(Path(__file__).parents[1] / "python"))
from mission_samples import comparison, key, static_info

ROOT = Path(__file__).parents[2]
# rospy's and roscpp's subscribers check the sum, and only the definition's text is not looked at.
LOG = MessageType("rosgraph_msgs/Log", "acffd30cd6b6de30f120938c17c593fb", "Header header\n")


class Node:
    """A node that reports: by log messages, and by single lines as Python nodes do."""

    def __init__(self, master: str, name: str) -> None:
        self.name = name
        self.number = 0
        topics = {"/rosout": LOG, "/threshold_information": STRING}
        self.publisher = RawPublisher(Master(master, name), topics)
        self.publisher.register()

    def log(self, text: str) -> None:
        self.number += 1
        stamp = time.time_ns()
        head = struct.pack("<IIII", self.number, stamp // 10**9, stamp % 10**9, 0)
        strings = [self.name.encode(), text.encode(), b"node.cpp", b"step"]
        name, *rest = [struct.pack("<I", len(part)) + part for part in strings]
        message = head + b"\x02" + name + b"".join(rest) + struct.pack("<II", 1, 0)
        self.publisher.publish("/rosout", message)

    def line(self, text: str) -> None:
        stamp = time.time_ns()
        said = f"{stamp // 10**9}.{stamp % 10**9 // 100:07d},{text}"
        self.publisher.publish("/threshold_information", encode_string(said))

    def wait_for_listeners(self, *names: str, topic: str = "/rosout") -> None:
        until = time.monotonic() + PATIENCE_S
        while not all(any(n in one for one in self.publisher.listeners(topic)) for n in names):
            assert time.monotonic() < until, self.publisher.listeners(topic)
            time.sleep(0.05)


def report(number: int, cmp: float, thresh: float) -> str:
    result = int(cmp > thresh)
    return f"{key(number)},{result},cmp:{cmp},thresh:{thresh},res:{result}"


@pytest.fixture
def static(tmp_path: Path) -> Path:
    path = tmp_path / "static.json"
    static_info(comparison(0, "~flops"), comparison(1, "~near"), comparison(2, "~gone")).save(path)
    return path


@pytest.fixture
def graph(tmp_path: Path) -> Iterator[RosGraph]:
    with RosGraph(dict(os.environ), tmp_path / "graph") as started:
        yield started


def environment(graph: RosGraph) -> dict[str, str]:
    return {**graph.env, "PYTHONPATH": str(ROOT)}


def watch(graph: RosGraph, static: Path, *options: str) -> Screen:
    command = pytpc("watch", "--static", str(static), "-o", "marks.csv", *options)
    terminal = Terminal(command, static.parent, env=environment(graph), columns=120, lines=30)
    return Screen(terminal, 120, 30)


# ~flops is above 3, below, above: two flops. ~near comes as near as 0.01 to its 1 within 0 to 1.
# A relay passes the log messages on, which makes them no more than they are: 6 reports in all.
def test_reports_of_all_ways_are_ranked_and_marked(graph: RosGraph, static: Path):
    relay = graph.start("relay", pytpc("relay"), env={"PYTHONPATH": str(ROOT)})
    logs, python = Node(graph.uri, "/logs"), Node(graph.uri, "/python")
    heard = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", ["/mark_no_action"])
    try:
        with watch(graph, static) as screen:
            screen.wait_for("watching on", "0 evaluations of 0 nodes")
            logs.wait_for_listeners("tpc_relay", "tpc_watch")
            python.wait_for_listeners("tpc_watch", topic="/threshold_information")
            for cmp in (4, 2, 4):
                logs.log(f"threshold_information:{report(0, cmp, 3)}")
            for cmp in (0.0, 0.5, 0.99):
                python.line(report(1, cmp, 1))
            screen.wait_for("6 evaluations of 2 nodes", "~flops", "~near")
            time.sleep(1.0)
            screen.read()
            assert "6 evaluations of 2 nodes" in screen.text
            screen.press("2")
            screen.wait_for("marked: type II", "II  1 ~")
            until = time.monotonic() + 5
            messages = []
            while not messages:
                assert time.monotonic() < until
                messages = list(heard.poll(0.2))
            screen.press("q")
            assert screen.terminal.wait() == 0
    finally:
        heard.close()
        graph.stop(relay)
        logs.publisher.close()
        python.publisher.close()
    (mark,) = read_marks(static.parent / "marks.csv")
    seconds, nanoseconds = struct.unpack("<II", messages[0][1])
    assert mark.time_ns == seconds * 10**9 + nanoseconds
    assert mark.type == "II"


def test_a_master_that_is_restarted(static: Path, tmp_path: Path):
    with RosGraph(dict(os.environ), tmp_path / "first") as graph:
        port = graph.uri.rpartition(":")[2]
        with watch(graph, static) as screen:
            screen.wait_for("0 evaluations of 0 nodes", "connected")
            graph.stop(graph._processes[0])
            screen.wait_for("does not answer", "the ROS master is gone")
            graph.start("again", ["rosmaster", "--core", "-p", port])
            screen.wait_without("does not answer")
            node = Node(graph.uri, "/late")
            try:
                node.wait_for_listeners("tpc_watch")
                node.log(f"threshold_information:{report(0, 4, 3)}")
                screen.wait_for("1 evaluation of 1 node")
            finally:
                node.publisher.close()
            screen.press("q")
            assert screen.terminal.wait() == 0


def test_once_as_json(graph: RosGraph, static: Path):
    node = Node(graph.uri, "/logs")
    command = pytpc("watch", "--static", str(static), "--json", "--seconds", "3")
    with subprocess.Popen(
        command, env=environment(graph), stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            node.wait_for_listeners("tpc_watch")
            for number, cmp in ((0, 4), (0, 2), (1, 5), (1, 0), (9, 1)):
                node.log(f"threshold_information:{report(number, cmp, 3)}")
            said = json.loads(process.communicate(timeout=20)[0])
        finally:
            process.kill()
            node.publisher.close()
    assert (said["evaluations"], said["unknown_keys"], said["lost"], said["nodes"]) == (5, 1, 0, 1)
    names = [one["parameter"] for one in said["rankings"]["I"]["suspects"]]
    assert sorted(names) == ["~flops", "~near"]
    assert said["rankings"]["combined"]["suspects"][0]["node"] == "/logs"


def test_once_without_a_master_is_an_error(static: Path):
    env = {**os.environ, "PYTHONPATH": str(ROOT), "ROS_MASTER_URI": "http://127.0.0.1:9"}
    command = pytpc("watch", "--static", str(static), "--once", "--seconds", "1")
    done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=20, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    assert "does not answer" in done.stderr
    assert done.stderr.count("\n") == 1
