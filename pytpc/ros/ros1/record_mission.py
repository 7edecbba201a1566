"""Records a mission: of a launch file that it starts, or of the graph that runs.

The folder gets the files that ``pytpc.ros.mission_run`` names. A launch file's also gets ``ros/``
with the output of all processes.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from pytpc.base.errors import MissingToolError, RunError
from pytpc.base.paths import project_root
from pytpc.recording.mission import REPORTS_FOLDER
from pytpc.ros.mission_run import (
    BAG_FILE,
    DEFAULT_TOPICS,
    PARAMS_FILE,
    MissionRun,
    Progress,
    RecorderStatus,
    RecordOptions,
    clear_earlier,
    read_status,
    save_run,
)
from pytpc.ros.ros1 import recorder
from pytpc.ros.ros1.graph import GraphProcess, RosGraph
from pytpc.ros.ros1.master import Master, own_host, uri_of
from pytpc.ros.ros1.recorder import NODE_NAME, GraphRecorder, Wanted
from pytpc.values.origins import START_FILE
from pytpc.values.recording import MISSION_PATIENCE_S, NO_LAUNCH, save_origins, try_trace
from pytpc.values.trace import Trace, name_on_server

_POLL_S = 0.1
_RECORDER_PATIENCE_S = 20.0
_CLOCK_PATIENCE_S = 30.0
_LAUNCH_PATIENCE_S = 20.0
_DUMP_PATIENCE_S = 20.0
_SET_PATIENCE_S = 10.0
_TOLD_S = 0.2


def launch_command(launch: Path, args: Mapping[str, str]) -> list[str]:
    """The roslaunch command for a launch file and its arguments.

    Raises:
        RunError: the launch file is not there.
    """
    if not launch.is_file():
        raise RunError("no such launch file", launch)
    given = [f"{name}:={value}" for name, value in sorted(args.items())]
    timeouts = ["--sigint-timeout=4", "--sigterm-timeout=2"]
    return ["roslaunch", *timeouts, str(launch.absolute()), *given]


def run_mission(
    install_env: Mapping[str, str],
    options: RecordOptions,
    *,
    settle_s: float = 6.0,
    use_sim_time: bool = True,
) -> MissionRun:
    """Run a launch file on a graph of its own and record it.

    Args:
        install_env: environment of the installed workspace (``pytpc.build.build.workspace_env``).
        options: with the launch file and ``timeout_s``; results of an earlier run in its folder
            are replaced.
        settle_s: seconds of the graph's clock for which recording goes on after the end, because
            people press keys late.
        use_sim_time: the graph's clock is the topic /clock.

    Raises:
        RunError: the launch file is not there or not right, a node died, the recorder failed, or
            there was no /clock for 30 s; one line, with the output's file.
        MissingToolError: roslaunch or the master is not installed.
    """
    out_dir, launch, args = options.out_dir, options.launch, options.args
    if launch is None or options.timeout_s is None:
        raise ValueError("a launch file and a timeout are needed")
    command = launch_command(launch, args)
    out_dir.mkdir(parents=True, exist_ok=True)
    clear_earlier(out_dir)
    began = time.monotonic()
    trace, reason = try_trace(install_env, launch, args)
    reports_to = {"TPC_FOLDER": str((out_dir / REPORTS_FOLDER).absolute())}
    with RosGraph(
        {**reports_to, **install_env}, out_dir / "ros", use_sim_time=use_sim_time
    ) as graph:
        recording = _start_recorder(graph, options)
        started = graph.start("roslaunch", command, patience_s=_LAUNCH_PATIENCE_S, may_end=True)
        watch = _Watch(graph, started, out_dir, began, options.on_progress)
        watch.wait_for_parameters(trace)
        # Without it only less is known about the origins of values.
        with contextlib.suppress(RunError):
            dump_params(graph.env, out_dir / START_FILE)
        if use_sim_time:
            watch.wait_for_clock()
        ended = watch.wait_for_end(options.timeout_s, settle_s if use_sim_time else 0.0)
        dump_params(graph.env, out_dir / PARAMS_FILE)
        graph.stop(started)
        graph.stop(recording)
    status = read_status(_status_file(out_dir))
    if status is None or not status.closed:
        said = "; ".join(recording.tail()) or "it says nothing"
        raise RunError(f"the recorder did not finish: {said}", recording.log)
    run = MissionRun.of(status, out_dir, ended, time.monotonic() - began)
    return _saved(run, options, trace, reason, install_env)


def _saved(
    run: MissionRun,
    options: RecordOptions,
    trace: Trace | None,
    reason: str,
    env: Mapping[str, str],
) -> MissionRun:
    """Write how the mission went and where its values came from."""
    save_run(run, options)
    save_origins(options.out_dir, run.params, trace, reason, env)
    return run


def _status_file(out_dir: Path) -> Path:
    return out_dir / "ros" / "recorder.json"


def _start_recorder(graph: RosGraph, options: RecordOptions) -> GraphProcess:
    status = _status_file(options.out_dir).absolute()
    status.unlink(missing_ok=True)
    bag = (options.out_dir / BAG_FILE).absolute()
    command = [sys.executable, "-m", recorder.__name__, "--bag", str(bag)]
    command += ["--status", str(status)]
    if options.until is not None:
        command += ["--until", options.until]
    path = [str(project_root()), graph.env.get("PYTHONPATH", "")]
    process = graph.start(
        "recorder",
        [*command, *dict.fromkeys((*DEFAULT_TOPICS, *options.topics))],
        env={"PYTHONPATH": ":".join(part for part in path if part)},
        patience_s=_RECORDER_PATIENCE_S,
    )
    # The first messages of a node are lost unless the recorder waits for it already.
    limit = time.monotonic() + _RECORDER_PATIENCE_S
    while (said := read_status(status)) is None or not said.ready:
        graph.check()
        if time.monotonic() > limit:
            raise RunError(f"the recorder is not ready after {_RECORDER_PATIENCE_S:.0f} s")
        time.sleep(_POLL_S)
    return process


class _Watch:
    """Watches a running mission."""

    def __init__(
        self,
        graph: RosGraph,
        launched: GraphProcess,
        out_dir: Path,
        began: float,
        on_progress: Callable[[Progress], None] | None,
    ) -> None:
        self._graph = graph
        self._launched = launched
        self._status_path = _status_file(out_dir)
        self._began = began
        self._on_progress = on_progress

    def look(self) -> RecorderStatus:
        self._graph.check()
        status = read_status(self._status_path) or RecorderStatus()
        if self._on_progress is not None:
            self._on_progress(Progress.of(status, time.monotonic() - self._began))
        return status

    def wait_for_parameters(self, trace: Trace | None) -> None:
        """Wait until roslaunch has set the parameters; it does so before any node runs."""
        wanted = set() if trace is None else trace.by_roslaunch
        limit = time.monotonic() + _SET_PATIENCE_S
        while time.monotonic() < limit and not self._launched.has_ended_well:
            self.look()
            # On a busy machine the master may be late: then the next look asks again.
            with contextlib.suppress(RunError):
                names = self._graph.call("getParamNames")
                known = set(names) if isinstance(names, list) else set()
                if not {n for n in wanted if not _stands(n, known)}:
                    return
            time.sleep(_POLL_S)

    def wait_for_clock(self) -> None:
        limit = time.monotonic() + _CLOCK_PATIENCE_S
        while self.look().now_ns == 0 and not self._launched.has_ended_well:
            if time.monotonic() > limit:
                raise RunError(
                    f"no /clock for {_CLOCK_PATIENCE_S:.0f} s: without a simulator, use --wall-time"
                )
            time.sleep(_POLL_S)

    def wait_for_end(self, timeout_s: float, settle_s: float) -> str:
        limit = time.monotonic() + timeout_s
        while not (status := self.look()).done:
            if self._launched.has_ended_well:
                return "ended"
            if time.monotonic() > limit:
                return "timeout"
            time.sleep(_POLL_S)
        enough = status.now_ns + round(settle_s * 1e9)
        while self.look().now_ns < enough and time.monotonic() < limit:
            if self._launched.has_ended_well:
                break
            time.sleep(_POLL_S)
        return "done"


def _stands(name: str, known: set[str]) -> bool:
    """Whether a parameter is set, or one below it: a ``<param type="yaml">`` may be a map."""
    full = name_on_server(name, known)
    return full in known or any(other.startswith(f"{full}/") for other in known)


def dump_params(env: Mapping[str, str], path: Path) -> None:
    """Write the values of the parameter server.

    Raises:
        RunError: rosparam is not there, or fails.
    """
    beside = path.absolute().with_name(f".{path.name}.new")
    try:
        subprocess.run(
            ["rosparam", "dump", str(beside)],
            env=dict(env),
            check=True,
            capture_output=True,
            timeout=_DUMP_PATIENCE_S,
        )
    except FileNotFoundError as error:
        raise RunError("rosparam not found; install it with: apt-get install ros-core") from error
    except subprocess.TimeoutExpired as error:
        raise RunError("rosparam dump timed out") from error
    except subprocess.CalledProcessError as error:
        said = error.stderr.decode("utf-8", "replace").strip().splitlines()[-1:]
        raise RunError(f"rosparam dump failed: {' '.join(said)}") from error
    beside.replace(path)


def record_graph(
    options: RecordOptions, stop: threading.Event, env: Mapping[str, str] | None = None
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
                on_progress(Progress.of(status, wall_s))
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
    return _saved(run, options, trace, reason, env)


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
        """Wait for the launch file to be read; its values, or why they are not known."""
        self.join(2 * MISSION_PATIENCE_S)
        if self._launch is None:
            return None, NO_LAUNCH
        return self._found or (None, f"{self._launch} was not read in time")


def _try_dump(env: Mapping[str, str], path: Path) -> None:
    """Write the values of the parameter server, or nothing.

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
