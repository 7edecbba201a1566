"""The command ``stream``: passes on what a robot decides now."""

from __future__ import annotations

import math
import socket
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, nullcontext, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from urllib.parse import urlsplit

import click

from pytpc.api.comparing import RecordedRun
from pytpc.api.diagnosing import AskedMission
from pytpc.api.graph_feed import GraphFeed
from pytpc.api.live_diagnosis import LiveDiagnosis, asked_of_graph
from pytpc.api.live_mission import RecordedFeed, Watching, fresh_watching
from pytpc.api.streaming import DiagnosticsOutlet, Outlet, RerunOutlet, Stream
from pytpc.base.errors import InputError, RunError
from pytpc.base.signals import signals_end
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import PATH, REFERENCE, as_object
from pytpc.cli.console import warn
from pytpc.cli.lines import say
from pytpc.cli.options import (
    STATIC,
    TYPES,
    WINDOW,
    Seconds,
    check,
    good_runs,
    recording_of,
)
from pytpc.cli.running_graph import RUNNING, UsedGraph, use_graph
from pytpc.cli.sources import known_static_file, static_for
from pytpc.diagnosis.question import Question, Types
from pytpc.present.viewers.rerun_export import RerunViewer, rerun_sdk
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.ros.ros2.address import words_of
from pytpc.ros.stream_side import StreamSide
from pytpc.static.static_info import StaticInfo

_VIEWER = "127.0.0.1:9876"
_TURN_S = 0.1
_CONNECT_S = 3.0
_VERDICT_S = 30.0


@dataclass(frozen=True)
class _StreamArguments:
    recording: Path | None
    static_source: Path | None
    running_folder: Path | None
    viewer: str | None
    diagnostics: bool
    references: tuple[Path, ...]
    types: Types
    window_s: float
    seconds: float | None
    speed: float


@click.command("stream")
@click.argument("recording", type=PATH, required=False)
@click.option(
    "--rerun",
    "viewer",
    is_flag=False,
    flag_value=_VIEWER,
    metavar="[HOST:PORT]",
    help=f"Show it in a viewer of Rerun's that runs already. [default: {_VIEWER}]",
)
@click.option(
    "--diagnostics",
    is_flag=True,
    help="Publish on /diagnostics, once a second: how each node reports, and the first suspect.",
)
@STATIC
@RUNNING
@REFERENCE
@WINDOW
@TYPES
@click.option(
    "--seconds",
    type=Seconds(min=0.0, max=1e7),
    metavar="N",
    help="End after so long. [default: with Ctrl-C, or at the end of RECORDING]",
)
@click.option(
    "--speed",
    type=click.FloatRange(0.01, 1000.0),
    default=1.0,
    show_default=True,
    help="How fast the clock of RECORDING runs.",
)
@as_object(_StreamArguments)
def stream_command(given: _StreamArguments) -> None:
    """Pass on what a running robot decides, to Rerun's viewer and to /diagnostics.

    The robot is found as by `watch`, and ROS 1 need not be installed on this machine. With
    RECORDING, a clock runs through the recording instead; then only --rerun is possible. Put
    RECORDING before --rerun, or the address behind it. Marks of all observers are heard, and the
    suspects are judged by them. At most 50 evaluations of a comparison are passed on every tenth
    of a second. Ctrl-C ends it.
    """
    if given.viewer is None and not given.diagnostics:
        raise click.UsageError("give --rerun [HOST:PORT], --diagnostics or both")
    if given.recording is not None and given.diagnostics:
        raise click.UsageError(
            "--diagnostics needs a running robot; play a bag with `rosbag play` or `ros2 bag play`"
            " and leave RECORDING out, or give --rerun"
        )
    is_endless = given.recording is None and given.seconds is None
    with ExitStack() as stack, signals_end():
        stream = _opened(given, stack)
        # Where nothing else ends it, Ctrl-C is how it is ended.
        with suppress(KeyboardInterrupt) if is_endless else nullcontext():
            stream.run(given.seconds)


class _Opened:
    """A stream, and when it ends by itself.

    Args:
        stream: it.
        viewer: where it is shown, if it is.
        is_over: whether its recording has ended.
        is_alone: whether nothing is left to do without the viewer.
        begins: what is said when it begins.
    """

    def __init__(
        self,
        stream: Stream,
        viewer: RerunOutlet | None,
        is_over: Callable[[], bool],
        *,
        is_alone: bool,
        begins: str = "",
    ) -> None:
        self._begins = begins
        self._stream = stream
        self._viewer = viewer
        self._is_over = is_over
        self._is_alone = is_alone
        self._is_graph_gone = False
        self._is_told_of_viewer = False

    def run(self, seconds: float | None) -> None:
        """Pass on what comes, until it is over.

        Raises:
            RunError: the viewer is gone, and nobody else gets the stream.
        """
        if self._begins:
            say(self._begins)
        until_s = math.inf if seconds is None else time.monotonic() + seconds
        while not self._is_over() and time.monotonic() < until_s:
            time.sleep(_TURN_S)
            self._tick()
        # What came in the last moment of a recording, and the verdict by its last mark.
        self._tick()
        until_s = min(until_s, time.monotonic() + _VERDICT_S)
        while not self._stream.is_judged and time.monotonic() < until_s:
            time.sleep(_TURN_S)
            self._tick()

    def _tick(self) -> None:
        self._stream.tick()
        why = self._stream.why_gone
        if bool(why) != self._is_graph_gone:
            self._is_graph_gone = bool(why)
            warn(f"{why}; waiting for it" if why else "the robot answers again")
        if self._viewer is None or not self._viewer.is_gone or self._is_told_of_viewer:
            return
        what = "the viewer of Rerun's is gone"
        if self._is_alone:
            raise RunError(f"{what}; start one with `rerun`, and this command again")
        self._is_told_of_viewer = True
        warn(f"{what}; /diagnostics goes on")


