"""`pytpc stream --diagnostics` on a real roscore, read by a real rospy subscriber."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from test_watch import Node, comparison, environment, report, static_info

from patience import PATIENCE_S
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.publisher import TIME, RawPublisher, encode_time
from terminals import pytpc

OK, WARN, STALE = 0, 1, 3
HEARD = Path(__file__).with_name("heard_diagnostics.py")


@pytest.fixture
def static(tmp_path: Path) -> Path:
    path = tmp_path / "static.json"
    static_info(comparison(0, "~limit"), comparison(1, "~near")).save(path)
    return path


@pytest.fixture
def graph(tmp_path: Path) -> Iterator[RosGraph]:
    with RosGraph(dict(os.environ), tmp_path / "graph") as started:
        yield started


Statuses = dict[str, dict[str, Any]]


class Dashboard:
    """A rospy node that has subscribed."""

    def __init__(self, graph: RosGraph) -> None:
        self.process = subprocess.Popen(
            ["/usr/bin/python3", str(HEARD)],
            env=graph.env,
            stdout=subprocess.PIPE,
            text=True,
        )

    def wait_for(self, wanted: Callable[[Statuses], bool]) -> Statuses:
        """The first message that says so; many come before it."""
        assert self.process.stdout is not None
        for _ in range(round(PATIENCE_S)):
            line = self.process.stdout.readline()
            assert line, "rospy ended"
            statuses: Statuses = json.loads(line)["status"]
            if wanted(statuses):
                return statuses
        raise AssertionError(f"the last one: {statuses}")

    def close(self) -> None:
        self.process.terminate()
        self.process.wait(PATIENCE_S)
        assert self.process.stdout is not None
        self.process.stdout.close()


@pytest.fixture
def dashboard(graph: RosGraph) -> Iterator[Dashboard]:
    found = Dashboard(graph)
    yield found
    found.close()


@pytest.fixture
def stream(graph: RosGraph, static: Path) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        pytpc("stream", "--diagnostics", "--static", str(static)),
        cwd=static.parent,
        env=environment(graph),
        stderr=subprocess.PIPE,
        text=True,
    )
    with process:
        yield process
        process.kill()


def test_rospy_hears_of_nodes_drops_and_the_first_suspect(
    graph: RosGraph, dashboard: Dashboard, stream: subprocess.Popen[str]
):
    node = Node(graph.uri, "/arm/guard")
    node.wait_for_listeners("tpc_watch")
    first = dashboard.wait_for(lambda found: "tpc: suspects" in found)
    assert first["tpc: suspects"]["level"] == OK
    assert first["tpc: suspects"]["values"]["marks"] == "0"
    assert first["tpc: suspects"]["hardware_id"] == "tpc"

    for cmp in (4, 2, 4):
        node.log(f"threshold_information:{report(0, cmp, 3)}")
    found = dashboard.wait_for(lambda found: "tpc: arm/guard" in found)["tpc: arm/guard"]
    assert found["level"] == OK
    assert float(found["values"]["reports per second"]) > 0
    assert found["values"]["reports dropped"] == "0"

    # The process says that its cap took 7 reports, of which 2 were flops.
    node.log("threshold_dropped:,count:7,flops:2,why:process")
    found = dashboard.wait_for(lambda found: found["tpc: arm/guard"]["level"] == WARN)
    guard = found["tpc: arm/guard"]
    assert guard["message"] == "7 reports dropped"
    assert guard["values"]["dropped since we listen, by reason"] == "process: 7"

    # An observer marks: the robot did something that it should not have.
    marks = RawPublisher(Master(graph.uri, "/observer"), {"/marks0/mark_action": TIME})
    marks.register()
    try:
        until = time.monotonic() + PATIENCE_S
        while not marks.listeners():
            assert time.monotonic() < until
            time.sleep(0.1)
        marks.publish("/marks0/mark_action", encode_time(time.time_ns()))
        found = dashboard.wait_for(
            lambda found: "first suspect" in found["tpc: suspects"]["values"]
        )
    finally:
        marks.close()
        node.publisher.close()
    suspects = found["tpc: suspects"]
    assert suspects["level"] == WARN
    assert suspects["values"]["first suspect"] == "~limit"
    assert suspects["values"]["probability"].endswith("%")
    assert suspects["values"]["marks"] == "1"

    # Nobody reports any more.
    found = dashboard.wait_for(lambda found: found["tpc: arm/guard"]["level"] == STALE)
    assert found["tpc: arm/guard"]["message"].startswith("no report for")
    stream.send_signal(signal.SIGINT)
    _, said = stream.communicate(timeout=PATIENCE_S)
    # Nothing else ends it.
    assert stream.returncode == 0
    assert "passed on 3 evaluations" in said


def test_rostopic_names_the_type(graph: RosGraph, stream: subprocess.Popen[str]):
    assert stream.stderr is not None
    assert "streaming from" in stream.stderr.readline()
    said = subprocess.run(
        ["/usr/bin/rostopic", "echo", "-n1", "/diagnostics/status[0]/name"],
        env=graph.env,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=True,
    )
    assert said.stdout.startswith('"tpc: suspects"')
