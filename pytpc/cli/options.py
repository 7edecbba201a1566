"""Options and functions that the commands about recordings share."""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.comparing import RecordedRun, with_learned
from pytpc.api.diagnosing import AskedMission
from pytpc.api.learning import reports_digest
from pytpc.api.missions import check_reports, read_named, same_reports
from pytpc.base.errors import InputError
from pytpc.base.wording import many, plain
from pytpc.cli import arguments
from pytpc.cli.arguments import Command
from pytpc.cli.console import progress, warn
from pytpc.cli.lines import say
from pytpc.diagnosis.question import WINDOW_S, Question, Types
from pytpc.recording.faults import faults_of
from pytpc.recording.mission import Recording
from pytpc.recording.profile import LEARNED_FILE, read_learned
from pytpc.ros.earlier_runs import last_unmarked_run
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True)
class AskArguments:
    """The options that all commands about recordings have."""

    static_source: Path | None
    types: Types
    window_s: float
    top: int
    as_json: bool


STATIC, MARKS, Seconds = arguments.STATIC, arguments.MARKS, arguments.Seconds
TOP = click.option(
    "--top",
    type=click.IntRange(min=1),
    default=5,
    show_default=True,
    metavar="N",
    help="Show this many suspects.",
)
WINDOW = click.option(
    "--window",
    "window_s",
    type=Seconds(min=0.0, min_open=True, max=86400.0),
    default=WINDOW_S,
    show_default=True,
    metavar="SECONDS",
    help="Length of the window before a mark in which type II looks.",
)

_UNTYPED = "pytpc.untyped"
_OFFERED = "pytpc.offered"
_GOOD = "pytpc.good"


def _note_untyped(ctx: click.Context, _: click.Parameter, value: bool) -> None:
    ctx.meta[_UNTYPED] = value


def _types(ctx: click.Context, _: click.Parameter, value: str) -> str:
    return "ignore" if ctx.meta.get(_UNTYPED) else value


_BELIEVED = click.option(
    "--types",
    type=click.Choice(["believe", "doubt", "ignore"]),
    default="believe",
    show_default=True,
    callback=_types,
    help="How far to believe the types of the marks.",
)
# The old name of `--types ignore`.
_OLDER = click.option(
    "--untyped",
    is_flag=True,
    hidden=True,
    expose_value=False,
    is_eager=True,
    callback=_note_untyped,
)


def TYPES(command: Command) -> Command:
    """Add the option ``--types``; the command gets ``types``."""
    return _BELIEVED(_OLDER(command))


def recording_of(source: Path, marks: Sequence[Path] = ()) -> Recording:
    """Read a recording, with these files of marks, and show the progress.

    Raises:
        InputError: it cannot be read.
    """
    with progress(f"reading {source.name}") as advance:
        return read_named(source, advance, marks)


def marks_of_one(files: tuple[Path, ...], recordings: Sequence[Path]) -> tuple[Path, ...]:
    """The files of ``--marks``.

    Raises:
        UsageError: there are several recordings.
    """
    if files and len(recordings) > 1:
        raise click.UsageError("--marks needs a single RECORDING")
    return files


def check(recording: Recording, static: StaticInfo, source: Path) -> None:
    """Check that a recording is of this build, and warn of its faults.

    Raises:
        InputError: it is of another build, or has no report.
    """
    check_reports(recording, static, source)
    warn_about(recording, static)


def warn_about(recording: Recording, static: StaticInfo | None = None) -> None:
    """Warn of each fault of a recording, in a line."""
    for fault in faults_of(recording, static):
        warn(f"{plain(recording.name)}: {plain(fault)}")


def offer_good_run(mission: Path) -> None:
    """Name the last recording that was launched alike and that nobody marked; once."""
    offered: set[Path] = click.get_current_context().meta.setdefault(_OFFERED, set())
    found = last_unmarked_run(mission)
    if found is not None and found not in offered:
        offered.add(found)
        short = min(str(found), os.path.relpath(found), key=len)
        say(
            f"pytpc: note: {plain(short)} is of the same launch file, and nobody marked it. If it"
            f" was a good run: --reference {shlex.quote(plain(short))}",
        )


def good_runs(sources: Sequence[Path], static: StaticInfo) -> list[RecordedRun]:
    """Read the good runs that ``--reference`` names, each once for all missions.

    A profile of ``pytpc learn`` stands for its runs. Of each run that has marks a line warns.

    Raises:
        InputError: one cannot be read, or its reports are of no comparison of this build.
    """
    read: dict[Path, RecordedRun] = click.get_current_context().meta.setdefault(_GOOD, {})
    named = with_learned(sources)
    for source in named:
        if source not in read:
            read[source] = RecordedRun(recording_of(source), source)
            warn_of_marks(source, read[source].recording)
        check_reports(read[source].in_build(static).recording, static, source)
    return [read[source] for source in named]


def warn_of_marks(source: Path, recording: Recording) -> None:
    """Warn if somebody saw errors in what is taken for a good run."""
    if recording.marks:
        warn(
            f"{plain(str(source))}: has {many(len(recording.marks), 'mark')}, so somebody saw"
            " errors in this good run; give one that nobody marked, if there is one"
        )


def asked_mission(
    run: RecordedRun, static: StaticInfo, question: Question, good: Sequence[RecordedRun]
) -> AskedMission:
    """Put a question about a mission of a file or folder, and warn of the recording's faults.

    Raises:
        InputError: a recording is of another build, has no report, or is its own good run.
    """
    assert run.source is not None
    check(run.recording, static, run.source)
    refuse_itself(good, run.recording)
    return AskedMission.of(run, static, question, good)


def refuse_itself(good: Sequence[RecordedRun], mission: Recording) -> None:
    """Refuse the mission itself as its good run, whatever the path, the format or the copy.

    Learned, it has the digest of the mission's reports.

    Raises:
        InputError: both have the same reports.
    """
    for run in good:
        if same_reports(run.recording, mission) or _is_learned_from(run, mission):
            raise InputError(
                f"has the same reports as the mission {plain(mission.name)} itself; give a"
                " recording of a good run",
                run.source,
            )


def _is_learned_from(run: RecordedRun, mission: Recording) -> bool:
    if run.source is None or not (run.source / LEARNED_FILE).is_file():
        return False
    learned = read_learned(run.source / LEARNED_FILE)
    # To read all reports of the mission takes longer than to judge it.
    if (learned.start_ns, learned.end_ns) != (mission.start_ns, mission.end_ns):
        return False
    return learned.digest == reports_digest(mission)


def warn_plainly(line: str) -> None:
    """Warn in a line that may contain any text from a robot."""
    warn(plain(line))
