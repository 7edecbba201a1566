"""All marks together on the command line: the options of ``rank`` for it, and what it reads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, TypeVar

import click

from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.cli.console import warn
from pytpc.cli.options import PATH, check_reports, recording_of
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.results.advice import BlamedAdvice
from pytpc.diagnosis.results.suspects import Blame
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.suggestion.blamed import advise_blamed
from pytpc.ingest import Recording
from pytpc.ros.mission_run import PARAMS_FILE
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.changes import Change, changes_between, read_changes

Score = Literal["tpc", "thesis"]
Command = TypeVar("Command", bound=Callable[..., object])

_OPTIONS = (
    click.option(
        "--score",
        type=click.Choice(["tpc", "thesis"]),
        default="tpc",
        show_default=True,
        help="tpc judges by all marks together; thesis has a table for each mark.",
    ),
    click.option("--each", is_flag=True, help="Show the table for each mark, too."),
    click.option(
        "--reference",
        type=PATH,
        metavar="RECORDING",
        help="A mission of the same build that went right: what has its value is hardly to blame.",
    ),
    click.option(
        "--changes",
        "changes_file",
        type=PATH,
        metavar="FILE",
        help="JSON list of what was changed since it went right: what was not is hardly to blame.",
    ),
    click.option(
        "--before",
        type=PATH,
        metavar="FILE",
        help="In place of --changes: params.yaml of when it went right.",
    ),
)


def TOGETHER(command: Command) -> Command:
    """The options ``--score`` to ``--before``."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


@dataclass(frozen=True)
class Judge:
    """Judges missions by all their marks, with what is known beside the log.

    ``before`` is the params.yaml with which each mission's own is compared, in place of
    ``changes``; None where it is not.
    """

    static: StaticInfo
    reference: Recording | None
    changes: tuple[Change, ...]
    before: Path | None

    @classmethod
    def of(
        cls,
        static: StaticInfo,
        reference: Path | None,
        changes_file: Path | None,
        before: Path | None,
    ) -> Judge:
        """Read what is known.

        Raises:
            InputError: it cannot be read, or the reference is of another build.
        """
        clean = None
        if reference is not None:
            clean = recording_of(reference)
            check_reports(clean, static, reference)
        changes = () if changes_file is None else read_changes(changes_file)
        if changes_file is not None:
            _warn_of(changes, changes_file, static)
        return cls(static, clean, changes, before)

    def judge(
        self, recording: Recording, source: Path, question: Question
    ) -> tuple[Blame, list[BlamedAdvice]]:
        """The verdict on a mission, and what to do with the first suspects.

        Raises:
            InputError: ``before`` is given, and the mission's own values are not there.
        """
        changes = self.changes
        if self.before is not None:
            changes = _changes_since(self.before, source)
            _warn_of(changes, self.before, self.static)
        known = [(one.parameter, one.old, one.new) for one in changes]
        asked = replace(question, reference=self.reference, changes=known)
        found = blame(recording, self.static, asked)
        return found, advise_blamed(found, recording, self.static, asked)


def _changes_since(before: Path, source: Path) -> tuple[Change, ...]:
    folder = source if source.is_dir() else source.parent
    after = folder / PARAMS_FILE
    if not after.is_file():
        raise InputError(f"no {PARAMS_FILE} beside it, to be compared with --before", source)
    return changes_between(before, after)


def _warn_of(changes: Sequence[Change], path: Path, static: StaticInfo) -> None:
    """A line where no parameter that is compared was changed: then nothing is known by it."""
    names = Tpcs.of(static).names
    if not any(same_parameter(one.parameter, name) for one in changes for name in names):
        warn(f"{plain(str(path))}: no parameter that is compared anywhere was changed")
