"""Commands about marks: ``mark`` and ``marks``."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from pytpc.base.errors import InputError, TpcError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, warn
from pytpc.cli.options import recording_of
from pytpc.present.as_json import mark_json
from pytpc.present.marking_terminal import (
    MarkedMission,
    Paint,
    RecordedMission,
    paint_marks,
    run_marking,
)
from pytpc.recording.marking_session import MarkChange, Session
from pytpc.recording.marks import (
    MARK_TYPES,
    Mark,
    MarkType,
    joined,
    marks_beside,
    marks_text,
    read_marks,
)
from pytpc.recording.marks_file import MarksFile
from pytpc.recording.mission import Recording
from pytpc.ros.ros1.marking import GraphMarks
from pytpc.ros.ros1.master import uri_of

_NAMESPACE = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)
"""A namespace as ROS allows it."""

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
    "-o", "--output", type=PATH, help="Write the marks to this CSV file. [default: BAG.marks.csv]"
)
def mark_command(*, bag: Path | None, observer: str, output: Path | None) -> None:
    """Mark errors of the robot by pressing a key when you see one.

    On the live graph at ROS_MASTER_URI the marks are published, too; a bag replayed with `rosbag
    play --clock` counts as live. With BAG, a clock runs through the recording instead.
    """
    check_observer(observer)
    path = marks_path(bag, observer, output)
    if bag is None:
        mission: MarkedMission = GraphMarks(uri_of(os.environ), observer)
    else:
        recording = recording_of(bag)
        mission = recorded(recording, bag)
        for note in recording.notes:
            warn(plain(note))
    mark_in_terminal(mission, observer, path)


def check_observer(observer: str) -> None:
    """Check that an observer's name is a ROS namespace.

    Raises:
        BadParameter: it is not.
    """
    if observer and not _NAMESPACE.fullmatch(observer):
        raise click.BadParameter(f"{observer!r} is not a ROS namespace", param_hint="--observer")


def marks_path(bag: Path | None, observer: str, output: Path | None) -> Path:
    """The file for the marks: the user's choice, one beside the recording, or a new one here."""
    if output is not None or bag is not None:
        return output or marks_beside(bag or Path())
    who = f"{observer.replace('/', '-')}-" if observer else ""
    return Path(time.strftime(f"marks-{who}%Y%m%d-%H%M%S.csv"))


def recorded(recording: Recording, source: Path, begin_ns: int | None = None) -> RecordedMission:
    """The clock that goes through a recording, from its begin or from a later time.

    Raises:
        InputError: it has no length.
    """
    if recording.end_ns <= recording.start_ns:
        raise InputError("the recording has no length, so no clock can run through it", source)
    start_ns = recording.start_ns if begin_ns is None else begin_ns
    return RecordedMission(plain(source.name), start_ns, recording.end_ns)


def mark_in_terminal(
    mission: MarkedMission,
    observer: str,
    path: Path,
    *,
    paint: Paint = paint_marks,
    full: bool = False,
) -> None:
    """Mark until the observer ends the session, and say where the marks are; see `run_marking`.

    Raises:
        TpcError: the file cannot be used, or there is no terminal.
    """
    try:
        file = MarksFile(path.absolute())
    except TpcError:
        mission.close()
        raise
    ours = tuple(mark for mark in file.before if mark.observer == observer)
    session = run_marking(Session(observer, ours), mission, file, paint=paint, full=full)
    warn_of_nothing = "" if path.exists() else " (no file was written)"
    click.echo(f"{many(len(session.marks), 'mark')}: {plain(str(path))}{warn_of_nothing}")


@dataclass(frozen=True)
class _MarksArguments:
    recording: Path
    add: tuple[float, str] | None
    note: str
    observer: str
    remove: int | None
    as_csv: bool
    as_json: bool


