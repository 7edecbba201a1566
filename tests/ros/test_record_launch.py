"""`pytpc record WS LAUNCH` on a real graph: Ctrl-C at any time, other terminals and workspaces."""

from __future__ import annotations

import json
import os
import shutil
import signal
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from recorded_robot import make_package, make_workspace, processes_of, shell, wait_until

from patience import PATIENCE_S, wait_for
from pytpc.base.errors import RunError
from pytpc.base.folder_lock import alone_in
from pytpc.build.build import workspace_env
from pytpc.ingest.reading import read
from pytpc.recording.marks import read_marks
from pytpc.ros.mission_run import Progress, RecordOptions, read_status
from pytpc.ros.ros1.record_mission import run_mission
from terminals import Terminal

if shutil.which("roslaunch") is None:
    pytest.skip("ROS is not installed", allow_module_level=True)


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    return make_workspace(tmp_path / "ws")


def record(folder: Path, *words: str, **env: str) -> Terminal:
    return shell(
        "record", "ws", "robot_base", "robot.launch", "-o", "out", *words, folder=folder, **env
    )


def has_reports(folder: Path) -> bool:
    status = read_status(folder / "out/ros/recorder.json")
    return status is not None and status.reports > 0


def complete(folder: Path) -> dict[str, object]:
    """The run of a recording that has all of its parts, and has left no process."""
    out = folder / "out"
    for name in ("mission.bag", "params.yaml", "origins.json"):
        assert (out / name).is_file(), name
    assert not (out / "mission.bag.active").exists()
    read(out / "mission.bag")
    assert processes_of(out) == []
    assert list((folder / "runtime/pytpc").iterdir()) == []
    run: dict[str, object] = json.loads((out / "run.json").read_text())
    return run


def is_there(name: str) -> Callable[[Path], bool]:
    return lambda folder: (folder / "out" / name).exists()


# At first there is no graph, then no roslaunch, then no parameters, then a mission.
MOMENTS = {
    "the graph starts": is_there("ros/out/rosmaster.log"),
    "roslaunch starts": is_there("ros/out/roslaunch.log"),
    "nodes start": is_there("params_start.yaml"),
    "nodes report": has_reports,
}


@pytest.mark.parametrize("moment", MOMENTS)
def test_ctrl_c_at_any_time_leaves_a_complete_recording(robot: Path, tmp_path: Path, moment: str):
    with record(tmp_path) as terminal:
        wait_until(lambda: MOMENTS[moment](tmp_path), terminal)
        terminal.press("\x03")
        assert terminal.wait(60) == 0, terminal.text
        assert "pytpc: stopping; press Ctrl-C again" in terminal.text
        assert "(interrupted): out/mission.bag" in terminal.text
        said = terminal.text
    run = complete(tmp_path)
    assert run["ended"] == "interrupted"
    origins = json.loads((tmp_path / "out/origins.json").read_text())
    if moment in ("nodes start", "nodes report"):
        assert origins["parameters"]["/robot/limit"]["value"] == 0.5
    if moment == "the graph starts":
        assert "interrupted before roslaunch" in origins["reason"]
    if moment == "nodes report":
        assert run["reports"]
        assert "next: pytpc mark out, to mark what went wrong, and then: pytpc rank out" in said


@pytest.mark.parametrize("moment", ["nodes report", "the mission has ended"])
def test_ctrl_c_twice_and_while_it_ends(robot: Path, tmp_path: Path, moment: str):
    with record(tmp_path, *(["seconds:=1.0"] if "ended" in moment else [])) as terminal:
        if moment == "nodes report":
            wait_until(lambda: has_reports(tmp_path), terminal)
            terminal.press("\x03")
        wait_until(lambda: is_there("params.yaml")(tmp_path), terminal)
        terminal.press("\x03")
        time.sleep(0.05)
        terminal.press("\x03")
        assert terminal.wait(60) == 0
    assert complete(tmp_path)["ended"] == ("interrupted" if moment == "nodes report" else "ended")


@pytest.mark.parametrize("how", ["SIGTERM", "the terminal is closed"])
def test_other_ends(robot: Path, tmp_path: Path, how: str):
    with record(tmp_path) as terminal:
        wait_until(lambda: has_reports(tmp_path), terminal)
        if how == "SIGTERM":
            assert terminal.end(signal.SIGTERM) == 0
        else:
            os.close(terminal.child)
            os.close(terminal.master)
            assert terminal.process.wait(PATIENCE_S) == 0
    assert complete(tmp_path)["ended"] == "interrupted"


