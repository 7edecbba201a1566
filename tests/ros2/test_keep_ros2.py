"""`pytpc keep` on a real ROS 2 graph: a ring beside the default sink, marks and values."""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from patience import PATIENCE_S, wait_for
from pytpc.ingest.reading import read
from pytpc.ingest.ring_files import rings_in
from pytpc.recording.parameter_values import ParameterValues
from ros2_commands import answer, interrupted, pytpc, running
from ros2_graph import PYTHON, ros2_env
from ros2_reporting import Program

SPEED = "/robot1/guard/limits.speed"
# 0 and 9 in turn: both sides of 6.5.
GUARD = """
from rclpy.executors import SingleThreadedExecutor
rclpy.init()
node = Node("guard", namespace="/robot1")
node.declare_parameter("limits.speed", 6.5)
executor = SingleThreadedExecutor()
executor.add_node(node)
count = 0
while True:
    high(float(count // 300 % 2 * 9))
    count += 1
    executor.spin_once(timeout_sec=0.002)
"""
MARK = """\
import rclpy, time
from rclpy.node import Node
from rcl_interfaces.srv import SetParameters
from rcl_interfaces.msg import Parameter, ParameterValue, ParameterType
from builtin_interfaces.msg import Time
rclpy.init()
node = Node("observer")
client = node.create_client(SetParameters, "/robot1/guard/set_parameters")
client.wait_for_service()
value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=4.5)
asked = SetParameters.Request(parameters=[Parameter(name="limits.speed", value=value)])
rclpy.spin_until_future_complete(node, client.call_async(asked))
mark = node.create_publisher(Time, "/ana/mark_action", 10)
while not mark.get_subscription_count():
    time.sleep(0.05)
mark.publish(node.get_clock().now().to_msg())
time.sleep(1.0)
"""


@pytest.fixture
def guard(domain: dict[str, str], tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], Path]]:
    """The node, with a ring of 12 s, and the folder of its files."""
    program = Program(tmp_path, domain, GUARD)
    process = program.start(TPC_RING="0.2")
    try:
        wait_for(lambda: len(rings_in(program.reports).segments) > 2)
        yield process, program.reports
    finally:
        process.kill()
        process.communicate()


def test_now(env: dict[str, str], tmp_path: Path, guard: tuple[object, Path]) -> None:
    found = answer(env, tmp_path, "keep", "-o", "kept", "--folder", guard[1])
    assert (found["processes"], found["marks"], found["missing"]) == (1, 0, [])
    recording = read(tmp_path / "kept")
    assert recording.events.nodes == ("/robot1/guard",)
    # Nothing came over the graph, or it would be there twice.
    assert found["reports"] == len(recording.events)
    assert found["summaries"] == len(recording.summaries) > 0
    assert ParameterValues(recording.values).last()[SPEED] == 6.5
    assert "limits.speed: 6.5" in (tmp_path / "kept/params.yaml").read_text()
    assert json.loads((tmp_path / "kept/run.json").read_text())["bag"] == "mission.mcap"


def test_after_a_mark(
    env: dict[str, str],
    domain: dict[str, str],
    tmp_path: Path,
    guard: tuple[subprocess.Popen[str], Path],
) -> None:
    """A value is set, somebody marks, and the node is killed: all of it is in the recording."""
    node, reports = guard
    words = ("keep", "--on-marks", "--after", "2", "-o", "kept", "--folder", reports)
    with contextlib.ExitStack() as stack:
        keeping = stack.enter_context(running(pytpc(*words), env, tmp_path))
        heard = b"limits.speed"
        wait_for(
            lambda: any(
                heard in path.read_bytes()
                for path in tmp_path.glob("kept/.keep-*/mission.mcap.active")
            )
        )
        subprocess.run([PYTHON, "-c", MARK], env=ros2_env(domain), check=True, timeout=PATIENCE_S)
        node.send_signal(signal.SIGKILL)
        wait_for(lambda: list(tmp_path.glob("kept/keep-*")))
        said = interrupted(keeping)
    assert "and 1 mark of 1 process in the last" in said
    (folder,) = tmp_path.glob("kept/*")
    recording = read(folder)
    assert [(mark.type, mark.observer) for mark in recording.marks] == [("I", "ana")]
    changes = ParameterValues(recording.values).changes()
    assert [(one.name, one.old, one.new) for one in changes] == [(SPEED, 6.5, 4.5)]
    (mark,) = recording.marks
    assert recording.start_ns < mark.time_ns