def _opened(given: _StreamArguments, stack: ExitStack) -> _Opened:
    question = Question(given.types, given.window_s)
    if given.recording is not None:
        return _recorded(given, question, stack)
    graph = use_graph(given.running_folder)
    source = given.static_source or graph.static
    static = _with_comparisons(static_for(source), source)
    good = good_runs(given.references, static)
    file = known_static_file(source)
    shown = _connected(given.viewer)
    side = StreamSide(graph.master, publishes=given.diagnostics)
    stack.callback(side.close)
    feed = GraphFeed(graph.master, fresh_watching(static, question))
    outlets: list[Outlet] = []
    if given.diagnostics:
        outlets.append(DiagnosticsOutlet(side, feed, graph.master))
    viewer = _viewer(shown, None, outlets)
    judged = LiveDiagnosis(asked_of_graph(graph.master, static, file, question, good))
    stream = Stream(feed, side.now_ns, side.marks, judged, outlets)
    stack.callback(_close, stream, viewer)
    return _Opened(
        stream,
        viewer,
        lambda: False,
        is_alone=not given.diagnostics,
        begins=_begins(given, graph),
    )


def _recorded(given: _StreamArguments, question: Question, stack: ExitStack) -> _Opened:
    assert given.recording is not None
    recording = recording_of(given.recording)
    static = static_for(given.static_source, given.recording, recording)
    check(recording, _with_comparisons(static, given.static_source), given.recording)
    good = good_runs(given.references, static)
    shown = _connected(given.viewer)
    run = RecordedRun(recording, given.recording)

    def ask(mission: Recording) -> AskedMission:
        return AskedMission.of(RecordedRun(mission, run.source), static, question, good)

    fresh: Watching = fresh_watching(static, question)
    outlets: list[Outlet] = []
    viewer = _viewer(shown, recording.end_ns, outlets)
    played = _Played(recording, given.speed)
    # The marks come as their times do.
    judged = LiveDiagnosis(ask, replace(recording, marks=()))
    feed = RecordedFeed(recording, fresh)
    stream = Stream(feed, played.now_ns, played.marks, judged, outlets)
    stack.callback(_close, stream, viewer)
    return _Opened(stream, viewer, played.is_over, is_alone=True)


class _Played:
    """The clock of a recording, and its marks up to now."""

    def __init__(self, recording: Recording, speed: float) -> None:
        self._recording = recording
        self._speed = speed
        self._began_s = time.monotonic()

    def now_ns(self) -> int:
        passed_ns = round((time.monotonic() - self._began_s) * self._speed * 1e9)
        return min(self._recording.start_ns + passed_ns, self._recording.end_ns)

    def marks(self) -> tuple[Mark, ...]:
        now_ns = self.now_ns()
        return tuple(mark for mark in self._recording.marks if mark.time_ns <= now_ns)

    def is_over(self) -> bool:
        return self.now_ns() >= self._recording.end_ns


def _with_comparisons(static: StaticInfo, source: Path | None) -> StaticInfo:
    if not static.thresholds:
        raise InputError("the static information has no comparison with a parameter", source)
    return static


def _connected(address: str | None) -> tuple[str, int] | None:
    """Host and port of a viewer that answers; None if there is no address.

    Raises:
        UsageError: it is no address.
        RunError: nobody answers there.
        MissingToolError: Rerun is not installed.
    """
    if address is None:
        return None
    rerun_sdk()
    try:
        found = urlsplit(f"//{address.removeprefix('rerun+http://').removesuffix('/proxy')}")
        host, port = found.hostname, found.port
    except ValueError:
        host, port = None, None
    if not host or port is None:
        hint = "; put RECORDING before --rerun" if Path(address).exists() else ""
        raise click.UsageError(f"--rerun takes HOST:PORT, as {_VIEWER}, not {address}{hint}")
    try:
        socket.create_connection((host, port), _CONNECT_S).close()
    except OSError as error:
        raise RunError(
            f"no viewer of Rerun's answers at {host}:{port} ({error.strerror or error}); start one"
            f" with: rerun --port {port}"
        ) from error
    return host, port


def _viewer(
    shown: tuple[str, int] | None, end_ns: int | None, outlets: list[Outlet]
) -> RerunOutlet | None:
    if shown is None:
        return None
    rr = rerun_sdk()
    viewer = RerunViewer(rr, end_ns)
    host, port = shown
    at = f"[{host}]" if ":" in host else host
    viewer.stream.connect_grpc(f"rerun+http://{at}:{port}/proxy")
    found = RerunOutlet(viewer, rr)
    outlets.append(found)
    return found


def _begins(given: _StreamArguments, graph: UsedGraph) -> str:
    where: Sequence[str] = [
        *(["/diagnostics"] if given.diagnostics else []),
        *([f"Rerun at {given.viewer}"] if given.viewer is not None else []),
    ]
    return (
        f"pytpc: streaming from {plain(words_of(graph.master))} to {plain(' and '.join(where))};"
        " Ctrl-C ends it"
    )


def _close(stream: Stream, viewer: RerunOutlet | None) -> None:
    stream.close()
    left_out = "" if viewer is None or not viewer.left_out else f", {viewer.left_out:,} not shown"
    say(f"pytpc: passed on {many(stream.evaluations, 'evaluation')}{left_out}")


COMMANDS: list[click.Command] = [stream_command]
