"""``pytpc record`` of a running robot: the static information, and where values came from."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from recorded_robot import make_workspace

from pytpc.ros.node_start import with_python
from pytpc.ros.ros1.graph import RosGraph
from terminals import pytpc

ROOT = Path(__file__).parents[2]
LIMIT_S = 60.0
# Nothing was sourced where it is recorded.
SOURCED = ("ROS_PACKAGE_PATH", "CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH", "TPC_STATIC")
WITH_INCLUDE = """<launch>
  <arg name="limit" default="0.5"/>
  <include file="$(find robot_base)/launch/robot.launch"><arg name="limit" value="$(arg limit)"/>
  </include>
</launch>
"""


class Recorded(NamedTuple):
    folder: Path
    said: str


@pytest.fixture
def graph(tmp_path: Path) -> Iterator[RosGraph]:
    with RosGraph(dict(os.environ), tmp_path / "graph") as started:
        yield started


@pytest.fixture
def robot(graph: RosGraph, tmp_path: Path) -> Path:
    """A workspace whose node runs and reports."""
    robot = make_workspace(tmp_path / "ws")
    graph.call("setParam", "/robot/limit", 0.25)
    env = with_python(graph.env, robot / ".tpc/static.json")
    script = robot / "src/robot_base/scripts/robot.py"
    graph.start("robot", ["/usr/bin/python3", str(script)], env=env)
    return robot


def record(graph: RosGraph, folder: Path, *words: str, **given: str) -> Recorded:
    """Record until the first report."""
    here = folder / "here"
    here.mkdir()
    sourced = {name: value for name, value in os.environ.items() if name not in SOURCED}
    own = {name: value for name, value in graph.env.items() if name not in SOURCED}
    with (folder / "said").open("wb") as said:
        recording = subprocess.Popen(
            pytpc("record", "-o", "out", *words),
            cwd=here,
            env={**sourced, **own, "PYTHONPATH": str(ROOT), **given},
            stdout=said,
            stderr=said,
            start_new_session=True,
        )
    until = time.monotonic() + LIMIT_S
    while not any(": 0 reports" not in line for line in progress(folder)):
        assert time.monotonic() < until
        assert recording.poll() is None, (folder / "said").read_text()
        time.sleep(0.1)
    recording.send_signal(signal.SIGINT)
    text = (folder / "said").read_text() if recording.wait(LIMIT_S) else ""
    assert recording.returncode == 0, text
    return Recorded(here / "out", (folder / "said").read_text())


def progress(folder: Path) -> list[str]:
    return [one for one in (folder / "said").read_text().splitlines() if " s, " in one]


def run_json(recorded: Recorded) -> dict[str, object]:
    document: dict[str, object] = json.loads((recorded.folder / "run.json").read_text())
    return document


def test_what_is_given_is_kept(graph: RosGraph, robot: Path, tmp_path: Path) -> None:
    recorded = record(graph, tmp_path, "--static", str(robot))
    original = robot / ".tpc/static.json"
    assert (recorded.folder / "static.json").read_bytes() == original.read_bytes()
    static = run_json(recorded)["static"]
    assert isinstance(static, dict)
    assert (static["path"], static["guessed"]) == (str(original), False)
    assert "does not know which file sets which value" in recorded.said


def test_what_is_sourced_is_kept(graph: RosGraph, robot: Path, tmp_path: Path) -> None:
    recorded = record(graph, tmp_path, ROS_PACKAGE_PATH=str(robot / "src"))
    assert (recorded.folder / "static.json").is_file()
    assert f"pytpc: static information: {robot}/.tpc/static.json; the rec" in recorded.said
    static = run_json(recorded)["static"]
    assert isinstance(static, dict)
    assert static["guessed"] is True


def test_none_is_found(graph: RosGraph, robot: Path, tmp_path: Path) -> None:
    # The folder of the test is above the recording's.
    recorded = record(graph, tmp_path)
    assert not (recorded.folder / "static.json").exists()
    assert "so the recording keeps none; give it with --static WORKSPACE" in recorded.said
    assert robot.is_dir()


# The launch file finds a package of the workspace, which is not sourced.
def test_where_values_came_from(graph: RosGraph, robot: Path, tmp_path: Path) -> None:
    launch = tmp_path / "all.launch"
    launch.write_text(WITH_INCLUDE)
    words = ("--launch", str(launch), "limit:=0.25")
    recorded = record(graph, tmp_path, "--static", str(robot), *words)
    origins = json.loads((recorded.folder / "origins.json").read_text())
    found = origins["parameters"]["/robot/limit"]
    assert (found["kind"], found["value"]) == ("argument", 0.25)
    assert "is not known" not in recorded.said


def test_a_launch_file_that_cannot_be_read(graph: RosGraph, robot: Path, tmp_path: Path) -> None:
    launch = tmp_path / "all.launch"
    launch.write_text(WITH_INCLUDE)
    recorded = record(graph, tmp_path, "--launch", str(launch))
    assert "warning: where values came from is not known: " in recorded.said
    assert "robot_base" in recorded.said
    assert robot.is_dir()


def test_a_launch_file_of_a_workspace_has_its_own(tmp_path: Path) -> None:
    done = subprocess.run(
        pytpc("record", "--static", "x", "ws", "a.launch"),
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    assert done.returncode == 2
    assert "--static is only for a running graph" in done.stderr
