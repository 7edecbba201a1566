"""Records a graph that runs already: ``pytpc record`` without a launch file."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Mapping
from pathlib import Path

from pytpc.base.errors import MissingToolError, RunError
from pytpc.ros.mission_run import (
    BAG_FILE,
    DEFAULT_TOPICS,
    PARAMS_FILE,
    MissionRun,
    Progress,
    RecordOptions,
    marks_of,
    save_run,
)
from pytpc.ros.ros1.launch_mission import dump_params
from pytpc.ros.ros1.master import Master, own_host, uri_of
from pytpc.ros.ros1.recorder import NODE_NAME, GraphRecorder, Wanted
from pytpc.values.origins import START_FILE
from pytpc.values.recording import MISSION_PATIENCE_S, NO_LAUNCH, save_origins, try_trace
from pytpc.values.trace import Trace

_TOLD_S = 0.2


def record_graph(
    options: RecordOptions, *, stop: threading.Event, env: Mapping[str, str] | None = None
) -> MissionRun:
    """Record /rosout, /threshold_information, all observers' marks and the topics asked for.

    The folder gets mission.bag, run.json and, where rosparam is there, params_start.yaml,
    params.yaml and origins.json.

    Args:
        options: the folder, and when the recording ends beside ``stop``.
        stop: ends the recording.
        env: says where the master is and what this machine is called; None: that of this process.

    Raises:
        RunError: the master does not answer, or the folder has a recording: a robot's mission
            cannot be flown again, as a simulated one can.
        OSError: the bag cannot be written; what was recorded is in ``mission.bag.active``.
    """
    env = os.environ if env is None else env
    out_dir, on_progress = options.out_dir, options.on_progress
    _refuse_earlier(out_dir)
    out_dir.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    uri = uri_of(env)
    recorder = GraphRecorder(
        Master(uri, f"{NODE_NAME}_{os.getpid()}"),
        own_host(env, uri),
        Wanted([*DEFAULT_TOPICS, *options.topics], options.until or None),
        out_dir / BAG_FILE,
        strict=False,
    )
    beginning = _Beginning(env, options)
    try:
        beginning.start()
        ended, told = "", 0.0
        while not ended:
            status = recorder.step()
            wall_s = time.monotonic() - began
            if on_progress is not None and time.monotonic() - told > _TOLD_S:
                told = time.monotonic()
                sim_s = (status.now_ns - status.began_ns) / 1e9 if status.began_ns else 0.0
                on_progress(Progress(sim_s, wall_s, status.reports, marks_of(status.messages)))
            if stop.is_set():
                ended = "interrupted"
            elif status.done:
                ended = "done"
            elif options.timeout_s is not None and wall_s > options.timeout_s:
                ended = "timeout"
    except BaseException:
        recorder.leave()
        raise
    status = recorder.finish()
    trace, reason = beginning.ended()
    _try_dump(env, out_dir / PARAMS_FILE)
    run = MissionRun.of(status, out_dir, ended, time.monotonic() - began)
    save_run(run, options)
    save_origins(out_dir, out_dir / PARAMS_FILE, trace, reason, env)
    return run


class _Beginning(threading.Thread):
    """Asks for the values at the beginning, and reads the launch file, while the bag is written.

    Both may take many seconds, in which the robot goes on.
    """

    def __init__(self, env: Mapping[str, str], options: RecordOptions) -> None:
        super().__init__(name="beginning", daemon=True)
        self._env, self._out_dir = env, options.out_dir
        self._launch, self._args = options.launch, options.args
        self._found: tuple[Trace | None, str] | None = None

    def run(self) -> None:
        _try_dump(self._env, self._out_dir / START_FILE)
        if self._launch is not None:
            self._found = try_trace(self._env, self._launch, self._args)

    def ended(self) -> tuple[Trace | None, str]:
        """What the launch file sets, or why that is not known; waits for it, within limits."""
        self.join(2 * MISSION_PATIENCE_S)
        if self._launch is None:
            return None, NO_LAUNCH
        return self._found or (None, f"{self._launch} was not read in time")


def _try_dump(env: Mapping[str, str], path: Path) -> None:
    """Write what stands on the parameter server, or nothing.

    The master may be gone, or rosparam not be installed, and the bag is what matters.
    """
    try:
        dump_params(env, path)
    except (RunError, MissingToolError):
        path.unlink(missing_ok=True)


def _refuse_earlier(out_dir: Path) -> None:
    bag = out_dir / BAG_FILE
    active = bag.with_name(f"{bag.name}.active")
    if bag.exists():
        raise RunError("already has a recording; give another folder", out_dir)
    if active.exists():
        what = "is an unfinished recording; recover it with rosbag reindex, or give another folder"
        raise RunError(what, active)
