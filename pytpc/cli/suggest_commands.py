"""The command ``suggest``: which value to try, and what it would have changed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import click

from pytpc.api.diagnosing import Rankings
from pytpc.api.missions import find_declared, with_names_of
from pytpc.api.suggesting import suggest_together, what_if_by_type
from pytpc.base.errors import InputError
from pytpc.base.wording import Number, plain, show
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.completion_commands import offer_parameters
from pytpc.cli.console import console, print_json, progress
from pytpc.cli.options import (
    STATIC,
    TOP,
    TYPES,
    WINDOW,
    AskArguments,
    check,
    recording_of,
    reference_of,
    warn_plainly,
)
from pytpc.cli.sources import static_of
from pytpc.diagnosis.question import Question
from pytpc.present.as_json import blame_json, fields_json, group_json
from pytpc.present.ranking_tables import group_text, together_text
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

_TRUTHS = {"true": True, "false": False}
_LONGEST = 40


@dataclass(frozen=True)
class _SuggestArguments(AskArguments):
    recording: Path
    parameter: str | None
    value_text: str | None
    reference: Path | None
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
@click.option(
    "--value",
    "value_text",
    metavar="V",
    help="Show what this value of PARAMETER would have changed, instead of suggesting one.",
)
@click.option(
    "--reference",
    type=PATH,
    metavar="RECORDING",
    help="A good run of the same build; its value is suggested if it would help.",
)
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

    The answer of all marks together comes first if it differs from the answers at the marks. With
    PARAMETER, only that parameter is shown, wherever it stands in the ranking. Write a negative
    number as --value=-1.
    """
    value = None if given.value_text is None else _number(given.value_text)
    static = static_of([given.static_source])
    found = recording_of(given.recording)
    if not found.marks and value is None:
        raise InputError(
            "no marks: add some with `pytpc mark`, or ask for a --value", given.recording
        )
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
        reference=reference_of(given.reference, static),
        declared=find_declared(static, given.recording, warn_plainly),
        flown=given.flown,
    )
    with progress("replaying the mission") as advance:
        advance(0, len(recording.marks))
        rankings = Rankings.of(recording, static, question, given.recording)
        answer = suggest_together(rankings, given.parameter)
    if given.as_json:
        document = {
            "mission": recording.name,
            "together": blame_json(answer.together, answer.first),
            "groups": [group_json(group, recording.start_ns) for group in answer.groups],
        }
        print_json(document)
        return
    if not answer.is_one_answer:
        for one in answer.first:
            part = together_text(answer.together, one, given.parameter)
            console().print(part, highlight=False)
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
