"""Commands about marks in recordings: ``rank`` and ``marks``."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from pytpc.base.errors import InputError, TpcError
from pytpc.base.wording import many, plain
from pytpc.cli.console import console, warn
from pytpc.cli.options import (
    JSON,
    PATH,
    STATIC,
    TOP,
    TYPES,
    WINDOW,
    Seconds,
    check_reports,
    recording_of,
    warn_about,
)
from pytpc.cli.rank_together import TOGETHER, Judge, Score
from pytpc.cli.sources import static_of
from pytpc.diagnosis.question import Question, Types
from pytpc.diagnosis.ranking.clocks import two_clocks
from pytpc.diagnosis.ranking.ranking import rank_marks
from pytpc.diagnosis.results.advice import BlamedAdvice, Suggested
from pytpc.diagnosis.results.suspects import Blame, MarkRanking
from pytpc.diagnosis.suggestion.advise import suggest_each
from pytpc.ingest import Recording
from pytpc.present.as_json import blame_json
from pytpc.present.rankings import print_blame, print_rankings
from pytpc.recording.declaration import Declared
from pytpc.recording.marking_session import MarkChange
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
from pytpc.static.static_info import StaticInfo
from pytpc.values.declared_files import declared_in, read_declared


@click.command("rank")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@STATIC
@TOGETHER
@TYPES
@WINDOW
@TOP
@click.option(
    "--at",
    "at_s",
    type=Seconds(min=0.0, max=1e8),
    multiple=True,
    metavar="SECONDS",
    help="Rank at this time of the mission, as if it were marked without a type; may be repeated.",
)
@JSON
def rank_command(
    *,
    recordings: tuple[Path, ...],
    static_source: Path,
    score: Score,
    each: bool,
    reference: Path | None,
    changes_file: Path | None,
    before: Path | None,
    types: Types,
    window_s: float,
    top: int,
    at_s: tuple[float, ...],
    as_json: bool,
) -> None:
    """Name the suspected parameters in each RECORDING (any INPUT of `convert`), from its marks.

    One table has all marks together: how likely it is each parameter, and a value to try. With
    --each, or --score thesis, there is a table for each mark, by the thesis's scores.
    """
    beside = (reference, changes_file, before)
    if score == "thesis" and any(beside):
        raise click.UsageError("--reference, --changes and --before are for --score tpc")
    if changes_file and before:
        raise click.UsageError("one of --changes and --before at a time")
    static = static_of([static_source])
    judge = None if score == "thesis" else Judge.of(static, *beside)
    in_sources = declared_in(static, (), _warn_plainly)
    asked = _Asked(static, judge, each or as_json, Question(types, window_s, top))
    items: list[dict[str, object]] = []
    unmarked: list[Path] = []
    for source in recordings:
        recording = recording_of(source)
        if at_s:
            recording = replace(recording, marks=_marks_at(recording, at_s))
        if not recording.marks:
            unmarked.append(source)
            continue
        declared = [*in_sources, *read_declared([source], _warn_plainly)]
        found = asked.ranked(recording, source, declared)
        if as_json:
            items += found.as_json()
            continue
        if len(recordings) > 1:
            click.echo(f"{plain(str(source))}:\n")
        found.show()
    _tell_unmarked(unmarked, len(recordings))
    if as_json:
        click.echo(json.dumps(items, indent=1, ensure_ascii=False))


@dataclass(frozen=True)
class _Asked:
    """What is asked for of each mission; ``judge`` is None where only its marks' tables are."""

    static: StaticInfo
    judge: Judge | None
    each: bool
    question: Question

    def ranked(self, recording: Recording, source: Path, declared: Sequence[Declared]) -> _Ranked:
        """The answer for a mission with marks; what is wrong with it is warned of.

        Raises:
            InputError: none of its reports is known, or what it is compared with is not there.
        """
        check_reports(recording, self.static, source)
        warn_about(recording, self.static)
        for clock in two_clocks(recording):
            warn(f"{plain(recording.name)}: {plain(clock)}")
        question = replace(self.question, declared=declared)
        together = None
        if self.judge is not None:
            together = self.judge.judge(recording, source, question)
        # Of summaries all marks together say little.
        if together is not None and not self.each and not len(recording.summaries):
            return _Ranked(recording, together, [])
        rankings = rank_marks(recording, self.static, question)
        marks = [(one, suggest_each(recording, self.static, one, question)) for one in rankings]
        return _Ranked(recording, together, marks)


@dataclass(frozen=True)
class _Ranked:
    """A mission's answer: of all marks together, and of each."""

    recording: Recording
    together: tuple[Blame, list[BlamedAdvice]] | None
    marks: list[tuple[MarkRanking, list[Suggested]]]

    def show(self) -> None:
        """Print it."""
        if self.together is not None:
            print_blame(console(), *self.together)
        print_rankings(console(), self.recording, self.marks)

    def as_json(self) -> list[dict[str, object]]:
        """An object for each mark; what all say together is in each of them."""
        diagnosis = None if self.together is None else blame_json(*self.together)
        return [
            {**_json_of(ranking, self.recording, rows), "diagnosis": diagnosis}
            for ranking, rows in self.marks
        ]


