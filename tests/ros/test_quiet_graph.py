"""A graph that reports nothing is recorded: why, as the nodes and the master tell it."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from recorded_robot import make_workspace

from pytpc.ros.node_start import with_python
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.quiet_graph import QuietWatch
from pytpc.ros.ros1.recorder import GraphRecorder, Wanted
from terminals import pytpc

ROOT = Path(__file__).parents[2]
IDLE = "import rospy; rospy.init_node('idle'); rospy.spin()"
LIMIT_S = 60.0


@pytest.fixture
def graph(tmp_path: Path) -> Iterator[RosGraph]:
    with RosGraph(dict(os.environ), tmp_path / "graph") as started:
        yield started


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    return make_workspace(tmp_path / "ws")


def start(graph: RosGraph, robot: Path, *words: str, **env: str) -> None:
    """Start a node that reports, if it compares anything."""
    given = with_python(graph.env, robot / ".tpc/static.json")
    graph.start("node", ["/usr/bin/python3", *words], env={**given, **env})


def told(
    graph: RosGraph,
    bag: Path,
    node: str = "",
    until: Callable[[], object] = lambda: True,
    patience_s: float = 1.0,
) -> list[tuple[str, bool]]:
    """What is said while the graph is recorded until something is true.

    The watch begins when the recorder is connected to the log messages of ``node``.
    """
    said: list[tuple[str, bool]] = []
    watch = QuietWatch(
        graph.uri, lambda line, is_fault: said.append((line, is_fault)), patience_s=patience_s
    )
    wanted = Wanted(["/rosout", "/threshold_information"])
    recorder = GraphRecorder(Master(graph.uri, "/tpc_recorder_7"), "127.0.0.1", wanted, bag)
    limit = time.monotonic() + LIMIT_S
    try:
        while not said and not (found := recorder.step()).is_reporting:
            if not node or node in found.heard:
                watch.see(found)
            assert time.monotonic() < limit
        watch.see(recorder.step())
        while not until():
            recorder.step()
            assert time.monotonic() < limit
    finally:
        watch.close()
        recorder.finish()
    return said


CASES = {
    "off": ("1 node (/robot) is switched off", True),
    "file": ("1 node (/robot) writes reports to files (", False),
}


@pytest.mark.parametrize("sink", CASES)
def test_the_sink_is_told(graph: RosGraph, robot: Path, tmp_path: Path, sink: str) -> None:
    script = str(robot / "src/robot_base/scripts/robot.py")
    start(graph, robot, script, TPC_SINK=sink, TPC_FOLDER=str(tmp_path / "files"))
    # It offers its settings after its first report.
    master = Master(graph.uri, "/t")
    until = time.monotonic() + LIMIT_S
    while "/robot/tpc/reload" not in master.state().services:
        assert time.monotonic() < until
        time.sleep(0.05)
    ((line, is_fault),) = told(graph, tmp_path / "a.bag", "/robot")
    words, fault = CASES[sink]
    assert words in line
    assert is_fault == fault
    if sink == "file":
        assert f"({tmp_path}/files/" in line


def test_a_node_that_has_compared_nothing_is_no_fault(
    graph: RosGraph, robot: Path, tmp_path: Path
) -> None:
    start(graph, robot, "-c", IDLE)
    ((line, is_fault),) = told(graph, tmp_path / "a.bag", "/idle")
    assert "1 node (/idle) is built with TPC, and has compared nothing so far" in line
    assert not is_fault


# The watch ends at the first report, long before its patience.
def test_nothing_is_said_of_a_robot_that_reports(
    graph: RosGraph, robot: Path, tmp_path: Path
) -> None:
    start(graph, robot, str(robot / "src/robot_base/scripts/robot.py"))

    def is_over() -> bool:
        return all(thread.name != "quiet" for thread in threading.enumerate())

    assert told(graph, tmp_path / "a.bag", until=is_over, patience_s=2 * LIMIT_S) == []


def test_record_says_that_nodes_are_not_built_with_tpc(graph: RosGraph, tmp_path: Path) -> None:
    graph.start("node", ["/usr/bin/python3", "-c", IDLE])
    recording = subprocess.Popen(
        pytpc("record", "-o", "out"),
        cwd=tmp_path,
        env={**os.environ, **graph.env, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert recording.stderr is not None
    for line in recording.stderr:
        if "not built" in line:
            break
    recording.send_signal(signal.SIGINT)
    recording.communicate(timeout=LIMIT_S)
    assert recording.returncode == 0
    assert line.startswith(
        "pytpc: warning: no reports: 1 node (/idle) is not built with TPC; start"
    )
    assert 'eval "$(pytpc env --setup WORKSPACE)"' in line


def test_record_waits_for_a_robot_and_says_so(graph: RosGraph, tmp_path: Path) -> None:
    ((line, is_fault),) = told(graph, tmp_path / "a.bag")
    assert line.startswith(f"no node of a robot runs at {graph.uri} yet; start the robot")
    assert not is_fault


def test_a_node_that_died_is_not_a_robot_that_cannot_be_reached(
    graph: RosGraph, tmp_path: Path
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        uri = f"http://127.0.0.1:{listener.getsockname()[1]}/"
    Master(graph.uri, "/human_7").call("registerPublisher", "/rosout", "rosgraph_msgs/Log", uri)
    ((line, is_fault),) = told(graph, tmp_path / "a.bag")
    assert line.startswith(f"no node of a robot runs at {graph.uri} yet; 1 node (/human_7) that")
    assert not is_fault
