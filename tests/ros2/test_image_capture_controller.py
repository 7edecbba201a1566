"""The image capture mission with its controller in rclcpp: built, analysed and flown."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from patience import PATIENCE_S
from pytpc_evaluation.demo.demo import gone_wrong
from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE_ROS2
from pytpc_evaluation.demo.ros2_controller import NODE, PACKAGE, has_rclcpp, with_controller
from pytpc_evaluation.demo.ros2_missions import run_ros2_treatment
from pytpc_evaluation.demo.ros2_robot import Ros2Robot, prepared
from ros2_graph import needs_backend

pytestmark = [
    pytest.mark.skipif(not has_rclcpp(), reason="no ROS 2 with rclcpp was sourced"),
    needs_backend,
]
FIELDS = ("unit", "file", "line", "parameter", "type", "relation")


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Ros2Robot:
    folder = tmp_path_factory.mktemp("robot")
    return with_controller(prepared(IMAGE_CAPTURE_ROS2, folder), folder)


def test_analysis_finds_what_was_expected_by_hand(robot: Ros2Robot) -> None:
    expected = json.loads((PACKAGE / "expected_tpcs.json").read_text())["tpcs"]
    found = [
        (unit.link_unit, one.file, one.lineno, one.source, one.type, one.relation)
        for unit in robot.static.units
        if unit.package == PACKAGE.name
        for one in unit.comparisons
        if one.type != "constant"
    ]
    assert sorted(found) == sorted(tuple(one[name] for name in FIELDS) for one in expected)


def test_it_flies_the_mission_and_reports_under_its_name(
    robot: Ros2Robot, domain: dict[str, str], tmp_path: Path
) -> None:
    mission = run_ros2_treatment(
        robot,
        IMAGE_CAPTURE_ROS2.treatment("clean"),
        tmp_path / "clean",
        domain=domain,
        seed=1,
        rate=100.0,
        timeout_s=PATIENCE_S,
    )
    assert gone_wrong(mission) == []
    events = mission.recording.events
    assert set(events.nodes) == {f"/{name}" for name in robot.programs}
    names = {one.name for one in mission.recording.names}
    assert f"/{NODE}/max_velocity" in names
    # All nodes have the simulated time.
    assert 0 <= events.time_ns[0] <= events.time_ns[-1] <= mission.run.sim_s * 1e9
