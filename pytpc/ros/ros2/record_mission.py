"""Records a mission of ROS 2 that it starts: a launch file by launch, or executables.

The folder gets the files that ``pytpc.ros.mission_run`` names, and ``ros/`` with the output of all
processes. The graph is that of the shell: ROS 2 has no master that could be TPC's own.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from pytpc.base.errors import RunError
from pytpc.base.folder_lock import alone_in
from pytpc.base.signals import Stop
from pytpc.base.wording import listed, many
from pytpc.ingest.file_counts import FileCounter, FileCounts
from pytpc.recording.mission import REPORTS_FOLDER
from pytpc.ros.mission_run import (
    MCAP_FILE,
    Deaths,
    MissionRun,
    RecordOptions,
    clear_earlier,
    keep_static,
    save_run,
)
from pytpc.ros.node_start import command_of
from pytpc.ros.ros2.address import DOMAIN, Ros2Address
from pytpc.ros.ros2.agent_process import Agent
from pytpc.ros.ros2.flight import Flight
from pytpc.ros.ros2.found_nodes import visible
from pytpc.ros.ros2.graph_recording import GraphRecording, Looked
from pytpc.ros.ros2.interpreter import launch_interpreter
from pytpc.values.doubts import doubts
from pytpc.values.recording import try_trace
from pytpc.values.trace import Trace

_COUNT_S = 1.0
_STEP_S = 0.05
# What nodes published last is on its way when they have ended.
_LATE_S = 0.5
_LISTED = 5


class Programs(NamedTuple):
    """Executables to run without launch, and the arguments that each of them gets."""

    paths: Sequence[Path]
    arguments: Sequence[str] = ()


def run_ros2_mission(
    env: Mapping[str, str],
    options: RecordOptions,
    programs: Programs | None = None,
    *,
    stop: Stop,
) -> MissionRun:
    """Run a launch file, or executables, on the graph of the shell and record it.

    Args:
        env: of the nodes, with the domain.
        options: with the launch file, unless there are programs; results of an earlier run in the
            folder are replaced.
        programs: what is run instead of a launch file.
        stop: ends the mission; the recording is complete, whenever it is set.

    Raises:
        MissingToolError: no interpreter has rclpy, or launch.
        RunError: launch failed, ROS 2 does not work, another recording is being written to the
            folder, or the file can no longer be written; one line, with the output's file.
    """
    python = "" if programs is not None else launch_interpreter(env)
    options.out_dir.mkdir(parents=True, exist_ok=True)
    with alone_in(options.out_dir) as lock:
        kept = clear_earlier(options.out_dir)
        if kept and options.on_kept is not None:
            options.on_kept(kept)
        keep_static(options)
        began = time.monotonic()
        trace, reason = _read(env, options, python)
        agent = Agent(Ros2Address.of_env(env), env)
        recording = GraphRecording.of(agent, options)
        reports = {"TPC_FOLDER": str((options.out_dir / REPORTS_FOLDER).absolute())}
        flight = Flight({**reports, **env}, options.out_dir / "ros", [lock])
        watch = _Watch(flight, recording, options)
        ended, failure = "interrupted", None
        try:
            _tell_others(agent, options)
            if options.on_graph is not None:
                options.on_graph(str(agent.address), "")
            if not stop.is_set():
                _start(flight, options, programs, python)
                ended = recording.run(stop, began, watch.look)
                # A node that is ended does not tell its parameters any more.
                recording.wait_for_values(lambda: stop.in_a_hurry)
                recording.keep_graph()
        except RunError as error:
            failure = error
        finally:
            watch.end(stop)
            status, fault = recording.finish(stop.in_a_hurry)
        failure = failure or (None if ended == "interrupted" else flight.failure())
        if fault and failure is None:
            failure = RunError(f"the recording ended: {fault}; what came until then is in it")
        word = "failed" if failure is not None else ended
        wall_s = time.monotonic() - began
        run = MissionRun.of(status, options.out_dir, word, wall_s, watch.counter.count())
        run = replace(run, bag=options.out_dir / MCAP_FILE, died=watch.deaths.last)
        save_run(run, options)
        recording.save_origins(trace, reason, env, is_own=True)
        if failure is not None:
            raise failure
        return run


def _read(env: Mapping[str, str], options: RecordOptions, python: str) -> tuple[Trace | None, str]:
    """What the launch file sets, and why that is not known; its doubts are told."""
    if options.launch is None:
        return None, ""
    trace, reason = try_trace(env, options.launch, options.args, python)
    if trace is not None and options.on_doubt is not None:
        for doubt in doubts(trace):
            options.on_doubt(doubt)
    return trace, reason


def _tell_others(agent: Agent, options: RecordOptions) -> None:
    """Say which nodes are in the domain already: they would be taken for those of the mission."""
    others = visible(agent.wait_for_graph().nodes)
    if others and options.on_doubt is not None:
        domain = agent.address.domain
        options.on_doubt(
            f"{many(len(others), 'node')} already in domain {domain}, and recorded, too:"
            f" {listed(others, _LISTED)}; for a domain of its own: export {DOMAIN}=NUMBER"
        )


def _start(flight: Flight, options: RecordOptions, programs: Programs | None, python: str) -> None:
    if programs is None:
        if options.launch is None:
            raise ValueError("a launch file or programs are needed")
        flight.launch([python], options.launch, options.args)
        return
    for path in programs.paths:
        flight.execute(path, command_of(path, programs.arguments, ()))


class _Watch:
    """Watches the processes of a mission while its graph is recorded."""

    def __init__(self, flight: Flight, recording: GraphRecording, options: RecordOptions) -> None:
        self.counter = FileCounter(options.out_dir / REPORTS_FOLDER)
        self._flight, self._recording = flight, recording
        self.deaths = Deaths(options.on_died)
        self._counts = FileCounts()
        self._counted = 0.0
        self._seen = 0

    def look(self) -> Looked:
        """Tell of deaths; whether all processes have ended, and what they wrote to files."""
        is_over = self._flight.is_over
        self.deaths.see(self._flight.look())
        started = self._flight.started
        if len(started) > self._seen:
            self._recording.command_lines.look(started[self._seen :])
            self._seen = len(started)
        if time.monotonic() > self._counted + _COUNT_S:
            self._counted, self._counts = time.monotonic(), self.counter.count()
        return Looked(is_over, self._counts)

    def end(self, stop: Stop) -> None:
        """End the processes, and record what they still say."""
        self.look()
        ending = threading.Thread(
            target=self._flight.stop, args=(lambda: stop.in_a_hurry,), name="ending"
        )
        ending.start()
        while ending.is_alive():
            self._recording.step(_STEP_S)
        until = time.monotonic() + _LATE_S
        while time.monotonic() < until and not stop.in_a_hurry:
            self._recording.step(_STEP_S)
