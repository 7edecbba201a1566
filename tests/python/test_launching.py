"""What a launch file is run with, and what is said before anything starts."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from pytpc.api.record import sink_settings
from pytpc.base.errors import MissingToolError, RunError
from pytpc.cli.mission_commands import record_command
from pytpc.ros.mission_run import (
    RecordOptions,
)
from pytpc.ros.ros1.record_mission import launch_command, run_mission


def test_launch_command_has_its_arguments_in_order(tmp_path):
    launch = tmp_path / "a.launch"
    launch.write_text("<launch/>")
    command = launch_command(launch, {"seed": "3", "rate": "4.0"})
    assert command[0] == "roslaunch"
    assert command[-3:] == [str(launch), "rate:=4.0", "seed:=3"]


def test_missing_launch_file_is_said_before_anything_starts(tmp_path):
    with pytest.raises(RunError, match=r"no\.launch: no such launch file"):
        run_mission({}, RecordOptions(tmp_path / "out", tmp_path / "no.launch", {}, 5.0))
    assert not (tmp_path / "out").exists()


def test_missing_roslaunch_is_said_before_anything_starts(tmp_path):
    launch = tmp_path / "x.launch"
    launch.write_text("<launch/>")
    options = RecordOptions(tmp_path / "out", launch)
    with pytest.raises(
        MissingToolError, match=r"roslaunch, rosmaster, rosparam of ROS 1 not found"
    ):
        run_mission({"PATH": str(tmp_path)}, options)
    assert not (tmp_path / "out").exists()


def test_record_command_wants_name_and_value():
    result = CliRunner().invoke(record_command, ["ws", "a.launch", "seed=1", "-o", "out"])
    assert result.exit_code == 2
    assert "'seed=1' is not NAME:=VALUE" in result.output


def test_settings_of_sinks_reach_the_nodes_and_nothing_else(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    given = {"TPC_SINK": "file", "TPC_POLICY": "", "TPC_FOLDER": "x", "TPC_PREFIX": "/y", "A": "b"}
    assert sink_settings(given) == {"TPC_SINK": "file", "TPC_FOLDER": str(tmp_path / "x")}
