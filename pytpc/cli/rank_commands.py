"""The command ``rank``: which parameter is to blame, by all marks and at each mark."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import click

from pytpc.api.comparing import RecordedRun
from pytpc.api.diagnosing import AskedMission, Rankings, changes_since, is_compared
from pytpc.api.missions import check_has_reports, find_declared
from pytpc.api.suggesting import smallest_changes
from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.cli.arguments import JSON, PATH, REFERENCE, as_object
from pytpc.cli.console import console, print_json, warn
from pytpc.cli.options import (
    MARKS,
    STATIC,
    TOP,
    TYPES,
    WINDOW,
    AskArguments,
    Seconds,
    asked_mission,
    good_runs,
    marks_of_one,
    offer_good_run,
    recording_of,
    warn_plainly,
)
from pytpc.cli.sources import static_for, warn_of_changed
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.advice import Suggested
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.present.as_json import diagnosis_json, ranking_json
from pytpc.present.ranking_tables import print_diagnosis, print_rankings
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.static_info import StaticInfo
from pytpc.values.changes import read_changes
from pytpc.values.declared import read_declared


@dataclass(frozen=True)
class _RankArguments(AskArguments):
    recordings: tuple[Path, ...]
    marks_files: tuple[Path, ...]
    score: Literal["tpc", "thesis"]
    each: bool
    references: tuple[Path, ...]
    changes_file: Path | None
    before: Path | None
    at_s: tuple[float, ...]

    @property
    def knows_changes(self) -> bool:
        """Whether anything is known about what changed."""
        return bool(self.references or self.changes_file or self.before)

    def __post_init__(self) -> None:
        if self.score == "thesis" and self.knows_changes:
            raise click.UsageError("--reference, --changes and --before are for --score tpc")
        if self.changes_file and self.before:
            raise click.UsageError("give --changes or --before, not both")


@dataclass(frozen=True)
class _Answer:
    """The answer about a mission: of all marks together, and of each mark."""

    recording: Recording
    together: Diagnosis | None
    marks: Rankings | None
    smallest: Sequence[list[Suggested]] = ()

    def show(self) -> None:
        if self.together is not None:
            print_diagnosis(console(), self.together)
        marks = zip(self.marks or (), self.smallest, strict=True)
        print_rankings(console(), self.recording, list(marks))

    def as_json(self) -> list[dict[str, object]]:
        """An object for each mark; each contains the answer of all marks together."""
        found = self.together
        diagnosis = None if found is None else diagnosis_json(found)
        return [
            {**ranking_json(ranking, self.recording, rows), "diagnosis": diagnosis}
            for ranking, rows in zip(self.marks or (), self.smallest, strict=True)
        ]


@click.command("rank")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@STATIC
@MARKS
@click.option(
    "--score",
    type=click.Choice(["tpc", "thesis"]),
    default="tpc",
    show_default=True,
    help="tpc: judge by all marks together. thesis: show a table for each mark.",
)
@click.option("--each", is_flag=True, help="Show the table for each mark, too.")
@REFERENCE
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

    \b
    type I      the robot did something that it should not have done
    type II     it does not do what it should
    none of the parameters
                a fault in the code, or something around the robot
    flop        a comparison's result that changed
    score       type I: how long ago the last flop was, and how many there were;
                type II: how near values were to the threshold. Low is suspicious.
    """
    items: list[dict[str, object]] = []
    unmarked: list[Path] = []
    more = marks_of_one(given.marks_files, given.recordings)
    questions: dict[int, Question] = {}
    for source in given.recordings:
        recording = recording_of(source, more)
        check_has_reports(recording, source)
        if given.at_s:
            recording = replace(recording, marks=_marks_at(recording, given.at_s))
        if not recording.marks:
            unmarked.append(source)
            continue
        static = static_for(given.static_source, source, recording)
        # Of missions of one build the rest is the same.
        if id(static) not in questions:
            questions[id(static)] = _question(given, static)
            warn_of_changed(static, source)
        question = questions[id(static)]
        declared = [*(question.declared or ()), *read_declared([source], warn_plainly)]
        question = replace(question, declared=declared)
        run, good = RecordedRun(recording, source), good_runs(given.references, static)
        answer = _answer(asked_mission(run, static, question, good), given)
        if not given.knows_changes:
            offer_good_run(source)
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


def _question(given: _RankArguments, static: StaticInfo) -> Question:
    """What is asked, and what is known besides the mission."""
    return Question(
        given.types,
        given.window_s,
        given.top,
        changes=_known(given.changes_file, static),
        declared=find_declared(static, None, warn_plainly),
    )


def _answer(asked: AskedMission, given: _RankArguments) -> _Answer:
    """Diagnose a mission with marks.

    Raises:
        InputError: its params.yaml is missing.
    """
    recording, source = asked.run.recording, asked.run.source
    if given.before is not None and source is not None:
        changes = changes_since(given.before, source)
        _warn_of(changes, given.before, asked.static_info)
        asked = replace(asked, question=replace(asked.question, changes=changes))
    together = asked.diagnosis if given.score == "tpc" else None
    if together is not None and not (given.each or given.as_json):
        return _Answer(recording, together, None)
    return _Answer(recording, together, asked.rankings, smallest_changes(asked.rankings))


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
    if len(unmarked) == of:
        raise InputError(_no_marks(unmarked[0]), unmarked[0])
    for source in unmarked:
        warn(f"{plain(str(source))}: {_no_marks(source)}")


def _no_marks(source: Path) -> str:
    mark = f"`pytpc mark {shlex.quote(str(source))}`"
    return f"no marks: add some with {mark}, or give a time with --at"
