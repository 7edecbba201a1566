"""Commands about marking: ``mark``, and what ``watch`` and ``run`` share with it."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.comparing import diff, diff_running
from pytpc.base.errors import InputError, TpcError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import PATH, REFERENCE
from pytpc.cli.console import warn
from pytpc.cli.lines import say
from pytpc.cli.options import recording_of
from pytpc.cli.running_graph import RUNNING, UsedGraph, use_graph
from pytpc.present.marking_terminal import (
    MARKS_SHOWN,
    MarkedMission,
    RecordedMission,
    Showing,
    run_marking,
)
from pytpc.recording.graph_places import Place, recorded_places
from pytpc.recording.marking_session import Session
from pytpc.recording.marks import is_observer
from pytpc.recording.marks_file import MarksFile
from pytpc.recording.marks_home import MarksHome, marks_home
from pytpc.recording.mission import Recording
from pytpc.ros.graphs import marks_at
from pytpc.static.static_info import StaticInfo

_DIFFERENCES = 12

OBSERVER = click.option(
    "--observer",
    default="",
    metavar="NAME",
    help="Name of the observer, used as a topic namespace.",
)


@click.command("mark")
@click.argument("bag", type=PATH, required=False)
@OBSERVER
@click.option(
    "-o",
    "--output",
    type=PATH,
    help="Write the marks to this CSV file. [default: where they are read with BAG, or with the"
    " recording that runs]",
)
@RUNNING
@REFERENCE
def mark_command(
    *,
    bag: Path | None,
    observer: str,
    output: Path | None,
    running_folder: Path | None,
    references: tuple[Path, ...],
) -> None:
    """Mark errors of the robot by pressing a key when you see one.

    A recording of `record` that runs on this machine is found by itself, and gets the marks.
    Otherwise they are published on the graph at ROS_MASTER_URI, or that of ROS 2 in ROS_DOMAIN_ID;
    a bag replayed with `rosbag play --clock` counts as live. With BAG, a clock runs through the
    recording instead.
    """
    check_observer(observer)
    graph = graph_to_mark(bag, running_folder)
    target = marks_target(bag, observer, output, graph)
    if graph is not None:
        mission: MarkedMission = marks_at(graph.master, observer)
    else:
        assert bag is not None
        recording = recording_of(bag)
        mission = recorded(recording, bag)
        for note in recording.notes:
            warn(plain(note))
    for line in _differing(bag, graph, references):
        say(plain(line))
    mark_in_terminal(mission, observer, target)
    tell_where(graph)


def _differing(bag: Path | None, graph: UsedGraph | None, references: Sequence[Path]) -> list[str]:
    """A line for each parameter that differs from the good runs."""
    if not references:
        return []
    if graph is not None:
        found = diff_running(references, graph.master)
    else:
        assert bag is not None
        found = diff(references, bag, StaticInfo.of([]))
    if not (found.found or found.is_complete):
        # Without the static information nothing else could be compared.
        return list(found.notes)
    shown = [f"  {one.change}" for one in found.found[:_DIFFERENCES]]
    if len(found.found) > _DIFFERENCES:
        shown.append(f"  and {len(found.found) - _DIFFERENCES:,} more")
    return [found.title, *shown, *found.notes]


def graph_to_mark(recording: Path | None, running_folder: Path | None) -> UsedGraph | None:
    """The graph whose mission is marked; None for a recording that has ended.

    Raises:
        UsageError: both are given.
        RunError: several recordings run, and none is named.
    """
    if recording is None:
        return use_graph(running_folder)
    if running_folder is not None:
        raise click.UsageError("--recording is for a recording that runs")
    return None


def tell_where(graph: UsedGraph | None) -> None:
    """Say that the marks are in the recording that runs."""
    if graph is not None and graph.recording is not None:
        click.echo(f"they are read with the recording {plain(graph.recording.folder)}")


def check_observer(observer: str) -> None:
    """Check that an observer's name is a ROS namespace.

    Raises:
        BadParameter: it is not.
    """
    if observer and not is_observer(observer):
        raise click.BadParameter(f"{observer!r} is not a ROS namespace", param_hint="--observer")


@dataclass(frozen=True)
class MarksTarget:
    """Where a session on a recording, or on a graph (None), writes its marks."""

    home: MarksHome
    shown: Path
    recording: Path | None

    def how_to_read(self, *, is_heard: bool) -> str:
        """What to tell about marks that no command reads by itself; else nothing.

        ``is_heard``: whether somebody on the graph got all of them.
        """
        if self.recording is not None and marks_home(self.recording).has(self.home.file):
            return ""
        named = "RECORDING" if self.recording is None else plain(str(self.recording))
        how = f"pytpc rank {named} --marks {plain(str(self.shown))}"
        if self.recording is None and not is_heard:
            return f"no recorder on this graph got all of them; to add them to a recording: {how}"
        if self.recording is None:
            return f"a recording of this graph has them; to add them to another one: {how}"
        return f"to rank by them: {how}"


def marks_target(
    bag: Path | None, observer: str, output: Path | None, graph: UsedGraph | None = None
) -> MarksTarget:
    """The user's choice of a file, or where the marks of a recording are, or a new file here."""
    recording = bag
    if graph is not None and graph.recording is not None:
        recording = Path(graph.recording.folder)
    if recording is not None and output is None:
        home = marks_home(recording)
        return MarksTarget(home, _shortest(home.file), recording)
    path = output or _new_file(observer)
    return MarksTarget(MarksHome(path.absolute()), path, recording)


def _new_file(observer: str) -> Path:
    who = f"{observer.replace('/', '-')}-" if observer else ""
    return Path(time.strftime(f"marks-{who}%Y%m%d-%H%M%S.csv"))


def _shortest(path: Path) -> Path:
    """The path as seen from here, if it is in or below this folder."""
    here = Path(os.path.realpath("."))
    return path.relative_to(here) if path.is_relative_to(here) else path


def recorded(recording: Recording, source: Path, begin_ns: int | None = None) -> RecordedMission:
    """The clock that goes through a recording, from its begin or from a later time.

    Where its graph was recorded, too, the observer chooses from the places of that.

    Raises:
        InputError: it has no length.
    """
    if recording.end_ns <= recording.start_ns:
        raise InputError("the recording has no length, so no clock can run through it", source)
    start_ns = recording.start_ns if begin_ns is None else begin_ns
    places: tuple[Place, ...] = ()
    try:
        places = recorded_places(marks_home(source).file.parent)
    except InputError as error:
        warn(plain(str(error)))
    return RecordedMission(plain(source.name), start_ns, recording.end_ns, places)


def mark_in_terminal(
    mission: MarkedMission,
    observer: str,
    target: MarksTarget,
    how: Showing = MARKS_SHOWN,
) -> None:
    """Mark until the observer ends the session, and say where the marks are; see `run_marking`.

    Raises:
        TpcError: the file cannot be used, or there is no terminal.
    """
    try:
        file = MarksFile(target.home)
    except TpcError:
        mission.close()
        raise
    ours = tuple(mark for mark in file.before if mark.observer == observer)
    session = run_marking(Session(observer, ours), mission, file, how)
    if not (session.marks or ours or file.path.exists()):
        click.echo("nothing was marked")
        return
    click.echo(f"{many(len(session.marks), 'mark')}: {plain(str(target.shown))}")
    if session.marks and (how_to_read := target.how_to_read(is_heard=not mission.unheard())):
        click.echo(how_to_read)


COMMANDS: list[click.Command] = [mark_command]
