"""Which graph a command uses where a machine has ROS 1, ROS 2 or both."""

from __future__ import annotations

import os
from collections.abc import Callable

import pytest

from pytpc.cli import running_graph
from pytpc.cli.running_graph import UsedGraph, ros2_here, use_graph
from pytpc.ros.ros2.address import VARIABLES
from pytpc.ros.running import RunningRecording, process_start

MASTER = "http://robot:11311"
DOMAIN = "ros2://7"
OF_ROS = ("ROS_MASTER_URI", "ROS_DOMAIN_ID", "ROS_VERSION", "AMENT_PREFIX_PATH", "TPC_ROS")

Choose = Callable[..., UsedGraph]


@pytest.fixture
def choose(monkeypatch: pytest.MonkeyPatch) -> Choose:
    """Choose with these variables, recordings and masters that answer."""
    for name in (*OF_ROS, "TPC_ROS2_PYTHON", "ROS_IP", "ROS_HOSTNAME", *VARIABLES):
        monkeypatch.setenv(name, "")

    def chosen(*masters: str, answers: str = "", **env: str) -> UsedGraph:
        there = [recording(one) for one in masters]
        monkeypatch.setattr(running_graph, "running_recordings", lambda: there)
        monkeypatch.setattr(running_graph, "_answers", lambda uri: uri == answers)
        for name in (*OF_ROS, *VARIABLES):
            monkeypatch.setenv(name, env.get(name, ""))
        return use_graph()

    return chosen


def recording(master: str) -> RunningRecording:
    pid = os.getpid()
    return RunningRecording(pid, process_start(pid) or 0, master, "", f"/out/{master[-1]}")


def test_a_shell_of_ros2_without_a_master_uses_its_domain(choose: Choose) -> None:
    assert choose(ROS_DOMAIN_ID="7") == (DOMAIN, None)
    assert choose(ROS_VERSION="2") == ("ros2://0", None)
    assert choose(AMENT_PREFIX_PATH="/opt/ros/jazzy") == ("ros2://0", None)
    assert choose(ROS_DOMAIN_ID="7", ROS_MASTER_URI=MASTER) == (DOMAIN, None)


def test_without_a_sign_of_ros2_all_is_as_it_was(choose: Choose) -> None:
    assert choose() == ("http://localhost:11311", None)
    assert choose(ROS_MASTER_URI=MASTER) == (MASTER, None)
    assert ros2_here() is None


def test_a_master_that_answers_goes_first_and_says_so(
    choose: Choose, capsys: pytest.CaptureFixture[str]
) -> None:
    both = {"ROS_DOMAIN_ID": "7", "ROS_MASTER_URI": MASTER}
    assert choose(answers=MASTER, **both) == (MASTER, None)
    assert "using ROS 1, whose master answers" in capsys.readouterr().err
    assert choose(answers=MASTER, TPC_ROS="2", **both) == (DOMAIN, None)
    # The usual master, which no variable names.
    usual = "http://localhost:11311"
    assert choose(answers=usual, ROS_DOMAIN_ID="7") == (usual, None)
    assert "--ros 2" in capsys.readouterr().err


def test_a_user_who_names_ros1_gets_it(choose: Choose) -> None:
    assert choose(TPC_ROS="1", ROS_DOMAIN_ID="7", ROS_MASTER_URI=MASTER) == (MASTER, None)


def test_a_recording_of_ros2_gives_its_domain(choose: Choose) -> None:
    address = f"{DOMAIN}?ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST"
    found = choose(address)
    assert found == (address, recording(address))
    assert os.environ["ROS_DOMAIN_ID"] == "7"
    assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"
    # That of the user's own domain, among several.
    assert choose(DOMAIN, "ros2://8", ROS_DOMAIN_ID="8").master == "ros2://8"
    assert choose(MASTER, DOMAIN, TPC_ROS="2").master == DOMAIN
    assert choose(MASTER, DOMAIN, TPC_ROS="1").master == MASTER


def test_another_domain_is_the_users_choice(
    choose: Choose, capsys: pytest.CaptureFixture[str]
) -> None:
    assert choose(DOMAIN, ROS_DOMAIN_ID="8") == ("ros2://8", None)
    assert "--recording /out/7" in capsys.readouterr().err