@click.command("marks")
@click.argument("recording", type=PATH)
@click.option(
    "--add",
    type=(float, click.Choice(["I", "II", "none"])),
    metavar="SECONDS TYPE",
    help="Add a mark at this time of the mission; TYPE is I, II or none.",
)
@click.option("--note", default="", metavar="TEXT", help="What is said of the mark that is added.")
@click.option("--observer", default="", metavar="NAME", help="Whose mark is added.")
@click.option(
    "--remove",
    type=click.IntRange(min=1),
    metavar="N",
    help="Remove the mark that the list has under this number.",
)
@click.option("--csv", "as_csv", is_flag=True, help="Print CSV, as in RECORDING.marks.csv.")
@JSON
def marks_command(
    *,
    recording: Path,
    add: tuple[float, str] | None,
    note: str,
    observer: str,
    remove: int | None,
    as_csv: bool,
    as_json: bool,
) -> None:
    """List the marks of a RECORDING; add or remove some.

    Those that are added stand in RECORDING.marks.csv beside it; only what stands there can be
    removed. The recording itself is never changed.
    """
    if add is not None and remove is not None:
        raise click.UsageError("one of --add and --remove at a time")
    if add is None and (note or observer):
        raise click.UsageError("--note and --observer are about a mark to --add")
    found = recording_of(recording)
    marks = found.marks
    if add is not None:
        mark = _mark_to_add(found, *add, observer, note)
        _change(recording, MarkChange(None, mark))
        marks = joined([*marks, mark])
    if remove is not None:
        gone = _mark_to_remove(recording, marks, remove)
        _change(recording, MarkChange(gone, None))
        marks = tuple(mark for mark in marks if mark != gone)
    if as_json:
        click.echo(
            json.dumps([_mark_json(found, mark) for mark in marks], indent=1, ensure_ascii=False)
        )
    elif as_csv:
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
        BadParameter: there is none.
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


def _mark_json(found: Recording, mark: Mark) -> dict[str, object]:
    return {
        "time_ns": mark.time_ns,
        "seconds": (mark.time_ns - found.start_ns) / 1e9,
        "type": mark.type,
        "observer": mark.observer,
        "note": mark.note,
    }


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


def _marks_at(recording: Recording, at_s: Sequence[float]) -> tuple[Mark, ...]:
    """Marks without a type, so many seconds after the begin of the recording."""
    return tuple(Mark(recording.start_ns + round(second * 1e9), None) for second in at_s)


def _tell_unmarked(unmarked: Sequence[Path], of: int) -> None:
    """Recordings without a mark.

    Raises:
        InputError: none of them has one.
    """
    what = "no marks: mark it with `pytpc mark`, or name a time with --at"
    if len(unmarked) == of:
        raise InputError(what, unmarked[0])
    for source in unmarked:
        warn(f"{plain(str(source))}: {what}")


def _warn_plainly(line: str) -> None:
    warn(plain(line))


def _json_of(
    ranking: MarkRanking, recording: Recording, rows: list[Suggested]
) -> dict[str, object]:
    mark = ranking.mark
    return {
        "mission": recording.name,
        "time_ns": mark.time_ns,
        "seconds": (mark.time_ns - recording.start_ns) / 1e9,
        "type": mark.type,
        "observer": mark.observer,
        "parameters": ranking.parameters,
        "enough": ranking.enough,
        "reason": ranking.reason,
        "suspects": [_json_of_suspect(row) for row in rows],
    }


def _json_of_suspect(row: Suggested) -> dict[str, object]:
    suspect, advice = row.suspect, row.suggestion
    return {
        "position": suspect.position,
        "tied": suspect.tied,
        "parameter": suspect.parameter,
        "key": suspect.key,
        "score": suspect.score,
        "rank": suspect.rank,
        "rank1": suspect.rank1,
        "rank2": suspect.rank2,
        "score_type": suspect.type,
        "current": _finite(advice.current),
        "direction": advice.direction,
        "value": _finite(advice.value),
        "boundary": _finite(advice.boundary),
        "inclusive": advice.inclusive,
        "suggestion": advice.text,
        "file": suspect.comparison.file,
        "lineno": suspect.comparison.lineno,
        "source_code": suspect.comparison.source_code,
        "topic": suspect.comparison.topic,
        "node": suspect.last.node,
    }


def _finite(value: float | None) -> float | None:
    """JSON has neither NaN nor infinity."""
    return value if value is None or abs(value) < float("inf") else None


COMMANDS: list[click.Command] = [rank_command, marks_command]
