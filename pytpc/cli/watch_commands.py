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
from pytpc.cli.arguments import as_object
from pytpc.cli.console import warn
from pytpc.cli.mark_commands import (
    OBSERVER,
    check_observer,
    mark_in_terminal,
    marks_path,
    recorded,
)
from pytpc.cli.options import (
    JSON,
    PATH,
    STATIC,
    TYPES,
    WINDOW,
    check,
    recording_of,
)
from pytpc.cli.sources import static_of
from pytpc.diagnosis.question import Question, Types
from pytpc.diagnosis.results.live import LiveRow, Look
from pytpc.present.marking_terminal import MarkedMission
from pytpc.present.watch_screen import LAYOUTS, Status, WatchOptions, table
from pytpc.recording.marking_session import clock_text
from pytpc.recording.mission import Recording
from pytpc.ros.ros1.marking import GraphMarks
from pytpc.ros.ros1.master import uri_of
from pytpc.static.static_info import StaticInfo

_ONCE_S = 5.0
_TURN_S = 0.1


@dataclass(frozen=True)
class _WatchArguments:
    recording: Path | None
    static_source: Path
    observer: str
    output: Path | None
    window_s: float
    top: int
    types: Types
    once: bool
    seconds: float | None
    as_json: bool


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
    """What is marked and what is watched."""
    if recording is None:
        master = uri_of(os.environ)
        return GraphMarks(master, observer, what="watching"), GraphFeed(master, fresh)
    found = _read(recording, fresh.static_info)
    return recorded(found, recording), RecordedFeed(found, fresh)


def _read(source: Path, static: StaticInfo) -> Recording:
    """A recording, with what is wrong with it said."""
    recording = recording_of(source)
    check(recording, static, source)
    return recording


def _once(
    recording: Path | None,
    fresh: Watching,
    options: WatchOptions,
    seconds: float | None,
    *,
    as_json: bool,
) -> None:
    """Listen for a while, or go to a place in the recording; then print what is known."""
    if recording is not None:
        found = _read(recording, fresh.static_info)
        far = round(seconds * 1e9) if seconds is not None else found.end_ns - found.start_ns
        now_ns = min(found.end_ns, found.start_ns + far)
        feed: Feed = RecordedFeed(found, fresh)
        watched = WatchedMission(_Still(recorded(found, recording), now_ns), feed, options)
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
        document = _json_of(look, status, now_ns - start_ns if recording is not None else None)
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


class _Still:
    """A recording whose clock stands."""

    def __init__(self, mission: MarkedMission, now_ns: int) -> None:
        self._now_ns = now_ns
        self.press, self.view = mission.press, mission.view
        self.send, self.tick, self.close = mission.send, mission.tick, mission.close

    def now_ns(self) -> int | None:
        return self._now_ns


def _json_of(look: Look, status: Status, into_ns: int | None) -> dict[str, object]:
    return {
        "time_ns": look.now_ns,
        "seconds": None if into_ns is None else into_ns / 1e9,
        "reports": status.reports,
        "nodes": status.nodes,
        "unknown_keys": status.unknown,
        "lost": status.lost,
        "fault": status.fault,
        "parameters": look.parameters,
        "rankings": {
            kind or "combined": {
                "reason": look.reasons[kind],
                "suspects": [_suspect(row) for row in rows],
            }
            for kind, rows in look.rows.items()
        },
    }


def _suspect(row: LiveRow) -> dict[str, object]:
    suspect, last = row.suspect, row.last
    found = suspect.comparison
    return {
        "position": suspect.position,
        "tied": suspect.tied,
        "parameter": suspect.parameter,
        "key": suspect.key,
        "score": suspect.score,
        "score_type": suspect.type,
        "rank": suspect.rank,
        "rank1": suspect.rank1,
        "rank2": suspect.rank2,
        "cmp": None if last is None else _finite(last.cmp),
        "relation": found.relation,
        "thresh": None if last is None else _finite(last.thresh),
        "result": None if last is None else last.result,
        "node": None if last is None else last.node,
        "seconds_since_flop": row.flop_s,
        "topic": found.topic,
        "file": found.file,
        "lineno": found.lineno,
    }


def _finite(value: float) -> float | None:
    """JSON has neither NaN nor infinity."""
    return value if abs(value) < float("inf") else None


COMMANDS: list[click.Command] = [watch_command]
