"""Commands about marks: ``mark``."""

from __future__ import annotations

import os
import re
import time
from pathlib import Path

import click

from pytpc.base.errors import InputError, TpcError
from pytpc.base.wording import many, plain
from pytpc.cli.console import warn
from pytpc.cli.options import recording_of
from pytpc.ingest import Recording
from pytpc.present.marking_terminal import Mission, Paint, RecordedMission, paint_marks, run
from pytpc.recording.marking_session import Session
from pytpc.recording.marks import marks_beside
from pytpc.recording.marks_file import MarksFile
from pytpc.ros.marking import GraphMarks
from pytpc.ros.ros1.master import uri_of

_PATH = click.Path(path_type=Path)
_NAMESPACE = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)
"""What ROS takes where ROS_MASTER_URI is not set."""

OBSERVER = click.option(
    "--observer", default="", metavar="NAME", help="Whose marks: a namespace of topics."
)


@click.command("mark")
@click.argument("bag", type=_PATH, required=False)
@OBSERVER
@click.option("-o", "--output", type=_PATH, help="CSV of the marks; BAG.marks.csv beside a bag.")
def mark_command(*, bag: Path | None, observer: str, output: Path | None) -> None:
    """Mark by one key each when the robot does wrong.

    On the live graph of ROS_MASTER_URI the marks are published, too; a bag that is replayed with
    `rosbag play --clock` is one. With BAG, a clock goes through the recording.
    """
    check_observer(observer)
    path = marks_path(bag, observer, output)
    if bag is None:
        mission: Mission = GraphMarks(uri_of(os.environ), observer)
    else:
        recording = recording_of(bag)
        mission = recorded(recording, bag)
        for note in recording.notes:
            warn(plain(note))
    mark_in_terminal(mission, observer, path)


def check_observer(observer: str) -> None:
    """See that an observer's name can be one.

    Raises:
        BadParameter: it is no namespace of ROS.
    """
    if observer and not _NAMESPACE.fullmatch(observer):
        raise click.BadParameter(f"{observer!r} is no namespace of ROS", param_hint="--observer")


def marks_path(bag: Path | None, observer: str, output: Path | None) -> Path:
    """Where the marks go: where the user says, beside a recording, or into a new file here."""
    if output is not None or bag is not None:
        return output or marks_beside(bag or Path())
    who = f"{observer.replace('/', '-')}-" if observer else ""
    return Path(time.strftime(f"marks-{who}%Y%m%d-%H%M%S.csv"))


def recorded(recording: Recording, source: Path) -> RecordedMission:
    """The clock that goes through a recording.

    Raises:
        InputError: it has no length.
    """
    if recording.end_ns <= recording.start_ns:
        raise InputError("nothing in it takes any time", source)
    return RecordedMission(plain(source.name), recording.start_ns, recording.end_ns)


def mark_in_terminal(
    mission: Mission,
    observer: str,
    path: Path,
    *,
    paint: Paint = paint_marks,
    full: bool = False,
) -> None:
    """Mark until the observer ends it, and say where the marks are; see `terminal.run`.

    Raises:
        TpcError: the file cannot be used, or there is no terminal.
    """
    try:
        file = MarksFile(path.absolute())
    except TpcError:
        mission.close()
        raise
    ours = tuple(mark for mark in file.before if mark.observer == observer)
    session = run(Session(observer, ours), mission, file, paint=paint, full=full)
    warn_of_nothing = "" if path.exists() else " (no file was written)"
    click.echo(f"{many(len(session.marks), 'mark')}: {plain(str(path))}{warn_of_nothing}")


COMMANDS: list[click.Command] = [mark_command]
