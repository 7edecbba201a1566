"""Commands about marks that were made: ``marks``."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from pytpc.base.errors import InputError, TpcError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, tell_person
from pytpc.cli.options import MARKS, recording_of
from pytpc.present.as_json import mark_json
from pytpc.recording.marking_session import MarkChange
from pytpc.recording.marks import (
    LONGEST_NOTE,
    MARK_TYPES,
    MOST_PLACES,
    Mark,
    MarkType,
    is_place,
    joined,
    marks_text,
    parse_began,
    short_note,
    with_began,
    with_where,
)
from pytpc.recording.marks_file import END_PATIENCE_S, MarksFile
from pytpc.recording.marks_home import marks_home
from pytpc.recording.mission import Recording, is_converted


@dataclass(frozen=True)
class _MarksArguments:
    recording: Path
    add: tuple[float, str] | None
    note: str
    observer: str
    where: tuple[str, ...]
    began: str
    remove: int | None
    as_csv: bool
    marks_files: tuple[Path, ...]
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
    "--where",
    multiple=True,
    metavar="NAME",
    help="Topic, service, action, node or frame of the added mark; may be repeated.",
)
@click.option(
    "--began",
    default="",
    metavar="SECONDS",
    help="When the error of the added mark began, in seconds of the mission: 40, or 40..50.",
)
@click.option(
    "--remove",
    type=click.IntRange(min=1),
    metavar="N",
    help="Remove the mark with this number in the list.",
)
@click.option("--csv", "as_csv", is_flag=True, help="Print CSV, in the form of the file of marks.")
@MARKS
@JSON
@as_object(_MarksArguments)
def marks_command(given: _MarksArguments) -> None:
    """List the marks of a RECORDING, or add and remove some.

    Added marks are written to marks.csv in the folder of the mission, or to RECORDING.marks.csv
    beside a single file. Only marks in such files can be removed: the recording itself is never
    changed. A copy that `convert` made has marks of its own: convert again to have later ones.
    """
    recording, add, remove = given.recording, given.add, given.remove
    if add is not None and remove is not None:
        raise click.UsageError("give --add or --remove, not both")
    if add is None and (given.note or given.observer or given.where or given.began):
        raise click.UsageError("--note, --observer, --where and --began need --add")
    note = _note_with(given.where, given.note)
    found = recording_of(recording, given.marks_files)
    marks = found.marks
    if add is not None:
        note = _note_since(given.began, add[0], note)
        mark = _mark_to_add(found, *add, given.observer, note)
        _change(MarksFile(marks_home(recording)), MarkChange(None, mark))
        marks = joined([*marks, mark])
        if not is_converted(recording):
            tell_person(
                "a copy that `pytpc convert` made before does not have this mark: add it to the"
                " copy, too, or convert again"
            )
    if remove is not None:
        file = MarksFile(marks_home(recording))
        gone = _mark_to_remove(file, recording, marks, remove)
        _change(file, MarkChange(gone, None))
        marks = tuple(mark for mark in marks if mark != gone)
    if given.as_json:
        print_json([mark_json(mark, found.start_ns) for mark in marks])
    elif given.as_csv:
        click.echo(marks_text(marks).encode("utf-8", "backslashreplace"), nl=False)
    elif marks:
        console().print(_marks_table(found, marks), highlight=False)
    else:
        click.echo("no marks")


def _note_with(where: Sequence[str], note: str) -> str:
    """The note of a mark that is added, with the places that are given and its own.

    Raises:
        BadParameter: one is no ROS name, or they are too many.
    """
    names = [name.removeprefix("@") for name in where]
    for name in names:
        if not is_place(name):
            raise click.BadParameter(f"{name!r} is not a ROS name", param_hint="--where")
    every = dict.fromkeys([*names, *Mark(0, None, "", note).where])
    noted = with_where(note, every) if names else note
    if names and len(Mark(0, None, "", noted).where) < len(every):
        raise click.BadParameter(
            f"a note has at most {MOST_PLACES} places, and {LONGEST_NOTE} characters",
            param_hint="--where",
        )
    return noted


def _note_since(began: str, at_s: float, note: str) -> str:
    """The note that says when the error of a mark at this time began.

    Raises:
        BadParameter: it is no time of the mission up to the mark.
    """
    if not began:
        return note
    try:
        late, early = parse_began(began)
    except ValueError:
        what = f"{began!r} is not like 40..50, or 40"
        raise click.BadParameter(what, param_hint="--began") from None
    if late > at_s:
        what = f"{late:g} s is after the mark at {at_s:g} s"
        raise click.BadParameter(what, param_hint="--began")
    return with_began(note, at_s - early, at_s - late)


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
    return Mark(found.start_ns + round(at_s * 1e9), typed, observer, short_note(note))


def _mark_to_remove(file: MarksFile, source: Path, marks: Sequence[Mark], number: int) -> Mark:
    """The mark with that number.

    Raises:
        BadParameter: there is no such mark.
        InputError: it is in the recording itself.
    """
    if number > len(marks):
        there = f"there are {many(len(marks), 'mark')}"
        see = f"`pytpc marks {shlex.quote(str(source))}` lists them"
        raise click.BadParameter(f"{there}; {see}", param_hint="--remove")
    gone = marks[number - 1]
    if not file.holds(gone):
        raise InputError(
            f"mark {number} is in the recording itself, not in a file of marks: it cannot be"
            " removed",
            source,
        )
    return gone


def _change(file: MarksFile, change: MarkChange) -> None:
    """Apply a change to the files of marks of a recording.

    Raises:
        TpcError: one cannot be read or written.
    """
    file.take(change)
    fault = file.flush(END_PATIENCE_S)
    if fault:
        raise TpcError(fault, file.path)


def _marks_table(found: Recording, marks: Sequence[Mark]) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in ("#", "Seconds"):
        table.add_column(heading, justify="right")
    has_places = any(mark.where for mark in marks)
    has_begun = any(mark.began for mark in marks)
    more = [*(["Began"] if has_begun else []), *(["Where"] if has_places else [])]
    for heading in ("Type", "Observer", *more, "Note"):
        table.add_column(heading, overflow="fold")
    for number, mark in enumerate(marks, start=1):
        seconds = (mark.time_ns - found.start_ns) / 1e9
        table.add_row(
            str(number),
            f"{seconds:.1f}",
            mark.type or "none",
            Text(plain(mark.observer)),
            *([_began(mark, seconds)] if has_begun else []),
            *([Text(", ".join(mark.where))] if has_places else []),
            Text(plain(short_note(mark.remark))),
        )
    return table


COMMANDS: list[click.Command] = [marks_command]


def _began(mark: Mark, seconds: float) -> str:
    """``40.0 - 50.0``: from when to when its error began, in seconds of the mission."""
    if mark.began is None:
        return ""
    early, late = (f"{seconds - ago:.1f}" for ago in mark.began)
    return early if early == late else f"{early} - {late}"
