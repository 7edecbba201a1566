"""`pytpc run` and `pytpc record WORKSPACE ...` on ROS 2, with and without launch."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
from pathlib import Path

import pytest

from patience import PATIENCE_S
from pytpc.build.build import build_workspace
from pytpc.ingest.reading import read
from pytpc.recording.marks import Mark, write_marks
from pytpc.values.origins import read_origins
from ros2_commands import SOME_REPORTS, Running, interrupted, pytpc, read_until, running, told
from ros2_graph import PYTHON
from ros2_workspace import make_ros2_workspace
from terminals import Terminal

# Every 3 s it has the speed 6 for half a second, else 1, until it ends or dies at a step.
NODE = """import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

from limits.rule import is_too_fast


class Guard(Node):
    def __init__(self):
        super().__init__("guard", namespace="/robot1")
        self.limit = self.declare_parameter("speed_limit", 6.5).value
        self.dies_at = self.declare_parameter("dies_at", -1).value
        self.ends_at = self.declare_parameter("ends_at", -1).value
        self.publisher = self.create_publisher(Float64, "stop", 10)
        self.step = 0
        self.create_timer(0.02, self.turn)

    def turn(self):
        self.step += 1
        if self.step == self.dies_at:
            raise RuntimeError("the wheel is off")
        if self.step == self.ends_at:
            raise SystemExit
        if is_too_fast(6.0 if self.step % 150 > 125 else 1.0, self.limit):
            self.publisher.publish(Float64(data=1.0))


def main():
    rclpy.init()
    try:
        rclpy.spin(Guard())
    except KeyboardInterrupt:
        pass
"""
PARAMS = """/robot1/guard:
  ros__parameters:
    speed_limit: 4.5
"""
LAUNCH = """import os
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("dies_at", default_value="-1"),
        Node(package="guard", executable="speed_guard", name="guard", namespace="robot1",
             parameters=[
                 {"speed_limit": 5.5,
                  "dies_at": LaunchConfiguration("dies_at")}]),
    ])
"""
LIMIT = "/robot1/guard/speed_limit"


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    workspace = make_ros2_workspace(tmp_path_factory.mktemp("run") / "ws")
    (workspace / "src/guard/guard/node.py").write_text(NODE)
    (workspace / "src/guard/config/guard.yaml").write_text(PARAMS)
    (workspace / "src/guard/launch/guard.launch.py").write_text(LAUNCH)
    with pytest.MonkeyPatch.context() as patch:
        for name in ("AMENT_PREFIX_PATH", "ROS_VERSION", "ROS_DISTRO", "PYTHONPATH"):
            patch.delenv(name, raising=False)
        patch.setenv("VIRTUAL_ENV", str(PYTHON.parents[1]))
        build_workspace(workspace)
    return workspace


@pytest.fixture
def launch_env(env: dict[str, str]) -> dict[str, str]:
    """The environment with launch, where there is one."""
    folder = os.environ.get("TPC_TEST_LAUNCH")
    more = {} if folder is None else {"PYTHONPATH": folder, "AMENT_PREFIX_PATH": folder}
    found = {**env, **more, "PATH": f"{PYTHON.parent}:{os.defpath}"}
    code = "import launch_ros.actions"
    ran = subprocess.run([PYTHON, "-c", code], env=found, capture_output=True, check=False)
    if ran.returncode:
        pytest.skip("no launch_ros: name a folder that has it by TPC_TEST_LAUNCH")
    return found


def started(env: dict[str, str], folder: Path, *words: object) -> Running:
    return running(pytpc(*words), env, folder)


def left_in(folder: Path) -> list[str]:
    """The processes of nodes that still run with a log in this folder."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if f"ROS_LOG_DIR={folder}/".encode() in (entry / "environ").read_bytes():
                found.append((entry / "cmdline").read_text())
    return found