def test_a_folder_that_another_recording_writes_to_is_refused(robot: Path, tmp_path: Path):
    with record(tmp_path) as first:
        wait_until(lambda: has_reports(tmp_path), first)
        with record(tmp_path) as second:
            assert second.wait(60) == 1
            said = " ".join(second.text.split())
        assert "out: another recording is being written in this folder; wait until it" in said
        first.press("\x03")
        assert first.wait(60) == 0, first.text
    assert complete(tmp_path)["ended"] == "interrupted"


def is_free(folder: Path) -> bool:
    """Whether another recording can begin there."""
    try:
        with alone_in(folder):
            return True
    except RunError:
        return False


# Nothing can be done at kill -9, so the recorder does it: it closes the bag and ends the graph.
def test_a_killed_recording_leaves_a_whole_bag_and_no_process(robot: Path, tmp_path: Path):
    out = tmp_path / "out"
    with record(tmp_path) as terminal:
        wait_until(lambda: has_reports(tmp_path), terminal)
        assert len(processes_of(out)) >= 4
        terminal.process.kill()
        terminal.process.wait(20)
        wait_for(lambda: not processes_of(out))
    # Another one can begin there.
    wait_for(lambda: is_free(out))
    assert not (out / "mission.bag.active").exists()
    assert len(read(out / "mission.bag").events) > 0


# The marks reach the bag, and are in the file beside it, which is read with it.
def test_other_terminals_find_the_recording(robot: Path, tmp_path: Path):
    nowhere = "http://localhost:9"
    with record(tmp_path) as recording:
        wait_until(lambda: has_reports(tmp_path), recording)
        with shell("mark", "--observer", "ana", folder=tmp_path, ROS_MASTER_URI=nowhere) as mark:
            mark.wait_for(f"nothing answers at ROS_MASTER_URI ({nowhere}); using the recording")
            mark.wait_for("1 node listening; wall time")
            mark.press("12")
            mark.wait_for("marked: type II")
            mark.press("q")
            assert mark.wait() == 0
            assert "2 marks: out/marks.csv" in mark.text
        with shell("watch", "--once", "--seconds", "3", folder=tmp_path) as watch:
            assert watch.wait(60) == 0
            assert "using the recording that runs" in watch.text
            assert "~limit" in watch.text
        with shell("sink", "--policy", "edges", folder=tmp_path) as sink:
            assert sink.wait(60) == 0
            assert "edges" in sink.text
        recording.press("\x03")
        assert recording.wait(60) == 0
        assert "and 2 marks in" in recording.text
    marks = read(tmp_path / "out/mission.bag").marks
    assert [(one.type, one.observer) for one in marks] == [("I", "ana"), ("II", "ana")]
    assert read_marks(tmp_path / "out/marks.csv") == marks


OVER = """<launch>
  <arg name="top"/>
  <include file="$(find robot_base)/launch/robot.launch">
    <arg name="limit" value="$(arg top)"/>
    <arg name="seconds" value="1.0"/>
  </include>
  <param name="/robot/kind" value="$(env ROBOT_KIND)"/>
</launch>
"""


# The launch file and the node's package are in different workspaces, of which one was sourced.
def test_a_launch_file_of_another_workspace_and_its_variables(robot: Path, tmp_path: Path):
    over = tmp_path / "over"
    make_package(over, "robot_over", {"launch/over.launch": OVER})
    env = {"ROS_PACKAGE_PATH": f"{over}:/usr/share", "ROBOT_KIND": "boat"}
    words = ("record", "top:=0.25", "ws", "robot_over", "over.launch", "-o", "out")
    with shell(*words, folder=tmp_path, **env) as terminal:
        assert terminal.wait(90) == 0
        assert "(ended): out/mission.bag" in terminal.text
    assert complete(tmp_path)["args"] == {"top": "0.25"}
    values = json.loads((tmp_path / "out/origins.json").read_text())["parameters"]
    assert values["/robot/limit"]["value"] == 0.25
    assert values["/robot/kind"]["value"] == "boat"


CLOCK = """#!/usr/bin/env python3
import sys
import time

import rospy
from rosgraph_msgs.msg import Clock

rospy.init_node("clock", disable_rostime=True)
clock = rospy.Publisher("/clock", Clock, queue_size=1)
time.sleep(1.0)
for tick in range(100, 160):
    clock.publish(Clock(rospy.Time(tick / 10.0)))
    time.sleep(0.02)
time.sleep(1.0)
"""
SIMULATED = """<launch>
  <param name="/use_sim_time" value="true"/>
  <node pkg="robot_base" type="{clock}" name="clock" required="true"/>
  <node pkg="robot_base" type="robot.py" name="robot"/>
</launch>
"""


