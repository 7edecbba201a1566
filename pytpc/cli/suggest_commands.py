"""The command ``suggest``: which value to try, and what it would have changed."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, replace
from pathlib import Path

import click

from pytpc.api.comparing import RecordedRun
from pytpc.api.diagnosing import AskedMission
from pytpc.api.missions import find_declared, with_names_of
from pytpc.api.suggesting import suggest_together, what_if_by_type
from pytpc.base.errors import InputError
from pytpc.base.wording import Number, plain, show
from pytpc.cli.arguments import JSON, PATH, REFERENCE, as_object
from pytpc.cli.completion_commands import offer_parameters
from pytpc.cli.console import console, print_json, progress
from pytpc.cli.options import (
    MARKS,
    STATIC,
    TOP,
    TYPES,
    WINDOW,
    AskArguments,
    check,
    good_runs,
    offer_good_run,
    recording_of,
    refuse_itself,
    warn_plainly,
)
from pytpc.cli.sources import static_for
from pytpc.diagnosis.question import Question
from pytpc.present.as_json import diagnosis_json, fields_json, group_json
from pytpc.present.ranking_tables import group_text, print_differences, print_suggestions
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

_TRUTHS = {"true": True, "false": False}
_LONGEST = 40


@dataclass(frozen=True)
class _SuggestArguments(AskArguments):
    recording: Path
    marks_files: tuple[Path, ...]
    parameter: str | None
    value_text: str | None
    each: bool
    references: tuple[Path, ...]
    flown: tuple[float, ...]

    def __post_init__(self) -> None:
        if self.value_text is not None and self.parameter is None:
            raise click.UsageError("--value needs a PARAMETER")
        if self.flown and self.parameter is None:
            raise click.UsageError("--flown needs a PARAMETER")


@click.command("suggest")
@click.argument("recording", type=PATH)
@click.argument("parameter", required=False, shell_complete=offer_parameters)
@STATIC
@click.option("--each", is_flag=True, help="Show the suggestions for groups of marks, too.")
@MARKS
@click.option(
    "--value",
    "value_text",
    metavar="V",
    help="Show what this value of PARAMETER would have changed, instead of suggesting one.",
)
@REFERENCE
@click.option(
    "--flown",
    type=float,
    multiple=True,
    metavar="V",
    help="A value of PARAMETER that you tried and that did not help; may be repeated.",
)
@TYPES
@WINDOW
@TOP
@JSON
@as_object(_SuggestArguments)
def suggest_command(given: _SuggestArguments) -> None:
    """Suggest a value to try for the suspects in RECORDING, and show what it would have changed.

    The suspects are those of `rank`. With PARAMETER, only that parameter is shown, wherever it
    stands in the ranking, and what it would do at each group of marks that say the same. Write a
    negative number as --value=-1.
    """
    value = None if given.value_text is None else _number(given.value_text)
    found = recording_of(given.recording, given.marks_files)
    if not found.marks and value is None:
        raise InputError(
            f"no marks: add some with `pytpc mark {shlex.quote(str(given.recording))}`, or ask for"
            " a --value",
            given.recording,
        )
    static = static_for(given.static_source, given.recording, found)
    check(found, static, given.recording)
    if given.types == "ignore":
        found = replace(found, marks=tuple(replace(mark, type=None) for mark in found.marks))
    if value is not None and given.parameter is not None:
        named = with_names_of(found, static, given.recording)
        _show_value(found, named, value, given)
    else:
        _show_suggestions(found, static, given)


COMMANDS: list[click.Command] = [suggest_command]


def _number(text: str) -> Number:
    """The value of ``--value``.

    Raises:
        BadParameter: it is not a finite number, true or false.
    """
    if text.lower() in _TRUTHS:
        return _TRUTHS[text.lower()]
    try:
        value = float(text)
    except ValueError as error:
        raise click.BadParameter(
            f"{text!r} is not a number, true or false", param_hint="--value"
        ) from error
    if value - value != 0:
        shown = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
        raise click.BadParameter(f"{shown!r} is not finite", param_hint="--value")
    try:
        return int(text)
    except ValueError:
        return value


def _show_suggestions(recording: Recording, static: StaticInfo, given: _SuggestArguments) -> None:
    question = Question(
        given.types,
        given.window_s,
        given.top,
        declared=find_declared(static, given.recording, warn_plainly),
        flown=given.flown,
    )
    good = good_runs(given.references, static)
    refuse_itself(good, recording)
    if not good:
        offer_good_run(given.recording)
    with progress("replaying the mission") as advance:
        advance(0, len(recording.marks))
        run = RecordedRun(recording, given.recording)
        asked = AskedMission.of(run, static, question, good)
        answer = suggest_together(asked.rankings, given.parameter)
    if given.as_json:
        document = {
            "mission": recording.name,
            "together": diagnosis_json(answer.together),
            "groups": [group_json(group, recording.start_ns) for group in answer.groups],
        }
        print_json(document)
        return
    if answer.together.differences is not None:
        print_differences(console(), answer.together.differences)
    print_suggestions(console(), answer.together, given.parameter)
    if not (given.each or given.parameter):
        return
    for group in answer.groups:
        console().print(group_text(group, recording, given.parameter), highlight=False)


def _show_value(
    recording: Recording, static: StaticInfo, value: Number, given: _SuggestArguments
) -> None:
    """Show what one value would have changed, for each type of mark in the recording."""
    assert given.parameter is not None, "--value needs it"
    question = Question(given.types, given.window_s)
    answers = what_if_by_type(recording, static, given.parameter, value, question)
    if given.as_json:
        items = [{"type": kind, **fields_json(answer)} for kind, answer in answers]
        document = {"mission": recording.name, "what_if": items}
        print_json(document)
        return
    first = answers[0][1]
    click.echo(plain(f"{first.parameter} = {show(value)}:"))
    for _, answer in answers:
        click.echo(plain(f"  {answer.text}"))
    for caveat in first.caveats:
        click.echo(plain(f"  note: {caveat}"))
