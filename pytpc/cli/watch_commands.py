"""Commands about what runs: ``watch``."""

from __future__ import annotations

import json
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import click
from rich.console import Console

from pytpc.api.live_mission import (
    KINDS,
    Feed,
    GraphFeed,
    RecordedFeed,
    WatchedMission,
    Watching,
    fresh_watching,
)
from pytpc.base.errors import InputError, RunError
from pytpc.base.signals import signals_end
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import warn
from pytpc.cli.mark_commands import (
    OBSERVER,
    check_observer,
    mark_in_terminal,
    marks_path,
    recorded,
)
from pytpc.cli.options import (
    STATIC,
    TYPES,
    WINDOW,
    AskArguments,
    checked_recording,
)
from pytpc.cli.sources import static_of
from pytpc.diagnosis.question import Question
from pytpc.present.as_json import look_json
from pytpc.present.marking_terminal import MarkedMission
from pytpc.present.watch_screen import LAYOUTS, WatchOptions, table
from pytpc.recording.marking_session import clock_text
from pytpc.ros.ros1.marking import GraphMarks
from pytpc.ros.ros1.master import uri_of

_ONCE_S = 5.0
_TURN_S = 0.1


@dataclass(frozen=True)
class _WatchArguments(AskArguments):
    recording: Path | None
    observer: str
    output: Path | None
    once: bool
    seconds: float | None


@click.command("watch")
@click.argument("recording", type=PATH, required=False)
@STATIC
@OBSERVER
@click.option("-o", "--output", type=PATH, help="Write the marks to this CSV file, as `mark` does.")
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
    help="With --once: listen this long (5), or go this far into RECORDING (to its end).",
)
@JSON
@as_object(_WatchArguments)
def watch_command(given: _WatchArguments) -> None:
    """Show the suspected parameters while the robot runs, and mark.

    The reports come from the graph at ROS_MASTER_URI; ROS need not be installed on this machine.
    With RECORDING, a clock runs through the recording instead. The keys are those of `mark`, and
    the ranking at each mark is kept. Use `rank` afterwards to judge by all marks together. --json
    prints what --once shows, for programs.
    """
    check_observer(given.observer)
    static = static_of([given.static_source])
    if not static.thresholds:
        raise InputError("it has no comparison with a parameter", given.static_source)
    fresh = fresh_watching(static, Question(given.types, given.window_s))
    layout = (None,) if given.types == "ignore" else LAYOUTS[0]
    options = WatchOptions(layout=layout, top=given.top)
    if given.once or given.as_json:
        _once(given.recording, fresh, options, given.seconds, as_json=given.as_json)
        return
    if not sys.stdin.isatty():
        raise RunError("standard input is not a terminal, so no keys can be read; see --once")
    path = marks_path(given.recording, given.observer, given.output)
    mission, feed = _opened(given.recording, given.observer, fresh)
    watched = WatchedMission(mission, feed, options, believe=given.types != "ignore")
    mark_in_terminal(watched, given.observer, path, paint=watched.paint, full=True)


def _opened(recording: Path | None, observer: str, fresh: Watching) -> tuple[MarkedMission, Feed]:
    """The mission to mark, and the feed to watch."""
    if recording is None:
        master = uri_of(os.environ)
        return GraphMarks(master, observer, what="watching"), GraphFeed(master, fresh)
    found = checked_recording(recording, fresh.static_info)
    return recorded(found, recording), RecordedFeed(found, fresh)


def _once(
    recording: Path | None,
    fresh: Watching,
    options: WatchOptions,
    seconds: float | None,
    *,
    as_json: bool,
) -> None:
    """Listen for a while, or go to a time in the recording; then print the tables."""
    if recording is not None:
        found = checked_recording(recording, fresh.static_info)
        far = round(seconds * 1e9) if seconds is not None else found.end_ns - found.start_ns
        now_ns = min(found.end_ns, found.start_ns + far)
        feed: Feed = RecordedFeed(found, fresh)
        watched = WatchedMission(recorded(found, recording, now_ns), feed, options)
        watched.take()
        start_ns = found.start_ns
    else:
        mission, feed = _opened(None, "", fresh)
        watched = WatchedMission(mission, feed, options)
        _listen(watched, _ONCE_S if seconds is None else seconds)
        now_ns = watched.now_ns() or 0
        start_ns = 0
    look = watched.watching.look(now_ns, options.top, KINDS)
    status = watched.status()
    watched.close()
    if recording is None and not status.reports:
        if status.fault:
            raise RunError(status.fault)
        warn("no reports arrived: is a node that was built with TPC running?")
    if as_json:
        document = look_json(look, status, now_ns - start_ns if recording is not None else None)
        click.echo(json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False))
        return
    console = Console(width=None if sys.stdout.isatty() else 120)
    when = f"at {clock_text(now_ns - start_ns)}: " if recording is not None else ""
    console.print(f"{when}{status.words()}", highlight=False, markup=False)
    utf8 = console.encoding.startswith("utf")
    for kind in options.layout:
        console.print()
        for line in table(look, kind, console.width, options.top, utf8=utf8):
            console.print(line, highlight=False, soft_wrap=True)


def _listen(watched: WatchedMission, seconds: float) -> None:
    until = time.monotonic() + seconds
    try:
        with signals_end():
            watched.status()
            while time.monotonic() < until:
                time.sleep(_TURN_S)
                watched.tick()
    except BaseException:
        watched.close()
        raise


COMMANDS: list[click.Command] = [watch_command]