def test_an_executable_with_a_params_file_is_recorded_and_its_value_changed(
    workspace: Path, env: dict[str, str], tmp_path: Path
) -> None:
    params = workspace / "src/guard/config/guard.yaml"
    words = ["--", "--ros-args", "--params-file", params]
    with started(
        env, tmp_path, "record", workspace, "guard", "speed_guard", "-o", "mission", *words
    ) as process:
        said = read_until(process, "what the nodes print")
        assert f"recording ROS 2 domain {env['ROS_DOMAIN_ID']}" in "".join(said)
        read_until(process, SOME_REPORTS)
        out = interrupted(process)
    assert "(interrupted)" in out
    mission = tmp_path / "mission"
    recording = read(mission)
    assert 4.5 in recording.events.thresh.tolist()
    assert 6.5 not in recording.events.thresh.tolist()
    assert recording.events.nodes == ("/robot1/guard",)
    assert left_in(tmp_path) == []
    origins = read_origins(mission)
    limit = origins[LIMIT]
    assert (limit.kind, limit.path, limit.lineno, limit.value) == ("yaml", params, 3, 4.5)
    assert origins["/robot1/guard/dies_at"].kind == "default"
    assert f"{params}:3" in told(env, tmp_path, "origin", "mission", "speed_limit")
    said = told(env, tmp_path, "apply", "mission", "speed_limit", "5.0", "--dry-run")
    assert "+    speed_limit: 5.0" in said
    assert (mission / "ros/out/speed_guard.log").is_file()


def test_nodes_started_by_hand_tell_their_params_file_and_rules(
    workspace: Path, env: dict[str, str], tmp_path: Path
) -> None:
    (tmp_path / "limits.yaml").write_text("/**:\n  ros__parameters:\n    speed_limit: 3.5\n")
    script = workspace / ".tpc/install/guard/lib/guard/speed_guard"
    words = ["--ros-args", "--params-file", "limits.yaml", "-p", "dies_at:=1000000"]
    with started(env, tmp_path, "record", "--static", workspace, "-o", "mission") as process:
        read_until(process, "press Ctrl-C to stop")
        # The name of the node is in its code alone.
        with started(env, tmp_path, "run", script, *words) as node:
            read_until(process, SOME_REPORTS)
            interrupted(process)
            node.send_signal(signal.SIGINT)
            node.wait(PATIENCE_S)
    origins = read_origins(tmp_path / "mission")
    limit = origins[LIMIT]
    assert (limit.kind, limit.path, limit.lineno) == ("yaml", tmp_path / "limits.yaml", 3)
    assert "/** sets it" in limit.note
    dies = origins["/robot1/guard/dies_at"]
    assert (dies.kind, dies.note) == ("launch", "in the args of the node: dies_at:=1000000")
    assert origins["/robot1/guard/use_sim_time"].kind == "default"
    # It is in no workspace, so that the user confirms it.
    said = told(env, tmp_path, "apply", "mission", LIMIT, "5.0", status=1)
    assert f"add --file {tmp_path / 'limits.yaml'}" in said
    told(env, tmp_path, "apply", "mission", LIMIT, "5.0", "--file", "limits.yaml")
    assert "speed_limit: 5.0\n" in (tmp_path / "limits.yaml").read_text()


def marked(mission: Path) -> None:
    """Mark the moment behind each change to a speed that is too high, as a file beside it."""
    events = read(mission).events
    fast = (events.thresh == 4.5) & events.result
    times = [int(one) for one in events.time_ns[fast]]
    begins = [now for before, now in zip([0, *times], times, strict=False) if now - before > 10**9]
    assert begins
    marks = [Mark(time_ns + 200_000_000, "I", "ana") for time_ns in begins]
    write_marks(marks, mission / "marks.csv")


def test_the_verdict_beside_a_good_run_names_the_line_and_the_command(
    workspace: Path, env: dict[str, str], tmp_path: Path
) -> None:
    params = workspace / "src/guard/config/guard.yaml"
    until, env = ["-p", "ends_at:=500"], {**env, "TPC_POLICY": "every"}
    for mission, more in (("good", []), ("bad", ["--params-file", params])):
        words = ["guard", "speed_guard", "-o", mission, "--", "--ros-args", *more, *until]
        assert "(ended)" in told(env, tmp_path, "record", workspace, *words)
    marked(tmp_path / "bad")
    assert f"blame {LIMIT}" in told(env, tmp_path, "rank", "bad", "--reference", "good")
    differing = told(env, tmp_path, "diff", "good", "bad", "--json")
    assert f"{params}:3" in differing
    told(env, tmp_path, "report", "bad", "--reference", "good", "-o", "page.html")
    page = (tmp_path / "page.html").read_text()
    assert f"{params.name}:3" in page
    assert f"pytpc apply {tmp_path}/bad {LIMIT} 6.5" in page


