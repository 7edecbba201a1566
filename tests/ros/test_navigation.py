"""A robot with a controller in a plugin on a real graph: built once, each mission driven once."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from flown import Fly, expected, flights, found, need_cpp_half
from rich.console import Console

from pytpc.recording.faults import unknown_keys
from pytpc.ros.ros1.graph import RosGraph
from pytpc_evaluation.demo.demo import gone_wrong
from pytpc_evaluation.demo.demo_examples import NAVIGATION
from pytpc_evaluation.demo.demo_show import Built, build

IN_CPP = {
    "controller_host",
    "ground_simulator",
    "localisation",
    "navigation_controllers",
    "planner",
    "recovery",
    "safety_stop",
}
# Of simulated time. A machine that cannot keep up is slower, and drives the same: the time waits,
# but for the first moment: all that is sent then is sent again until the last node is there.
RATE = "8"
MISSIONS = ("clean", "type1_goal_tolerance", "type2_min_start_quality")

need_cpp_half()


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Built:
    return build(NAVIGATION, Console(quiet=True), tmp_path_factory.mktemp("navigation"))


@pytest.fixture(scope="module")
def fly(robot, tmp_path_factory: pytest.TempPathFactory) -> Fly:
    return flights(NAVIGATION, robot, RATE, tmp_path_factory)


def test_analysis_finds_what_was_expected_by_hand_in_nodes_and_plugins(robot):
    in_python = "expected_python_tpcs.json"
    wanted = expected(NAVIGATION, "expected_tpcs.json") + expected(NAVIGATION, in_python)
    assert wanted - found(robot.static) == Counter()
    # And nothing else.
    assert found(robot.static) - wanted - expected(NAVIGATION, in_python, "either") == Counter()


@pytest.mark.quiet
@pytest.mark.parametrize("name", MISSIONS)
def test_mission_goes_as_its_treatment_demands(robot, fly, name):
    mission = fly(name)
    assert gone_wrong(mission) == []
    assert unknown_keys(mission.recording.events, robot.static) == {}
    assert (mission.recording.malformed, mission.recording.lost) == (0, {})


@pytest.mark.quiet
def test_many_parameters_act_in_a_clean_mission_in_each_link_unit(robot, fly):
    keys = fly("clean").recording.events.keys
    assert {robot.static.unit_of(key).link_unit for key in keys} == IN_CPP | {"mission"}
    assert len({robot.static.comparisons[key].source for key in keys}) >= 70


@pytest.mark.quiet
def test_changed_parameter_is_compared_where_it_decides(robot, fly):
    for name in MISSIONS[1:]:
        mission = fly(name)
        compared = {
            robot.static.comparisons[key].source.lstrip("~")
            for key in mission.recording.events.keys
        }
        assert mission.treatment.parameter.lstrip("~") in compared


@pytest.mark.parametrize(
    ("node", "answer"),
    [
        # It stood at the goal before; this one is 2 m away.
        ("controller_host", {"goal": 2, "arrived": False, "drives": True}),
        # NONE: it does not turn round for what was before.
        ("recovery", {"action": 0}),
    ],
)
def test_node_waits_for_what_comes_by_another_connection(robot, tmp_path, node, answer):
    installed = robot.env["CMAKE_PREFIX_PATH"].split(os.pathsep)[0]
    probe = [sys.executable, str(Path(__file__).with_name("navigation_probe.py")), node]
    with RosGraph(robot.env, tmp_path) as graph:
        graph.start(node, [f"{installed}/lib/navigation/{node}"])
        done = subprocess.run(
            probe, check=False, env=graph.env, capture_output=True, text=True, timeout=900
        )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == answer
