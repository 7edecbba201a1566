"""Records a mission: of a launch file that it starts, or of the graph that runs.

The folder gets the files that ``pytpc.ros.mission_run`` names. A launch file's also gets ``ros/``
with the output of all processes.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import shutil
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path

from pytpc.base.errors import MissingToolError, RunError, TpcError
from pytpc.base.folder_lock import alone_in
from pytpc.base.paths import project_root
from pytpc.base.signals import Stop
from pytpc.base.wording import listed
from pytpc.ingest.file_counts import FileCounter
from pytpc.recording.graph_file import GRAPH_FILE, write_graph
from pytpc.recording.mission import REPORTS_FOLDER
from pytpc.ros.mission_run import (
    BAG_FILE,
    DEFAULT_TOPICS,
    MARK_TOPICS,
    DiedNode,
    MissionRun,
    Progress,
    RecordOptions,
    clear_earlier,
    keep_earlier_marks,
    keep_static,
    read_status,
    refuse_earlier,
    save_run,
)
from pytpc.ros.ros1 import recorder
from pytpc.ros.ros1.graph import GraphProcess, RosGraph
from pytpc.ros.ros1.master import Master, own_host, uri_of
from pytpc.ros.ros1.mission_watch import MissionWatch, status_file
from pytpc.ros.ros1.param_dump import dump_params, try_dump
from pytpc.ros.ros1.quiet_graph import QuietWatch
from pytpc.ros.ros1.recorder import NODE_NAME, GraphRecorder, Wanted
from pytpc.values.doubts import doubts
from pytpc.values.origins import PARAMS_FILE, START_FILE
from pytpc.values.recording import MISSION_PATIENCE_S, NO_LAUNCH, save_origins, try_trace
from pytpc.values.trace import Trace

_POLL_S = 0.1
_RECORDER_PATIENCE_S = 20.0
_LAUNCH_PATIENCE_S = 20.0
_TOLD_S = 0.2
_TOOLS = ("roslaunch", "rosmaster", "rosparam")
# One process may record twice at a time: a name that comes again ends the node that has it.
_NUMBERS = itertools.count(1)
_INTERRUPTED_EARLY = "the mission was interrupted before roslaunch had set its parameters"


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


def require_launch_tools(env: Mapping[str, str]) -> None:
    """Check that what runs a launch file is there, before anything is started.

    Raises:
        MissingToolError: it is not; the message says how to install it.
    """
    absent = [name for name in _TOOLS if shutil.which(name, path=env.get("PATH")) is None]
    if absent:
        raise MissingToolError(
            f"{listed(absent, len(_TOOLS))} of ROS 1 not found; install it with: apt-get install"
            " ros-core"
        )


def run_mission(
    install_env: Mapping[str, str],
    options: RecordOptions,
    *,
    settle_s: float = 6.0,
    use_sim_time: bool | None = True,
    stop: Stop | None = None,
) -> MissionRun:
    """Run a launch file on a graph of its own and record it.

    Args:
        install_env: environment of the installed workspace (``pytpc.build.build.workspace_env``).
        options: with the launch file; results of an earlier run in its folder are replaced.
        settle_s: seconds of the graph's clock for which recording goes on after the end, because
            people press keys late.
        use_sim_time: the graph's clock is the topic /clock. None: the launch file says so, or not.
        stop: ends the mission; the recording is complete, whenever it is set. With it, a mission
            that failed is recorded as well.

    Raises:
        RunError: the launch file is not there or not right, a node died, the recorder failed,
            there was no /clock for 30 s where ``use_sim_time`` is true, or another recording is
            being written to the folder; one line, with the output's file.
        MissingToolError: roslaunch or the master is not installed.
    """
    out_dir, launch, args = options.out_dir, options.launch, options.args
    if launch is None:
        raise ValueError("a launch file is needed")
    command = launch_command(launch, args)
    require_launch_tools(install_env)
    out_dir.mkdir(parents=True, exist_ok=True)
    with alone_in(out_dir) as lock:
        _tell_kept(options, clear_earlier(out_dir))
        keep_static(options)
        began = time.monotonic()
        trace, reason = try_trace(install_env, launch, args)
        if trace is not None and options.on_doubt is not None:
            for doubt in doubts(trace):
                options.on_doubt(doubt)
        simulated = use_sim_time
        if simulated is None:
            simulated = trace is not None and trace.sim_time is True
        reports_to = {"TPC_FOLDER": str((out_dir / REPORTS_FOLDER).absolute())}
        asked = Stop() if stop is None else stop
        failure: RunError | None = None
        with RosGraph(
            {**reports_to, **install_env},
            out_dir / "ros",
            use_sim_time=simulated,
            stop=stop,
            inherited=[lock],
        ) as graph:
            recording = _recorder_of(graph, options, asked)
            flight = _Flight(graph, options, trace, asked, began)
            if options.on_graph is not None:
                options.on_graph(graph.uri, graph.env["ROS_IP"])
            try:
                if not asked.is_set():
                    flight.run(
                        command, settle_s if simulated else 0.0, needs_clock=bool(use_sim_time)
                    )
            except RunError as error:
                if stop is None:
                    raise
                # A Ctrl-C reaches a process that is just being started, before it has a session of
                # its own.
                if not stop.is_set():
                    failure, flight.ended = error, "failed"
            _dump_at_end(graph.env, out_dir / PARAMS_FILE, stop)
            _keep_graph(graph.uri, out_dir)
            flight.stop()
            graph.stop(recording)
        status = read_status(status_file(out_dir))
        if status is None or not status.closed:
            said = "; ".join(recording.tail()) or "it says nothing"
            raise failure or RunError(f"the recorder did not finish: {said}", recording.log)
        if not flight.is_set_up and flight.ended == "interrupted":
            trace, reason = None, _INTERRUPTED_EARLY
        in_files = FileCounter(out_dir / REPORTS_FOLDER).count()
        run = MissionRun.of(status, out_dir, flight.ended, time.monotonic() - began, in_files)
        run = replace(run, died=flight.died)
        _saved(run, options, trace, reason, install_env)
        if failure is not None:
            raise failure
        return run


class _Flight:
    """The launch file while it runs; ``is_set_up`` says that roslaunch has set its parameters."""

    def __init__(
        self,
        graph: RosGraph,
        options: RecordOptions,
        trace: Trace | None,
        stop: Stop,
        began: float,
    ) -> None:
        self._graph, self._options, self._trace = graph, options, trace
        self._stop, self._began = stop, began
        self._roslaunch: GraphProcess | None = None
        self.is_set_up = False
        self.ended = "interrupted"
        self.died: tuple[DiedNode, ...] = ()

    def run(self, command: list[str], settle_s: float, *, needs_clock: bool) -> None:
        """Run it until the mission ends.

        Raises:
            RunError: a node died, or there is no /clock where it is needed.
        """
        self._roslaunch = self._graph.start(
            "roslaunch", command, patience_s=_LAUNCH_PATIENCE_S, may_end=True
        )
        watch = MissionWatch(self._graph, self._roslaunch, self._options, self._stop, self._began)
        with closing(watch):
            self.is_set_up = watch.wait_for_parameters(self._trace)
            # Without it only less is known about the origins of values.
            try_dump(self._graph.env, self._options.out_dir / START_FILE, self._stop.is_set)
            if needs_clock:
                watch.wait_for_clock()
            self.ended = watch.wait_for_end(settle_s)
        self.died = watch.deaths.last

    def stop(self) -> None:
        """End roslaunch and its nodes."""
        if self._roslaunch is not None:
            self._graph.stop(self._roslaunch)


def _dump_at_end(env: Mapping[str, str], path: Path, stop: Stop | None) -> None:
    """Write the values of the parameter server, while the nodes still run.

    Raises:
        RunError: that fails, and a mission without them is of no use to the caller.
    """
    if stop is None:
        dump_params(env, path)
    else:
        try_dump(env, path, lambda: stop.in_a_hurry)


def _keep_graph(uri: str, out_dir: Path) -> None:
    """Write who speaks to whom; without it only less is known of the messages."""
    with contextlib.suppress(TpcError):
        found = Master(uri, f"{NODE_NAME}_{os.getpid()}").connections()
        write_graph(found.topics, out_dir / GRAPH_FILE, found.services)


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


def _tell_kept(options: RecordOptions, kept: Sequence[Path]) -> None:
    if kept and options.on_kept is not None:
        options.on_kept(kept)


def _recorder_of(graph: RosGraph, options: RecordOptions, stop: Stop) -> GraphProcess:
    """The recorder; started again if a Ctrl-C has ended it before it had a session of its own."""
    try:
        return _start_recorder(graph, options)
    except RunError:
        if not stop.is_set():
            raise
        return _start_recorder(graph, options)


def _start_recorder(graph: RosGraph, options: RecordOptions) -> GraphProcess:
    status = status_file(options.out_dir).absolute()
    status.unlink(missing_ok=True)
    bag = (options.out_dir / BAG_FILE).absolute()
    command = [sys.executable, "-m", recorder.__name__, "--bag", str(bag)]
    command += ["--status", str(status), "--parent", str(os.getpid())]
    if options.until is not None:
        command += ["--until", options.until]
    path = [str(project_root()), graph.env.get("PYTHONPATH", "")]
    process = graph.start(
        "recorder",
        [*command, *dict.fromkeys((*DEFAULT_TOPICS, *options.topics))],
        env={"PYTHONPATH": ":".join(part for part in path if part)},
        patience_s=_RECORDER_PATIENCE_S,
    )
    # Otherwise the bag would not be closed.
    graph.never_hurry(process)
    # The first messages of a node are lost unless the recorder waits for it already.
    limit = time.monotonic() + _RECORDER_PATIENCE_S
    while (said := read_status(status)) is None or not said.ready:
        try:
            graph.check()
        except RunError:
            graph.stop(process)
            raise
        if time.monotonic() > limit:
            raise RunError(f"the recorder is not ready after {_RECORDER_PATIENCE_S:.0f} s")
        time.sleep(_POLL_S)
    return process


def record_graph(
    options: RecordOptions,
    stop: threading.Event | Stop,
    env: Mapping[str, str] | None = None,
    launch_env: Mapping[str, str] | None = None,
) -> MissionRun:
    """Record /rosout, /threshold_information, all observers' marks and the topics asked for.

    The folder gets mission.bag, run.json and, where rosparam is there, params_start.yaml,
    params.yaml and origins.json.

    Args:
        options: the folder, and when the recording ends beside ``stop``.
        stop: ends the recording; if it is set again, nothing that can be left out is waited for.
        env: says where the master is and what this machine is called; None: that of this process.
        launch_env: in which the launch file is read; None: ``env``.

    Raises:
        RunError: the master does not answer, or the folder has a recording: a robot's mission
            cannot be flown again, as a simulated one can. Or the bag can no longer be written; it
            is closed, and has what was written before.
        OSError: the bag cannot be opened.
    """
    options.out_dir.mkdir(parents=True, exist_ok=True)
    with alone_in(options.out_dir):
        known = os.environ if env is None else env
        return _record_graph(options, stop, known, known if launch_env is None else launch_env)


def _record_graph(
    options: RecordOptions,
    stop: threading.Event | Stop,
    env: Mapping[str, str],
    launch_env: Mapping[str, str],
) -> MissionRun:
    out_dir, on_progress = options.out_dir, options.on_progress
    refuse_earlier(out_dir)
    keep_static(options)
    began = time.monotonic()
    uri = uri_of(env)
    number = next(_NUMBERS)
    name = f"{NODE_NAME}_{os.getpid()}" + (f"_{number}" if number > 1 else "")
    recorder = GraphRecorder(
        Master(uri, name),
        own_host(env, uri),
        Wanted(
            [*(DEFAULT_TOPICS if options.reports else MARK_TOPICS), *options.topics],
            options.until or None,
        ),
        out_dir / BAG_FILE,
        strict=False,
    )
    recorder.tell_marks(options.on_mark)
    beginning = _Beginning(env, launch_env, options)
    quiet = QuietWatch(uri, options.on_quiet)

    def hurry() -> bool:
        return isinstance(stop, Stop) and stop.in_a_hurry

    try:
        _tell_kept(options, keep_earlier_marks(out_dir))
        if options.on_graph is not None:
            options.on_graph(uri, own_host(env, uri))
        beginning.start()
        ended, told = "", 0.0
        while not ended:
            status = recorder.step()
            wall_s = time.monotonic() - began
            quiet.see(status)
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
        # What was recorded until then is a whole bag, unless that cannot be written.
        with contextlib.suppress(RunError, OSError, ValueError):
            recorder.finish()
        raise
    finally:
        quiet.close()
    status = recorder.finish()
    trace, reason = beginning.ended(hurry)
    try_dump(env, out_dir / PARAMS_FILE, hurry)
    _keep_graph(uri, out_dir)
    run = MissionRun.of(status, out_dir, ended, time.monotonic() - began)
    return _saved(run, options, trace, reason, launch_env)


class _Beginning(threading.Thread):
    """Asks for the values at the beginning, and reads the launch file, while the bag is written.

    Both may take many seconds, in which the robot goes on.
    """

    def __init__(
        self, env: Mapping[str, str], launch_env: Mapping[str, str], options: RecordOptions
    ) -> None:
        super().__init__(name="beginning", daemon=True)
        self._env, self._launch_env, self._out_dir = env, launch_env, options.out_dir
        self._launch, self._args = options.launch, options.args
        self._found: tuple[Trace | None, str] | None = None

    def run(self) -> None:
        try_dump(self._env, self._out_dir / START_FILE)
        if self._launch is not None:
            self._found = try_trace(self._launch_env, self._launch, self._args)

    def ended(self, hurry: Callable[[], bool]) -> tuple[Trace | None, str]:
        """Wait for the launch file to be read; its values, or why they are not known."""
        limit = time.monotonic() + 2 * MISSION_PATIENCE_S
        while self.is_alive() and time.monotonic() < limit and not hurry():
            self.join(_POLL_S)
        if self._launch is None:
            return None, NO_LAUNCH
        return self._found or (None, f"{self._launch} was not read in time")