def test_a_marked_run_ends_with_the_verdict_and_the_page(
    workspace: Path, env: dict[str, str], tmp_path: Path
) -> None:
    params = workspace / "src/guard/config/guard.yaml"
    words = ["guard", "speed_guard", "-o", "mission", "--", "--ros-args", "--params-file", params]
    with Terminal(pytpc("run", workspace, *words), tmp_path, env=env, columns=160) as terminal:
        terminal.wait_for("the mission runs in ROS 2 domain", PATIENCE_S)
        terminal.wait_for("speed_limit", PATIENCE_S)
        terminal.press("1")
        terminal.wait_for("type I", PATIENCE_S)
        terminal.press("q")
        assert terminal.wait(PATIENCE_S) == 0
        said = terminal.text
    assert "speed_limit" in said
    assert (tmp_path / "mission/report.html").is_file()
    assert "speed_limit: 4.5" in told(env, tmp_path, "origin", "mission", "speed_limit")


def test_a_node_that_dies_is_told_and_ends_the_mission(
    workspace: Path, env: dict[str, str], tmp_path: Path
) -> None:
    words = ["guard", "speed_guard", "-o", "mission", "--", "--ros-args", "-p", "dies_at:=100"]
    out = told(env, tmp_path, "record", workspace, *words)
    assert "warning: the node speed_guard died (exit status 1)" in out
    assert "RuntimeError: the wheel is off" in out
    assert "(ended)" in out
    assert 4.5 not in read(tmp_path / "mission").events.thresh.tolist()
    assert json.loads((tmp_path / "mission/run.json").read_text())["ended"] == "ended"


# When it declares the parameter, by a rule or a file, or before: nothing is compared yet.
@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("-p dies_at:=soon", "InvalidParameterTypeException"),
        ("--params-file wrong.yaml", "InvalidParameterTypeException"),
        ("--params-file none.yaml", "none.yaml"),
    ],
)
def test_a_node_that_dies_at_once_is_told_with_its_status(
    workspace: Path, env: dict[str, str], tmp_path: Path, value: str, said: str
) -> None:
    (tmp_path / "wrong.yaml").write_text("/robot1/guard: {ros__parameters: {speed_limit: fast}}")
    words = ["guard", "speed_guard", "-o", "mission", "--", "--ros-args", *value.split()]
    out = told(env, tmp_path, "run", "--ros", "2", "--no-keys", workspace, *words, status=1)
    died, error = [line for line in out.splitlines() if " died (" in line]
    assert died.startswith("pytpc: warning: the node speed_guard died (exit status 1)")
    assert error == (
        "pytpc: error: mission: no reports arrived, so there is nothing to diagnose: the node"
        " speed_guard died (exit status 1)"
    )
    assert said in out


def test_the_ros_of_a_run_can_be_named(
    workspace: Path, env: dict[str, str], tmp_path: Path
) -> None:
    words = ["run", "--ros", "1", "--no-keys", workspace, "guard", "guard.launch.py"]
    assert "roslaunch" in told(env, tmp_path, *words, status=1)


@pytest.mark.parametrize("later", ["looking", "recording"])
def test_ctrl_c_at_any_moment_leaves_a_whole_recording(
    workspace: Path, env: dict[str, str], tmp_path: Path, later: str
) -> None:
    with started(env, tmp_path, "record", workspace, "guard", "speed_guard") as process:
        read_until(process, "press Ctrl-C to stop") if later == "recording" else None
        if later == "looking":
            # The folder is there as soon as the mission begins, before its graph.
            while not any((tmp_path / "out").glob("*/.recording.lock")):
                assert process.poll() is None
        interrupted(process)
    (mission,) = (tmp_path / "out").iterdir()
    assert read(mission / "mission.mcap").events is not None
    assert json.loads((mission / "run.json").read_text())["ended"] == "interrupted"
    assert left_in(tmp_path) == []


