"""The whole way on a real graph: build the mission with the passes, fly it, name the culprit."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from pytpc.base.errors import MissingToolError, RunError
from pytpc.base.paths import cmake_file, log_library, plugin
from pytpc.build.build import BuildResult, workspace_env
from pytpc.ingest.reading import read
from pytpc.recording.faults import unknown_keys
from pytpc.ros.left_processes import GRAPH_WORD
from pytpc.ros.mission_run import MISSION_DONE, Progress, RecordOptions
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.record_mission import run_mission
from pytpc_evaluation.demo.demo import FIRST, TreatedMission, gone_wrong, run_treatment
from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE

PACKAGE = Path(__file__).parents[2] / "examples/image_capture"
SECOND = 10**9
LAUNCH = PACKAGE / "launch/image_capture.launch"
# Of simulated time. A machine that cannot keep up is slower, and flies the same: the time waits.
RATE = "8"

try:
    for half in (cmake_file, plugin, log_library):
        half()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)


@pytest.fixture(scope="module")
def env(built) -> dict[str, str]:
    return workspace_env(built.bases.install)


def graph_processes(folder: Path) -> dict[int, str]:
    """The command of each process of the graphs below a folder; others may run beside them."""
    found = {}
    for entry in Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError):
            environment = (entry / "environ").read_bytes().decode(errors="replace")
            if f"{GRAPH_WORD}=" in environment and f"ROS_HOME={folder}/" in environment:
                command = (entry / "cmdline").read_bytes().decode(errors="replace")
                found[int(entry.name)] = command.replace("\0", " ")
    return found


@pytest.fixture(autouse=True)
def leaves_no_process(tmp_path) -> Iterator[None]:
    yield
    assert graph_processes(tmp_path) == {}


def fly(name: str, seed: int, built: BuildResult, env: dict[str, str], out: Path) -> TreatedMission:
    return run_treatment(
        IMAGE_CAPTURE,
        IMAGE_CAPTURE.treatment(name),
        seed=seed,
        install_env=env,
        static_info=built.static,
        out_dir=out,
        timeout_s=150.0,
        launch_args={"rate": RATE},
    )


def test_analysis_finds_what_was_expected_by_hand(built):
    expected = Counter(
        tuple(entry[name] for name in ("unit", "file", "line", "parameter", "type", "relation"))
        for entry in json.loads((PACKAGE / "expected_tpcs.json").read_text())["tpcs"]
    )
    found = Counter(
        (unit.link_unit, c.file, c.lineno, c.source, c.type, c.relation)
        for unit in built.units
        for c in unit.comparisons
        if c.type != "constant"
    )
    assert expected - found == Counter()
    assert found - expected == Counter()


def test_most_comparisons_name_the_topic_that_they_reach(built):
    topics = [c.topic for unit in built.static.units for c in unit.comparisons]
    assert sum(topic is not None for topic in topics) > 0.8 * len(topics)


def test_clean_mission_gets_no_mark_and_loses_no_report(built, env, tmp_path):
    mission = fly("clean", 1, built, env, tmp_path)
    assert gone_wrong(mission) == []
    run, recording = mission.run, mission.recording
    assert run.messages["/camera/picture"] == 1
    assert 40.0 < run.sim_s < 90.0
    assert unknown_keys(recording.events, built.static) == {}
    assert (recording.malformed, recording.lost) == (0, {})
    assert len(recording.events) == run.reports
    # What the thesis saw is 126 to 456 comparisons a second; the summaries count all of them.
    assert 300.0 < recording.summaries.count.sum() / run.sim_s < 600.0
    # Each report says what its comparison is: a value that passes must pass by the numbers.
    named = {key: built.static.comparisons[key] for key in recording.events.keys}
    for code, key in enumerate(recording.events.keys):
        rows = recording.events.by_key.rows(code)
        cmp, thresh = recording.events.cmp[rows], recording.events.thresh[rows]
        holds = {
            "<": cmp < thresh,
            "<=": cmp <= thresh,
            ">": cmp > thresh,
            ">=": cmp >= thresh,
            "flag": thresh != 0,
        }[named[key].relation]
        assert (holds == recording.events.res[rows]).all(), named[key]
    parameters = (tmp_path / "params.yaml").read_text()
    assert re.search(r"^ +face_detection_threshold: 25$", parameters, re.MULTILINE)


@pytest.mark.quiet
@pytest.mark.parametrize(
    ("treatment", "kind_and_pictures"),
    [("type1_face_detection_threshold", ("I", 1)), ("type2_min_coverage_limit", ("II", 0))],
)
def test_changed_parameter_is_among_the_first_suspects(
    built, env, tmp_path, treatment, kind_and_pictures
):
    kind, pictures = kind_and_pictures
    mission = fly(treatment, 1, built, env, tmp_path)
    assert gone_wrong(mission) == []
    assert mission.run.messages.get("/camera/picture", 0) == pictures
    assert mission.judged
    for ranking in mission.judged:
        assert ranking.mark.type == kind
        position = ranking.position_of(mission.treatment.parameter)
        assert position is not None and position <= FIRST


def test_fault_in_the_source_looks_like_a_type2_error(built, env, tmp_path):
    mission = fly("fault_coverage_range", 1, built, env, tmp_path)
    assert mission.run.messages.get("/camera/picture", 0) == 0
    assert [r for r in mission.rankings if r.mark.type == "II"]
    units = {built.static.unit_of(key).link_unit for key in mission.recording.events.keys}
    assert "mission_fault" in units
    assert "mission" not in units


def test_fault_in_another_node_looks_like_a_type1_error(built, env, tmp_path):
    mission = fly("fault_shape_test", 1, built, env, tmp_path)
    assert mission.run.messages["/camera/picture"] == 1
    assert [r for r in mission.rankings if r.mark.type == "I"]
    units = {built.static.unit_of(key).link_unit for key in mission.recording.events.keys}
    assert {"face_detector_fault", "mission"} <= units
    assert not {"face_detector", "mission_fault"} & units


def test_node_that_dies_ends_the_mission_with_one_line(env, tmp_path):
    killed = []

    def kill_mission(progress: Progress) -> None:
        if progress.sim_s > 1.0 and not killed:
            for pid, command in graph_processes(tmp_path).items():
                if "lib/image_capture/mission " in command:
                    os.kill(pid, signal.SIGSEGV)
                    killed.append(pid)

    with pytest.raises(RunError) as caught:
        options = RecordOptions(
            tmp_path, LAUNCH, {"seed": "1"}, 60.0, until=MISSION_DONE, on_progress=kill_mission
        )
        run_mission(env, options)
    assert len(killed) == 1
    text = str(caught.value)
    assert "\n" not in text
    assert "mission" in text and "has died" in text
    assert not (tmp_path / "run.json").exists()
    # What was recorded until then is kept, and is a whole bag.
    assert read(tmp_path / "mission.bag").end_ns > SECOND


def test_broken_launch_file_is_one_line(env, tmp_path):
    launch = tmp_path / "broken.launch"
    launch.write_text("<launch>\n  <node pkg='image_capture' type='none' name='n'>\n</launch>\n")
    with pytest.raises(RunError, match=r"roslaunch ended with status 1: .*Invalid roslaunch XML"):
        run_mission(env, RecordOptions(tmp_path / "out", launch, {}, 60.0, until=MISSION_DONE))


def test_graph_is_one_of_its_own_and_ends_what_it_started(env, tmp_path):
    with (
        RosGraph(env, tmp_path / "a", use_sim_time=True) as first,
        RosGraph(env, tmp_path / "b") as second,
    ):
        assert first.uri != second.uri
        assert first.call("getParam", "/use_sim_time") is True
        assert second.call("hasParam", "/use_sim_time") is False
        # A child that hides in a session of its own and is deaf to being asked.
        first.start("deaf", ["setsid", "--fork", "bash", "-c", "trap '' INT TERM; sleep 600"])
        first.start("plain", ["sleep", "600"])
        second.check()
        # Two masters, two rosouts and the two above, which take a moment to be there.
        began = time.monotonic()
        while len(graph_processes(tmp_path)) < 6:
            assert time.monotonic() - began < 10.0
            time.sleep(0.05)
        with pytest.raises(RunError, match="deaf ended with status 0"):
            for _ in range(100):
                first.check()
                subprocess.run(["sleep", "0.05"], check=True)


@pytest.mark.quiet
def test_ends_quickly_where_sigint_is_ignored(env, tmp_path):
    # As in a job that a script put into the background; SIGTERM would come after 5 s.
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with RosGraph(env, tmp_path) as graph:
            sleeper = graph.start("sleeper", ["sleep", "600"])
            began = time.monotonic()
            assert graph.stop(sleeper) == -signal.SIGINT
        assert time.monotonic() - began < 4.0
        assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_program_that_is_not_there_is_one_line(env, tmp_path):
    with (
        RosGraph(env, tmp_path) as graph,
        pytest.raises(MissingToolError, match="no_such_program not found"),
    ):
        graph.start("x", ["no_such_program"])