# Its clock goes from 10 s to 15.9 s.
def test_the_launch_file_says_what_the_clock_is(robot: Path, tmp_path: Path):
    files = {"scripts/clock.py": CLOCK, "launch/sim.launch": SIMULATED.format(clock="clock.py")}
    make_package(robot / "src", "robot_base", files)
    words = ("record", "ws", "ws/src/robot_base/launch/sim.launch", "-o", "out")
    with shell(*words, folder=tmp_path) as terminal:
        assert terminal.wait(90) == 0
    assert 5.0 < float(str(complete(tmp_path)["sim_s"])) < 5.91
    assert read(tmp_path / "out/mission.bag").end_ns < 16 * 10**9


# As the study and the demo call it: SIGTERM ends them, and what failed is flown again.
def test_a_mission_that_nobody_stops(robot: Path, tmp_path: Path):
    files = {"scripts/clock.py": CLOCK, "launch/sim.launch": SIMULATED.format(clock="clock.py")}
    make_package(robot / "src", "robot_base", files)
    env = {**workspace_env(robot / ".tpc/install"), "HOME": str(tmp_path)}
    launch = robot / "src/robot_base/launch/sim.launch"
    options = RecordOptions(tmp_path / "out", launch, {}, 90.0)
    run = run_mission(env, options)
    assert (run.ended, run.reports) == ("ended", 0)
    assert 5.0 < run.sim_s < 5.91

    def kill(progress: Progress) -> None:
        for pid in processes_of(tmp_path / "out") if progress.sim_s > 1.0 else ():
            if b"clock.py" in Path(f"/proc/{pid}/cmdline").read_bytes():
                os.kill(pid, signal.SIGKILL)

    with pytest.raises(RunError, match="has died"):
        run_mission(env, replace(options, on_progress=kill))
    assert not (tmp_path / "out/run.json").exists()
    # What was recorded until then is a whole bag.
    read(tmp_path / "out/mission.bag")


def test_ctrl_c_before_the_clock(robot: Path, tmp_path: Path):
    files = {"launch/sim.launch": SIMULATED.format(clock="robot.py")}
    make_package(robot / "src", "robot_base", files)
    words = ("record", "ws", "robot_base", "sim.launch", "-o", "out")
    with shell(*words, folder=tmp_path) as terminal:
        wait_until(lambda: is_there("params_start.yaml")(tmp_path), terminal)
        terminal.press("\x03")
        assert terminal.wait(60) == 0
    assert complete(tmp_path)["sim_s"] == 0.0


# Ten reports a second, at least, in the file of the node.
def test_reports_in_files_are_counted(robot: Path, tmp_path: Path):
    with record(tmp_path, "seconds:=2.0", TPC_SINK="file", TPC_POLICY="every") as terminal:
        assert terminal.wait(90) == 0
        said = terminal.text
    run = complete(tmp_path)
    assert run["files"] == 1
    counted = run["reports_in_files"]
    assert isinstance(counted, int)
    assert counted == len(read(tmp_path / "out").events) > 20
    assert f"{counted} reports and 0 marks in" in said
    assert "next: pytpc mark out" in said


def test_a_mission_that_fails_is_recorded(robot: Path, tmp_path: Path):
    with record(tmp_path) as terminal:
        wait_until(lambda: has_reports(tmp_path), terminal)
        for pid in processes_of(tmp_path / "out"):
            if b"robot.py" in Path(f"/proc/{pid}/cmdline").read_bytes():
                os.kill(pid, signal.SIGKILL)
        assert terminal.wait(60) == 1
        assert "has died" in terminal.text
        assert "what was recorded until then is in out" in terminal.text
    assert complete(tmp_path)["ended"] == "failed"


CAMERA = """#!/usr/bin/env python3
import rospy
rospy.init_node("camera")
raise RuntimeError("the lens is covered")
"""
DIES = """<launch>
  <node pkg="robot_base" type="camera.py" name="camera" required="{required}"/>
  <node pkg="robot_base" type="robot.py" name="robot"><param name="limit" value="0.5"/></node>
</launch>
"""


@pytest.mark.parametrize("required", ["true", "false"])
def test_a_node_that_dies_is_told_with_its_last_lines(
    robot: Path, tmp_path: Path, required: str
) -> None:
    launch = DIES.format(required=required)
    files = {"scripts/camera.py": CAMERA, "launch/dies.launch": launch}
    make_package(robot / "src", "robot_base", files)
    words = ("record", "ws", "robot_base", "dies.launch", "-o", "out")
    with shell(*words, folder=tmp_path) as terminal:
        if required == "false":
            wait_until(lambda: "lens is covered" in terminal.text, terminal)
            terminal.press("\x03")
        assert terminal.wait(60) == (1 if required == "true" else 0)
        said = terminal.text
    assert "what the nodes print is in out/ros/out/roslaunch.log" in said
    assert "warning: the node camera-1 died (exit status 1)" in said
    assert "    RuntimeError: the lens is covered" in said