def test_wrong_words_are_one_line_with_what_to_type(
    workspace: Path, env: dict[str, str], tmp_path: Path
) -> None:
    for words, error in (
        (
            ["guard", "speed_guards"],
            "no launch file or executable speed_guards; did you mean speed_g",
        ),
        (["sentry", "speed_guard"], "no package sentry in the workspace"),
        (["guard", "speed_guard", "x:=1"], "give a parameter with -- --ros-args -p"),
        (["guard", "guard.launch.py", "--", "-p"], "a launch file is run by itself"),
        (["guard", "speed_guard", "no/driver"], "no package no in the workspace"),
    ):
        said = told(env, tmp_path, "record", workspace, "-o", "none", *words, status=1)
        assert error in said
        assert "Traceback" not in said
        assert not (tmp_path / "none/mission.mcap").exists()


def test_a_launch_file_runs_and_tells_the_line_of_each_value(
    workspace: Path, launch_env: dict[str, str], tmp_path: Path
) -> None:
    words = ["guard", "guard.launch.py", "dies_at:=300", "-o", "mission"]
    out = told(launch_env, tmp_path, "record", workspace, *words)
    assert "warning: the node speed_guard-1 died (exit status 1)" in out
    assert "RuntimeError: the wheel is off" in out
    assert "(ended)" in out
    mission = tmp_path / "mission"
    recording = read(mission)
    assert recording.events.nodes == ("/robot1/guard",)
    assert {5.5, 300.0} <= set(recording.events.thresh.tolist())
    origins = read_origins(mission)
    limit, dies = origins[LIMIT], origins["/robot1/guard/dies_at"]
    source = workspace / "src/guard/launch/guard.launch.py"
    assert (limit.kind, limit.source, limit.lineno) == ("launch", source, 13)
    assert (dies.kind, dies.argument, dies.value) == ("argument", "dies_at", 300)
    said = told(launch_env, tmp_path, "apply", "mission", "speed_limit", "5.0", "--dry-run")
    assert '+                 {"speed_limit": 5.0,' in said
    assert left_in(tmp_path) == []


def test_a_launch_file_ends_at_ctrl_c_with_its_nodes(
    workspace: Path, launch_env: dict[str, str], tmp_path: Path
) -> None:
    launch = workspace / "src/guard/launch/guard.launch.py"
    with started(launch_env, tmp_path, "record", workspace, launch, "-o", "mission") as process:
        read_until(process, SOME_REPORTS)
        out = interrupted(process)
    assert "(interrupted)" in out
    assert "died" not in out
    assert left_in(tmp_path) == []


def test_a_launch_file_that_cannot_be_run_says_why(
    workspace: Path, launch_env: dict[str, str], tmp_path: Path
) -> None:
    (tmp_path / "bad.launch.py").write_text("raise RuntimeError('no way')\n")
    said = told(launch_env, tmp_path, "record", workspace, "bad.launch.py", status=1)
    assert "no way" in said
    assert "Traceback" not in said


def test_the_launch_file_of_a_running_robot_is_read(
    workspace: Path, launch_env: dict[str, str], tmp_path: Path
) -> None:
    source = workspace / "src/guard/launch/guard.launch.py"
    script = workspace / ".tpc/install/guard/lib/guard/speed_guard"
    words = ["--launch", source, "--static", workspace, "-o", "mission"]
    with started(launch_env, tmp_path, "record", *words) as process:
        read_until(process, "press Ctrl-C to stop")
        # As launch would start it.
        rules = ["-r", "__node:=guard", "-r", "__ns:=/robot1", "-p", "speed_limit:=5.5"]
        with started(launch_env, tmp_path, "run", script, "--ros-args", *rules) as node:
            read_until(process, SOME_REPORTS)
            interrupted(process)
            node.send_signal(signal.SIGINT)
            node.wait(PATIENCE_S)
    limit = read_origins(tmp_path / "mission")[LIMIT]
    assert (limit.kind, limit.path, limit.lineno) == ("launch", source, 13)
