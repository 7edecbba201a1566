"""`pytpc record`, `mark`, `watch`, `sink` and `apply --live` on a real ROS 2 graph."""

from __future__ import annotations

import contextlib
import json
import subprocess
import time
from pathlib import Path

from patience import PATIENCE_S
from pytpc.ingest.reading import read
from pytpc.recording.graph_file import read_graph, read_recorded_graph
from pytpc.recording.parameter_values import ParameterValues
from pytpc.static.static_info import StaticInfo
from ros2_commands import (
    SOME_REPORTS,
    answer,
    interrupted,
    pytpc,
    read_until,
    recorder,
    running,
    told,
)
from ros2_graph import PYTHON
from terminals import Terminal

NODE = Path(__file__).with_name("guard_node.py")
SPEED = "/robot1/guard/limits.speed"
# What `guard_node.py` reports is what this would.
COMPARING = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

rclpy.init()
node = Node("guard", namespace="/robot1")
limit = node.declare_parameter("limits.speed", 6.5).value
publisher = node.create_publisher(Float64, "stop", 10)
for step in range(10):
    if step > limit:
        publisher.publish(Float64(data=1.0))
"""


@contextlib.contextmanager
def guard(env: dict[str, str], folder: Path, rate: int, seconds: float, *key: str):
    command = [str(PYTHON), str(NODE), str(rate), str(seconds), *key]
    with running(command, env, folder) as node:
        assert node.stdout.readline() == "ready\n", node.stderr.read()
        yield node


def analysed(env: dict[str, str], folder: Path) -> str:
    """Analyse a node that compares the parameter; the key of its comparison."""
    (folder / "guard.py").write_text(COMPARING)
    told(env, folder, "analyse", "guard.py", "-o", "static.json")
    (key,) = StaticInfo.load(folder / "static.json").thresholds
    return str(key)


def test_no_report_is_lost_at_5000_a_second(env: dict[str, str], tmp_path: Path) -> None:
    with recorder(env, tmp_path) as process, guard(env, tmp_path, 5000, 4.0) as node:
        sent = int(node.stdout.readline())
        out = interrupted(process)
    # 100 reports each 20 ms, for 4 s.
    assert sent == 20_000
    assert "20,000 reports and 0 marks" in out
    recording = read(tmp_path / "mission")
    assert len(recording.events) == 20_000
    assert recording.lost == {}
    assert recording.events.nodes == ("/robot1/guard",)
    run = json.loads((tmp_path / "mission/run.json").read_text())
    assert (run["bag"], run["ended"]) == ("mission.mcap", "interrupted")
    assert sum(run["lost"].values()) == 0
    assert "/robot1/guard" in (tmp_path / "mission/params.yaml").read_text()


def test_the_value_at_a_time_is_that_of_before_or_after_it_was_set(
    env: dict[str, str], tmp_path: Path
) -> None:
    with recorder(env, tmp_path) as process, guard(env, tmp_path, 50, 600.0):
        said = told(env, tmp_path, "apply", "--live", "limits.speed", "4.0")
        assert f"{SPEED} 6.5 -> 4.0" in said
        refused = told(env, tmp_path, "apply", "--live", SPEED, "40.0", status=1)
        assert "/robot1/guard refuses limits.speed=40.0: at most 10" in refused
        wrong = told(env, tmp_path, "apply", "--live", SPEED[:-1], "4.0", status=1)
        assert f"did you mean {SPEED}" in wrong
        said = told(env, tmp_path, "sink")
        assert "/robot1/guard" in said
        assert "topic" in said
        found = answer(env, tmp_path, "sink", "--policy", "edges")
        assert [(one["node"], one["values"]["policy"]) for one in found] == [
            ("/robot1/guard", "edges")
        ]
        refused = told(env, tmp_path, "sink", "/robot1/guard", "--sink", "file", status=1)
        assert "/robot1/guard: no folder" in refused
        interrupted(process)
    recording = read(tmp_path / "mission")
    values = ParameterValues(recording.values)
    changes = [one for one in values.changes() if one.name == SPEED]
    assert [(one.old, one.new) for one in changes] == [(6.5, 4.0)]
    at = changes[0].time_ns
    assert (values.at(SPEED, at - 1), values.at(SPEED, at)) == (6.5, 4.0)
    # The node reports with the value of the moment, and on the same clock.
    before = recording.events.time_ns < at
    assert set(recording.events.thresh[before].tolist()) == {6.5}
    assert 4.0 in recording.events.thresh[~before].tolist()
    assert any(f"{SPEED} was set from 6.5 to 4.0" in one for one in recording.notes)
    start = (tmp_path / "mission/params_start.yaml").read_text()
    assert ("limits.speed: 6.5" in start, "limits.speed: 4.0" in start) == (True, False)
    assert "limits.speed: 4.0" in (tmp_path / "mission/params.yaml").read_text()
    topic = read_graph(tmp_path / "mission")["/threshold_information"]
    assert (topic.type, topic.publishers) == ("std_msgs/msg/String", {"/robot1/guard"})


def test_marks_of_two_observers_are_ranked_by(env: dict[str, str], tmp_path: Path) -> None:
    key = analysed(env, tmp_path)
    with contextlib.ExitStack() as stack:
        process = stack.enter_context(recorder(env, tmp_path, "--static", "static.json"))
        stack.enter_context(guard(env, tmp_path, 50, 600.0, key))
        read_until(process, SOME_REPORTS)
        found = answer(env, tmp_path, "watch", "--once", "--seconds", "2")
        assert "limits.speed" in json.dumps(found)
        for observer, press in (("ana", "1"), ("ben", "2")):
            command = pytpc("mark", "--observer", observer)
            with Terminal(command, tmp_path, env=env, columns=160) as terminal:
                terminal.wait_for("1 node listening", PATIENCE_S)
                terminal.press(press)
                terminal.wait_for("type", PATIENCE_S)
                terminal.press("w")
                terminal.wait_for("/robot1/guard (node)", PATIENCE_S)
                terminal.press("guard\r")
                terminal.wait_for("wrong at /robot1/guard", PATIENCE_S)
                terminal.press("q")
                assert terminal.wait(PATIENCE_S) == 0
        interrupted(process)
    found = read(tmp_path / "mission/mission.mcap")
    assert [(one.observer, one.type) for one in found.marks] == [("ana", "I"), ("ben", "II")]
    assert [one.where for one in found.marks] == [("/robot1/guard",)] * 2
    services = read_recorded_graph(tmp_path / "mission").services
    assert services["/robot1/guard/get_parameters"] == {"/robot1/guard"}
    assert all(found.start_ns <= one.time_ns <= found.end_ns for one in found.marks)
    assert "limits.speed" in told(env, tmp_path, "rank", "mission")


def test_relay_says_what_takes_its_place(env: dict[str, str], tmp_path: Path) -> None:
    said = told(env, tmp_path, "relay", status=1)
    assert said.endswith("do so after: pytpc sink --sink topic\n")
    assert len(said.splitlines()) == 1


def test_a_killed_agent_loses_nothing_of_what_was_recorded(
    env: dict[str, str], tmp_path: Path
) -> None:
    with recorder(env, tmp_path) as process, guard(env, tmp_path, 500, 1.0) as node:
        sent = int(node.stdout.readline())
        # The recorder has no other child.
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        time.sleep(1.0)
        subprocess.run(["kill", "-9", *children], check=True)
        _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 1
    assert "the node of ROS 2 that pytpc runs has ended" in err
    assert len(read(tmp_path / "mission").events) == sent