@click.command("marks")
@click.argument("recording", type=PATH)
@click.option(
    "--add",
    type=(float, click.Choice(["I", "II", "none"])),
    metavar="SECONDS TYPE",
    help="Add a mark at this time of the mission; TYPE is I, II or none.",
)
@click.option("--note", default="", metavar="TEXT", help="Note of the added mark.")
@click.option("--observer", default="", metavar="NAME", help="Observer of the added mark.")
@click.option(
    "--remove",
    type=click.IntRange(min=1),
    metavar="N",
    help="Remove the mark with this number in the list.",
)
@click.option(
    "--csv", "as_csv", is_flag=True, help="Print CSV, in the form of RECORDING.marks.csv."
)
@JSON
@as_object(_MarksArguments)
def marks_command(given: _MarksArguments) -> None:
    """List the marks of a RECORDING, or add and remove some.

    Added marks are written to RECORDING.marks.csv beside it, and only those can be removed. The
    recording itself is never changed.
    """
    recording, add, remove = given.recording, given.add, given.remove
    if add is not None and remove is not None:
        raise click.UsageError("give --add or --remove, not both")
    if add is None and (given.note or given.observer):
        raise click.UsageError("--note and --observer need --add")
    found = recording_of(recording)
    marks = found.marks
    if add is not None:
        mark = _mark_to_add(found, *add, given.observer, given.note)
        _change(recording, MarkChange(None, mark))
        marks = joined([*marks, mark])
    if remove is not None:
        gone = _mark_to_remove(recording, marks, remove)
        _change(recording, MarkChange(gone, None))
        marks = tuple(mark for mark in marks if mark != gone)
    if given.as_json:
        print_json([mark_json(mark, found.start_ns) for mark in marks])
    elif given.as_csv:
        click.echo(marks_text(marks), nl=False)
    elif marks:
        console().print(_marks_table(found, marks), highlight=False)
    else:
        click.echo("no marks")


def _mark_to_add(found: Recording, at_s: float, kind: str, observer: str, note: str) -> Mark:
    """The mark at a time of the mission.

    Raises:
        BadParameter: the time is outside of the mission.
    """
    if not 0 <= at_s <= found.seconds:
        raise click.BadParameter(
            f"{at_s:g} s is outside of the mission, which takes {found.seconds:.1f} s",
            param_hint="--add",
        )
    typed: MarkType | None = next((known for known in MARK_TYPES if known == kind), None)
    return Mark(found.start_ns + round(at_s * 1e9), typed, observer, note)


def _mark_to_remove(source: Path, marks: Sequence[Mark], number: int) -> Mark:
    """The mark with that number.

    Raises:
        BadParameter: there is no such mark.
        InputError: it is in the recording itself.
    """
    if number > len(marks):
        raise click.BadParameter(f"there are {many(len(marks), 'mark')}", param_hint="--remove")
    gone = marks[number - 1]
    beside = marks_beside(source)
    if gone not in (read_marks(beside) if beside.exists() else ()):
        raise InputError(
            f"mark {number} is in the recording itself, not in {beside.name}: it cannot be removed",
            source,
        )
    return gone


def _change(source: Path, change: MarkChange) -> None:
    """Apply a change to the file of marks beside a recording.

    Raises:
        TpcError: it cannot be read or written.
    """
    file = MarksFile(marks_beside(source).absolute())
    file.take(change)
    fault = file.flush()
    if fault:
        raise TpcError(fault, file.path)


def _marks_table(found: Recording, marks: Sequence[Mark]) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in ("#", "Seconds"):
        table.add_column(heading, justify="right")
    for heading in ("Type", "Observer", "Note"):
        table.add_column(heading, overflow="fold")
    for number, mark in enumerate(marks, start=1):
        seconds = (mark.time_ns - found.start_ns) / 1e9
        table.add_row(
            str(number),
            f"{seconds:.1f}",
            mark.type or "none",
            Text(plain(mark.observer)),
            Text(plain(mark.note)),
        )
    return table


COMMANDS: list[click.Command] = [mark_command, marks_command]
