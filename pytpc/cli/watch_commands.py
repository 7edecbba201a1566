"""Commands about what runs: ``watch``."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import click
from rich.console import Console

from pytpc.api.comparing import RecordedRun, diff_running
from pytpc.api.diagnosing import AskedMission
from pytpc.api.graph_feed import GraphFeed
from pytpc.api.live_diagnosis import LiveDiagnosis, asked_of_graph
from pytpc.api.live_mission import (
    KINDS,
    Feed,
    RecordedFeed,
    WatchedMission,
    Watching,
    fresh_watching,
)
from pytpc.base.errors import InputError, RunError
from pytpc.base.signals import signals_end
from pytpc.base.wording import plain
from pytpc.cli.arguments import JSON, PATH, REFERENCE, as_object
from pytpc.cli.console import print_json, telling, warn
from pytpc.cli.mark_commands import (
    OBSERVER,
    check_observer,
    graph_to_mark,
    mark_in_terminal,
    marks_target,
    recorded,
    tell_where,
)
from pytpc.cli.options import (
    STATIC,
    TYPES,
    WINDOW,
    AskArguments,
    check,
    good_runs,
    recording_of,
    refuse_itself,
)
from pytpc.cli.running_graph import RUNNING, UsedGraph
from pytpc.cli.sources import known_static_file, static_for
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.differences import RunDifferences
from pytpc.present.as_json import diagnosis_json, look_json
from pytpc.present.marking_terminal import MarkedMission, Showing
from pytpc.present.watch_screen import LAYOUTS, WatchOptions, table
from pytpc.recording.marking_session import clock_text
from pytpc.recording.mission import Recording
from pytpc.ros.graphs import marks_at
from pytpc.ros.ros2.address import words_of
from pytpc.static.static_info import StaticInfo

_ONCE_S = 5.0
_TURN_S = 0.1


@dataclass(frozen=True)
class _WatchArguments(AskArguments):
    recording: Path | None
    running_folder: Path | None
    observer: str
    output: Path | None
    once: bool
    seconds: float | None
    references: tuple[Path, ...]


@click.command("watch")
@click.argument("recording", type=PATH, required=False)
@STATIC
@RUNNING
@OBSERVER
@click.option("-o", "--output", type=PATH, help="Write the marks to this CSV file, as `mark` does.")
@REFERENCE
@WINDOW
@click.option(
    "--top",
    type=click.IntRange(min=1),
    default=10,
    show_default=True,
    metavar="N",
    help="Show this many suspects, if there is room.",
)
@TYPES
@click.option("--once", is_flag=True, help="Print one table without reading keys, and exit.")
@click.option(
    "--seconds",
    type=click.FloatRange(min=0.0, max=86400.0),
    metavar="N",
    help="With --once: listen this long (5) from the first report on, or go this far into RECORDING"
    " (to its end).",
)
@JSON
@as_object(_WatchArguments)
def watch_command(given: _WatchArguments) -> None:
    """Show the suspected parameters while the robot runs, and mark.

    A recording of `record` that runs on this machine is found by itself. Otherwise, the reports
    come from the graph at ROS_MASTER_URI, for which ROS need not be installed on this machine, or
    from that of ROS 2 in ROS_DOMAIN_ID. With RECORDING, a clock runs through the recording instead.
    The keys are those of `mark`, and the ranking at each mark is kept. Use `rank` afterwards to
    judge by all marks together. --json prints what --once shows, for programs.
    """
    check_observer(given.observer)
    graph = graph_to_mark(given.recording, given.running_folder)
    run = None
    if given.recording is not None:
        run = RecordedRun(recording_of(given.recording), given.recording)
    static = static_to_watch(given.static_source, given.recording, graph, run)
    question = Question(given.types, given.window_s)
    fresh = fresh_watching(static, question)
    layout = (None,) if given.types == "ignore" else LAYOUTS[0]
    options = WatchOptions(layout=layout, top=given.top)
    good = good_runs(given.references, static)
    if run is not None:
        refuse_itself(good, run.recording)
    if given.once or given.as_json:
        _once((graph, run), fresh, options, good, given)
        return
    if not sys.stdin.isatty():
        raise RunError("standard input is not a terminal, so no keys can be read; see --once")
    target = marks_target(given.recording, given.observer, given.output, graph)
    if graph is not None:
        mission: MarkedMission
        feed: Feed
        mission, feed = opened_graph(graph.master, given.observer, fresh)
    else:
        mission, feed = _opened(run, fresh)
    judged = judged_by((graph, run), static, given.static_source, question, good) if good else None
    believe = given.types != "ignore"
    watched = WatchedMission(mission, feed, options, believe=believe, judged=judged)
    mark_in_terminal(watched, given.observer, target, Showing(watched.paint, full=True))
    tell_where(graph)


def static_to_watch(
    given: Path | None, recording: Path | None, graph: UsedGraph | None, run: RecordedRun | None
) -> StaticInfo:
    """The static information that is given, or that of the recording, running or not.

    Raises:
        InputError: there is none, or it has no comparison with a parameter.
    """
    source = given or (None if graph is None else graph.static)
    static = static_for(source, recording, None if run is None else run.recording)
    if not static.thresholds:
        raise InputError("the static information has no comparison with a parameter", source)
    if run is not None and recording is not None:
        check(run.recording, static, recording)
    return static


def opened_graph(master: str, observer: str, fresh: Watching) -> tuple[MarkedMission, GraphFeed]:
    """The graph to mark, and its feed to watch."""
    return marks_at(master, observer, "watching", advertise=False), GraphFeed(master, fresh)


def _opened(run: RecordedRun | None, fresh: Watching) -> tuple[MarkedMission, Feed]:
    """The recording to mark, and its feed to watch."""
    assert run is not None
    assert run.source is not None
    return recorded(run.recording, run.source), RecordedFeed(run.recording, fresh)


def judged_by(
    watched_run: tuple[UsedGraph | None, RecordedRun | None],
    static: StaticInfo,
    static_source: Path | None,
    question: Question,
    good: Sequence[RecordedRun],
) -> LiveDiagnosis:
    """The diagnosis beside good runs, of the recording or of the robot that runs."""
    graph, run = watched_run
    if run is not None:

        def ask(mission: Recording) -> AskedMission:
            return AskedMission.of(replace(run, recording=mission), static, question, good)

        return LiveDiagnosis(ask, run.recording)
    assert graph is not None
    file = known_static_file(static_source or graph.static)
    return LiveDiagnosis(asked_of_graph(graph.master, static, file, question, good))


def _once(
    watched_run: tuple[UsedGraph | None, RecordedRun | None],
    fresh: Watching,
    options: WatchOptions,
    good: Sequence[RecordedRun],
    given: _WatchArguments,
) -> None:
    """Listen for a while, or go to a time in the recording; then print the tables.

    By the marks of a recording up to that time, the diagnosis comes first.
    """
    graph, run = watched_run
    seconds = given.seconds
    found_so_far: Diagnosis | None = None
    differing: RunDifferences | None = None
    if run is not None and run.source is not None:
        found = run.recording
        far = round(seconds * 1e9) if seconds is not None else found.end_ns - found.start_ns
        now_ns = min(found.end_ns, found.start_ns + far)
        feed: Feed = RecordedFeed(found, fresh)
        watched = WatchedMission(recorded(found, run.source, now_ns), feed, options)
        watched.take()
        start_ns = found.start_ns
        past = tuple(mark for mark in found.marks if mark.time_ns <= now_ns)
        so_far = RecordedRun(replace(found, marks=past), run.source)
        question = Question(given.types, given.window_s)
        asked = AskedMission.of(so_far, fresh.static_info, question, good)
        differing = asked.question.differences
        found_so_far = asked.diagnosis if past else None
    else:
        assert graph is not None
        differing = diff_running(good, graph.master, fresh.static_info) if good else None
        watched = _listened(graph.master, fresh, options, _ONCE_S if seconds is None else seconds)
        now_ns = watched.now_ns() or 0
        start_ns = 0
    if differing is not None:
        watched.watching.differing = frozenset(one.parameter for one in differing.found)
    look = watched.watching.look(now_ns, options.top, KINDS)
    status = watched.status()
    watched.close()
    if run is None and not status.evaluations:
        if status.fault:
            raise RunError(status.fault)
        warn("no reports arrived: is a node that was built with TPC running?")
    if given.as_json:
        document = look_json(look, status, now_ns - start_ns if run is not None else None)
        document["diagnosis"] = None if found_so_far is None else diagnosis_json(found_so_far)
        print_json(document)
        return
    console = Console(width=None if sys.stdout.isatty() else 120)
    when = f"at {clock_text(now_ns - start_ns)}: " if run is not None else ""
    console.print(f"{when}{status.words()}", highlight=False, markup=False)
    if differing is not None:
        console.print(plain(differing.line or differing.title), highlight=False, markup=False)
    if found_so_far is not None:
        console.print(plain(f"{found_so_far.blame.title}: {found_so_far.headline}"), markup=False)
    utf8 = console.encoding.startswith("utf")
    for kind in options.layout:
        console.print()
        for row in table(look, kind, console.width, options.top, utf8=utf8):
            console.print(row, highlight=False, soft_wrap=True)


def _listened(
    master: str, fresh: Watching, options: WatchOptions, seconds: float
) -> WatchedMission:
    """The graph after so many seconds, which begin when the nodes that report are found."""
    mission, feed = opened_graph(master, "", fresh)
    watched = WatchedMission(mission, feed, options)
    with telling(f"looking for nodes that report: {words_of(master)}"):
        _take(watched, lambda: feed.is_settled)
    until = time.monotonic() + seconds
    _take(watched, lambda: time.monotonic() >= until)
    return watched


def _take(watched: WatchedMission, is_enough: Callable[[], bool]) -> None:
    """Take in what arrives, until it is enough."""
    try:
        with signals_end():
            watched.status()
            while not is_enough():
                time.sleep(_TURN_S)
                watched.tick()
    except BaseException:
        watched.close()
        raise


COMMANDS: list[click.Command] = [watch_command]
