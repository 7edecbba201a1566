"""The command ``rank``: which parameter is to blame, by all marks and at each mark."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import click

from pytpc.api.diagnosing import Rankings, changes_since, diagnose, is_compared
from pytpc.api.missions import about_mission, find_declared, with_names_of
from pytpc.api.suggesting import smallest_changes
from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, warn
from pytpc.cli.options import (
    STATIC,
    TOP,
    TYPES,
    WINDOW,
    AskArguments,
    Seconds,
    check,
    recording_of,
    reference_of,
    warn_plainly,
)
from pytpc.cli.sources import static_of
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.advice import Suggested
from pytpc.present.answers import Diagnosed
from pytpc.present.as_json import blame_json, ranking_json
from pytpc.present.ranking_tables import print_blame, print_rankings
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.static_info import StaticInfo
from pytpc.values.changes import read_changes
from pytpc.values.declared import read_declared


@dataclass(frozen=True)
class _RankArguments(AskArguments):
    recordings: tuple[Path, ...]
    score: Literal["tpc", "thesis"]
    each: bool
    reference: Path | None
    changes_file: Path | None
    before: Path | None
    at_s: tuple[float, ...]

    def __post_init__(self) -> None:
        known = self.reference or self.changes_file or self.before
        if self.score == "thesis" and known:
            raise click.UsageError("--reference, --changes and --before are for --score tpc")
        if self.changes_file and self.before:
            raise click.UsageError("give --changes or --before, not both")


@dataclass(frozen=True)
class _Answer:
    """The answer about a mission: of all marks together, and of each mark."""

    recording: Recording
    together: Diagnosed | None
    marks: Rankings | None
    smallest: Sequence[list[Suggested]] = ()

    def show(self) -> None:
        if self.together is not None:
            print_blame(console(), self.together.blame, self.together.advice)
        marks = zip(self.marks or (), self.smallest, strict=True)
        print_rankings(console(), self.recording, list(marks))

    def as_json(self) -> list[dict[str, object]]:
        """An object for each mark; each contains the answer of all marks together."""
        found = self.together
        diagnosis = None if found is None else blame_json(found.blame, found.advice)
        return [
            {**ranking_json(ranking, self.recording, rows), "diagnosis": diagnosis}
            for ranking, rows in zip(self.marks or (), self.smallest, strict=True)
        ]


@click.command("rank")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@STATIC
@click.option(
    "--score",
    type=click.Choice(["tpc", "thesis"]),
    default="tpc",
    show_default=True,
    help="tpc: judge by all marks together. thesis: show a table for each mark.",
)
@click.option("--each", is_flag=True, help="Show the table for each mark, too.")
@click.option(
    "--reference",
    type=PATH,
    metavar="RECORDING",
    help="A good run of the same build. A parameter that had the same value there is unlikely to be"
    " the cause.",
)
@click.option(
    "--changes",
    "changes_file",
    type=PATH,
    metavar="FILE",
    help="JSON list of what was changed since the robot worked. A parameter that was not changed is"
    " unlikely to be the cause.",
)
@click.option(
    "--before",
    type=PATH,
    metavar="FILE",
    help="params.yaml of a good run, in place of --changes.",
)
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
@as_object(_RankArguments)
def rank_command(given: _RankArguments) -> None:
    """Rank the suspected parameters in each RECORDING, from its marks.

    A RECORDING is any INPUT of `convert`. One table covers all marks: the probability that each
    parameter is to blame, and a value to try. With --each, or --score thesis, there is a table for
    each mark with the thesis's scores.
    """
    static = static_of([given.static_source])
    question = Question(
        given.types,
        given.window_s,
        given.top,
        reference=reference_of(given.reference, static),
        changes=_known(given.changes_file, static),
        declared=find_declared(static, None, warn_plainly),
    )
    items: list[dict[str, object]] = []
    unmarked: list[Path] = []
    for source in given.recordings:
        recording = recording_of(source)
        if given.at_s:
            recording = replace(recording, marks=_marks_at(recording, given.at_s))
        if not recording.marks:
            unmarked.append(source)
            continue
        declared = [*(question.declared or ()), *read_declared([source], warn_plainly)]
        named = with_names_of(recording, static, source)
        asked = about_mission(replace(question, declared=declared), static, named)
        answer = _answer(recording, named, source, asked, given)
        if given.as_json:
            items += answer.as_json()
            continue
        if len(given.recordings) > 1:
            click.echo(f"{plain(str(source))}:\n")
        answer.show()
    _tell_unmarked(unmarked, len(given.recordings))
    if given.as_json:
        print_json(items)


COMMANDS: list[click.Command] = [rank_command]


def _answer(
    recording: Recording,
    static: StaticInfo,
    source: Path,
    question: Question,
    given: _RankArguments,
) -> _Answer:
    """Diagnose a mission with marks, and warn of its faults.

    Raises:
        InputError: none of its reports is known, or its params.yaml is missing.
    """
    check(recording, static, source)
    together = None
    if given.score == "tpc":
        if given.before is not None:
            changes = changes_since(given.before, source)
            _warn_of(changes, given.before, static)
            question = replace(question, changes=changes)
        together = diagnose(recording, static, question)
        # All marks together say little about summaries.
        if not (given.each or given.as_json or len(recording.summaries)):
            return _Answer(recording, together, None)
    rankings = Rankings.of(recording, static, question, source)
    return _Answer(recording, together, rankings, smallest_changes(rankings))


def _known(path: Path | None, static: StaticInfo) -> tuple[Change, ...]:
    """Read the changes in a file."""
    if path is None:
        return ()
    changes = read_changes(path)
    _warn_of(changes, path, static)
    return changes


def _warn_of(changes: Sequence[Change], path: Path, static: StaticInfo) -> None:
    """Warn if no compared parameter was changed: then the changes say nothing."""
    if not is_compared(changes, static):
        warn(f"{plain(str(path))}: none of the changed parameters is compared anywhere")


def _marks_at(recording: Recording, at_s: Sequence[float]) -> tuple[Mark, ...]:
    """Marks without a type at these seconds of the recording."""
    return tuple(Mark(recording.start_ns + round(second * 1e9), None) for second in at_s)


def _tell_unmarked(unmarked: Sequence[Path], of: int) -> None:
    """Warn of recordings without a mark.

    Raises:
        InputError: no recording has one.
    """
    what = "no marks: add some with `pytpc mark`, or give a time with --at"
    if len(unmarked) == of:
        raise InputError(what, unmarked[0])
    for source in unmarked:
        warn(f"{plain(str(source))}: {what}")
