"""Commands about marks: ``mark``."""

from __future__ import annotations

import os
import re
import time
from pathlib import Path

import click

from pytpc.cli.console import progress, warn
from pytpc.errors import InputError
from pytpc.ingest import read
from pytpc.marking.file import MarksFile
from pytpc.marking.graph import GraphMarks
from pytpc.marking.session import Session
from pytpc.marking.terminal import Mission, RecordedMission, run
from pytpc.marks import marks_beside
from pytpc.words import many, plain

_PATH = click.Path(path_type=Path)
_NAMESPACE = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)
_MASTER = "http://localhost:11311"


@click.command("mark")
@click.argument("bag", type=_PATH, required=False)
@click.option("--observer", default="", metavar="NAME", help="Whose marks: a namespace of topics.")
@click.option("-o", "--output", type=_PATH, help="CSV of the marks; BAG.marks.csv beside a bag.")
def mark_command(*, bag: Path | None, observer: str, output: Path | None) -> None:
    """Mark by one key each when the robot does wrong.

    On the live graph of ROS_MASTER_URI the marks are published, too; a bag that is replayed with
    `rosbag play --clock` is one. With BAG, a clock goes through the recording.
    """
    if observer and not _NAMESPACE.fullmatch(observer):
        raise click.BadParameter(f"{observer!r} is no namespace of ROS", param_hint="--observer")
    if bag is None:
        who = f"{observer.replace('/', '-')}-" if observer else ""
        path = output or Path(time.strftime(f"marks-{who}%Y%m%d-%H%M%S.csv"))
    else:
        path = output or marks_beside(bag)
    file = MarksFile(path.absolute())
    ours = tuple(mark for mark in file.before if mark.observer == observer)
    session = run(Session(observer, ours), _mission(bag, observer), file)
    warn_of_nothing = "" if path.exists() else " (no file was written)"
    click.echo(f"{many(len(session.marks), 'mark')}: {plain(str(path))}{warn_of_nothing}")


def _mission(bag: Path | None, observer: str) -> Mission:
    if bag is None:
        return GraphMarks(os.environ.get("ROS_MASTER_URI") or _MASTER, observer)
    with progress(f"reading {bag.name}") as advance:
        recording = read(bag, advance)
    if recording.end_ns <= recording.start_ns:
        raise InputError("nothing in it takes any time", bag)
    for note in recording.notes:
        warn(plain(note))
    return RecordedMission(plain(bag.name), recording.start_ns, recording.end_ns)


COMMANDS: list[click.Command] = [mark_command]
