"""Treated missions on a ROS 2 graph: flown, read and ranked.

The nodes write files, the marks are heard by `ros2_listener`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from rich.console import Console

from pytpc.cli.lines import progress_console
from pytpc.ingest.reading import read
from pytpc.recording.mission import EVENTS_FILE, REPORTS_FOLDER, Recording
from pytpc.ros.mission_run import MissionRun, Progress, RecordOptions, save_run
from pytpc.values.origins import PARAMS_FILE
from pytpc_evaluation.demo.demo import TreatedMission, treated
from pytpc_evaluation.demo.demo_examples import Example
from pytpc_evaluation.demo.demo_show import Ready, step, tell_found
from pytpc_evaluation.demo.ros2_controller import has_rclcpp, with_controller
from pytpc_evaluation.demo.ros2_robot import Flown, Ros2Robot, flown, own_domain, prepared
from pytpc_evaluation.treatment import Treatment


@contextmanager
def analysed_package(example: Example, console: Console, out: Path) -> Iterator[Ready]:
    """The robot's package as it is, analysed; Python nodes need no build.

    Where rclcpp is found, the controller is the one in C++.
    """
    in_cpp = has_rclcpp()
    with step(console, "Analyse the mission's nodes"):
        robot = prepared(example, out / "install")
        if not in_cpp:
            tell_found(console, robot.static)
    if in_cpp:
        with step(console, "Build the flight controller in C++ with TPC"):
            with progress_console().status("colcon build"):
                robot = with_controller(robot, out)
            tell_found(console, robot.static)
    with own_domain() as domain:
        yield Ready(robot.static, partial(run_ros2_treatment, robot, domain=domain))


def run_ros2_treatment(
    robot: Ros2Robot,
    treatment: Treatment,
    out_dir: Path,
    *,
    domain: Mapping[str, str],
    seed: int,
    timeout_s: float,
    rate: float = 4.0,
    on_progress: Callable[[Progress], None] | None = None,
) -> TreatedMission:
    """Fly one mission under a treatment, and rank the parameters at its marks.

    Args:
        robot: from ``prepared``.
        treatment: what is changed.
        out_dir: of the mission.
        domain: the variables that choose the graph.
        seed: of all noise, and of the observer.
        timeout_s: wall time after which the mission is ended.
        rate: simulated seconds in one second.
        on_progress: called several times a second.

    Raises:
        RunError: the mission could not be flown.
        InputError: what was recorded cannot be read.
    """
    done = flown(
        robot,
        treatment,
        out_dir,
        domain,
        seed=seed,
        rate=rate,
        timeout_s=timeout_s,
        on_progress=on_progress,
    )
    recording = on_graph(read(out_dir / REPORTS_FOLDER), done, out_dir.name)
    run = _run_of(done, out_dir, recording)
    save_run(run, RecordOptions(out_dir, args={"seed": str(seed), **treatment.launch}))
    return treated(
        robot.example, treatment, seed=seed, run=run, recording=recording, static_info=robot.static
    )


def on_graph(recording: Recording, done: Flown, name: str) -> Recording:
    """The recording of the nodes' files, named after the mission, with the marks of its graph."""
    times = recording.events.time_ns
    start, end = (int(times[0]), int(times[-1])) if len(times) else (0, 0)
    marks = tuple(sorted(done.heard.marks, key=lambda mark: mark.order()))
    return replace(recording, name=name, marks=marks, start_ns=min(start, end), end_ns=end)


def _run_of(done: Flown, out_dir: Path, recording: Recording) -> MissionRun:
    heard = done.heard
    return MissionRun(
        # It stands for the folder.
        bag=out_dir / EVENTS_FILE,
        params=out_dir / PARAMS_FILE,
        ended=done.ended,
        sim_s=heard.clock[-1][1] / 1e9 if heard.clock else 0.0,
        wall_s=done.wall_s,
        reports=done.reports,
        messages=dict(heard.messages),
        lost=dict(recording.lost),
        missed_before={},
        done_ns=heard.done_ns,
        files=len(list((out_dir / REPORTS_FOLDER).iterdir())),
        reports_in_files=done.reports,
        marks=len(heard.marks),
    )
