"""The image capture mission in rclpy on a real graph: analysed, flown, and the culprit named."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest

from patience import PATIENCE_S
from pytpc.ros.mission_run import MARK_TOPICS
from pytpc.values.origins import read_origins
from pytpc_evaluation.demo.demo import TreatedMission, gone_wrong, not_named
from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE_ROS2
from pytpc_evaluation.demo.ros2_missions import run_ros2_treatment
from pytpc_evaluation.demo.ros2_robot import Ros2Robot, prepared

CHANGED = "type1_face_detection_threshold"


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Ros2Robot:
    return prepared(IMAGE_CAPTURE_ROS2, tmp_path_factory.mktemp("install"))


@pytest.fixture(scope="module")
def missions(robot, domain, tmp_path_factory) -> dict[str, TreatedMission]:
    folder = tmp_path_factory.mktemp("missions")
    return {
        name: run_ros2_treatment(
            robot,
            IMAGE_CAPTURE_ROS2.treatment(name),
            folder / name,
            domain=domain,
            seed=1,
            # As fast as the machine: the simulated time waits for the nodes.
            rate=100.0,
            timeout_s=PATIENCE_S,
        )
        for name in ("clean", CHANGED)
    }


def test_analysis_finds_what_was_expected_by_hand(robot):
    document = json.loads((IMAGE_CAPTURE_ROS2.folder / "expected_tpcs.json").read_text())
    fields = ("unit", "file", "line", "parameter", "type", "relation")

    def listed(*parts: str) -> Counter[tuple[object, ...]]:
        return Counter(
            tuple(entry[name] for name in fields) for part in parts for entry in document[part]
        )

    found = Counter(
        (unit.link_unit, c.file, c.lineno, c.source, c.type, c.relation)
        for unit in robot.static.units
        for c in unit.comparisons
    )
    assert listed("tpcs") - found == Counter()
    either = {(entry["file"], entry["line"], entry["parameter"]) for entry in document["either"]}
    more = found - listed("tpcs", "missed", "wrong")
    assert {(file, line, source) for _, file, line, source, *_ in more} <= either


def test_clean_mission_takes_a_picture_and_gets_no_mark(robot, missions):
    mission = missions["clean"]
    assert gone_wrong(mission) == []
    assert mission.run.messages["/camera/picture"] == 1
    assert 30.0 < mission.run.sim_s < 60.0
    recording = mission.recording
    assert set(recording.events.nodes) == {f"/{name}" for name in robot.programs}
    assert set(recording.events.keys) <= set(robot.static.comparisons)
    # Of the 46 comparisons some need a second picture, an alarm or an empty battery.
    assert len(recording.events.keys) > 35
    assert 0 <= recording.start_ns < recording.end_ns <= mission.run.sim_s * 1e9


def test_changed_parameter_is_the_first_suspect(robot, missions):
    mission = missions[CHANGED]
    assert gone_wrong(mission) == []
    assert [r.mark.type for r in mission.judged] == ["I"]
    assert mission.run.messages[MARK_TOPICS[0]] == len(mission.recording.marks)
    diagnosis = mission.diagnosis(robot.static, [missions["clean"]])
    assert not_named(mission, diagnosis) == []
    # The values of both runs are known, and where the parameter acts.
    assert diagnosis.confidence > 0.8
    origin = read_origins(mission.run.bag)["/mission/face_detection_threshold"]
    assert (origin.value, origin.lineno) == (3, 4)
    assert origin.path == Path(mission.treatment.overlay).absolute()
