"""What is wrong with the ROS 2 of a shell is one line, and the exit status is 1."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2_commands import told

RECORD = ("record", "-o", "none")
APPLY = ("apply", "--live", "/a/b", "1")
RMW = "RMW_IMPLEMENTATION"
PYTHON = "TPC_ROS2_PYTHON"
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
BAD = [
    (RECORD, {RMW: "rmw_none"}, "RMW_IMPLEMENTATION=rmw_none is not installed; unset it"),
    (("mark",), {RMW: "rmw_none"}, "RMW_IMPLEMENTATION=rmw_none is not installed; unset it"),
    (RECORD, {PYTHON: "/usr/bin/false"}, "no node can be made"),
    (RECORD, {PYTHON: "/no/python"}, "TPC_ROS2_PYTHON names no program"),
    (("sink",), {PYTHON: "/usr/bin/python3"}, "No module named 'rclpy'); source ROS 2"),
    (RECORD, {"TPC_ROS": "3"}, "TPC_ROS=3: give 1 or 2"),
    (RECORD, {"ROS_DOMAIN_ID": "-1"}, "ROS_DOMAIN_ID=-1: give a number from 0 to 232"),
    (RECORD, {"ROS_DOMAIN_ID": "233"}, "ROS_DOMAIN_ID=233: give a number from 0 to 232"),
    (("sink",), {"ROS_DOMAIN_ID": "left"}, "ROS_DOMAIN_ID=left: give a number from 0 to 232"),
    (("sink",), {}, "no node in domain {ROS_DOMAIN_ID}; ROS_DOMAIN_ID="),
    (APPLY, {}, "no node in domain {ROS_DOMAIN_ID}; ROS_DOMAIN_ID="),
    # Linux may give the ports of such domains to others, and does rarely.
    (APPLY, {"ROS_DOMAIN_ID": "232"}, "no node in domain 232; ROS_DOMAIN_ID=232"),
    (APPLY, {RANGE: "OFF"}, f"with {RANGE}=OFF no node is found; unset it"),
]


@pytest.mark.parametrize(("words", "variables", "expected"), BAD)
def test_one_line_says_what_is_wrong(
    env: dict[str, str], tmp_path: Path, words, variables, expected
) -> None:
    said = told({**env, **variables}, tmp_path, *words, status=1)
    (error,) = [line for line in said.splitlines() if line.startswith("pytpc: error")]
    assert expected.format(**env) in error
    assert "Traceback" not in said


def test_a_recording_with_a_wrong_domain_begins_not(env: dict[str, str], tmp_path: Path) -> None:
    said = told({**env, "ROS_DOMAIN_ID": "left"}, tmp_path, *RECORD, status=1)
    assert "recording" not in said
    assert not (tmp_path / "none").exists()


def test_doctor_says_it_once(env: dict[str, str], tmp_path: Path) -> None:
    wrong = {**env, PYTHON: "/usr/bin/python3", "COLUMNS": "500"}
    said = told(wrong, tmp_path, "doctor")
    assert said.count("source ROS 2 (") == 1
    assert "record, mark, watch and sink do not work: ROS_DOMAIN_ID=" in said
