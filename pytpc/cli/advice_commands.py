"""The command ``suggest``: what to do with the suspects, and what it would have changed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from pytpc.base.errors import InputError
from pytpc.base.wording import Number, many, percent, plain, show
from pytpc.cli.console import console, progress, warn
from pytpc.cli.options import (
    JSON,
    PATH,
    STATIC,
    TOP,
    TYPES,
    WINDOW,
    check_reports,
    recording_of,
    warn_about,
)
from pytpc.cli.sources import static_of
from pytpc.diagnosis.question import Question, Types
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.ranking.ranking import rank_marks
from pytpc.diagnosis.results.advice import BlamedAdvice, JoinedAdvice, MarkGroup, WhatIf
from pytpc.diagnosis.results.suspects import Blame, MarkRanking
from pytpc.diagnosis.suggestion.blamed import advise_blamed
from pytpc.diagnosis.suggestion.joining import join_advice
from pytpc.diagnosis.suggestion.what_if import what_if
from pytpc.ingest import Recording
from pytpc.present.as_json import blame_json, group_json, what_if_json
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import MARK_TYPES, MarkType
from pytpc.static.parameters import parameter_name, same_parameter
from pytpc.static.static_info import Comparison, StaticInfo
from pytpc.values.declared_files import declared_in

_WHAT: dict[MarkType | None, str] = {
    "I": "type I, did what it should not",
    "II": "type II, does not do what it should",
    None: "no type",
}
_TRUTHS = {"true": True, "false": False}
_LONGEST = 40


@click.command("suggest")
@click.argument("recording", type=PATH)
@click.argument("parameter", required=False)
@STATIC
@click.option(
    "--value",
    "value_text",
    metavar="V",
    help="Say what this value of PARAMETER would have changed, in place of looking for one.",
)
@click.option(
    "--reference",
    type=PATH,
    metavar="RECORDING",
    help="A mission of the same build that went right: its value is taken where it would do.",
)
@click.option(
    "--flown",
    type=float,
    multiple=True,
    metavar="V",
    help="An earlier value of PARAMETER with which the error was there; may be repeated.",
)
@TYPES
@WINDOW
@TOP
@JSON
def suggest_command(
    *,
    recording: Path,
    parameter: str | None,
    static_source: Path,
    value_text: str | None,
    reference: Path | None,
    flown: tuple[float, ...],
    types: Types,
    window_s: float,
    top: int,
    as_json: bool,
) -> None:
    """Say what to do with the suspects in RECORDING, and what it would have changed.

    First by all marks together, where that is not the same as at each mark; then at the marks. With
    PARAMETER it is about that one alone, wherever it stands in the ranking. A number below
    zero is given as --value=-1.
    """
    if value_text is not None and parameter is None:
        raise click.UsageError("--value needs a PARAMETER")
    if flown and parameter is None:
        raise click.UsageError("--flown needs a PARAMETER")
    value = None if value_text is None else _number(value_text)
    static = static_of([static_source])
    found = recording_of(recording)
    if not found.marks and value is None:
        raise InputError("no marks: mark it with `pytpc mark`, or ask for a --value", recording)
    check_reports(found, static, recording)
    warn_about(found, static)
    if types == "ignore":
        found = replace(found, marks=tuple(replace(mark, type=None) for mark in found.marks))
    if value is not None and parameter is not None:
        _show_value(found, static, parameter, value, window_s=window_s, as_json=as_json)
        return
    question = Question(types, window_s, top)
    rankings = rank_marks(found, static, question)
    if parameter is not None:
        rankings = _only(rankings, static, parameter)
    clean = None if reference is None else _clean(reference, static)
    declared = _declared(static, recording)
    with progress("replaying the mission") as advance:
        advance(0, len(rankings))
        question = replace(question, declared=declared, reference=clean, flown=flown)
        together = blame(found, static, question)
        asked = together if parameter is None else together.only(parameter)
        first = advise_blamed(asked, found, static, replace(question, top=1))
        groups = join_advice(found, static, rankings, question)
    if as_json:
        document = {
            "mission": found.name,
            "together": blame_json(together, first),
            "groups": [group_json(group, found.start_ns) for group in groups],
        }
        click.echo(json.dumps(document, indent=1, ensure_ascii=False))
        return
    parts = [_together(together, one, parameter) for one in first if not _is_said(one, groups)]
    for part in [*parts, *(_group(group, found, parameter) for group in groups)]:
        console().print(part, highlight=False)


COMMANDS: list[click.Command] = [suggest_command]


def _number(text: str) -> Number:
    """The value that is given: a whole number, a number, true or false.

    Raises:
        BadParameter: it is none of these.
    """
    if text.lower() in _TRUTHS:
        return _TRUTHS[text.lower()]
    try:
        value = float(text)
    except ValueError as error:
        raise click.BadParameter(
            f"{text!r} is no number, true or false", param_hint="--value"
        ) from error
    if value - value != 0:
        shown = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
        raise click.BadParameter(f"{shown!r} is not finite", param_hint="--value")
    try:
        return int(text)
    except ValueError:
        return value


def _clean(source: Path, static: StaticInfo) -> Recording:
    """A mission that went right.

    Raises:
        InputError: it cannot be read, or is of another build.
    """
    found = recording_of(source)
    check_reports(found, static, source)
    return found


def _declared(static: StaticInfo, source: Path) -> list[Declared]:
    return declared_in(static, [source], lambda line: warn(plain(line)))


def _only(rankings: Sequence[MarkRanking], static: StaticInfo, parameter: str) -> list[MarkRanking]:
    """The rankings with the one parameter, at the position that it has.

    Raises:
        InputError: nothing is known of it.
    """
    names = {parameter_name(found) for found in static.thresholds.values()}
    if not any(parameter == name or same_parameter(parameter, name) for name in names):
        raise InputError(f"no comparison with a parameter {plain(parameter)} is known")
    only = []
    for ranking in rankings:
        exact = [one for one in ranking.suspects if one.parameter == parameter]
        same = [one for one in ranking.suspects if same_parameter(parameter, one.parameter)]
        only.append(replace(ranking, suspects=tuple(exact or same)))
    return only


def _show_value(
    recording: Recording,
    static: StaticInfo,
    parameter: str,
    value: Number,
    *,
    window_s: float,
    as_json: bool,
) -> None:
    """What one value would have changed, for each type of mark that there is."""
    present = {mark.type for mark in recording.marks}
    kinds: list[MarkType | None] = [kind for kind in MARK_TYPES if kind in present]
    if None in present or not kinds:
        kinds = [None] if len(present) <= 1 else [*kinds, None]
    answers = []
    for kind in kinds:
        marks = [mark for mark in recording.marks if mark.type == kind]
        answers.append(
            (kind, what_if(
                recording, static, parameter, value,
                Question(kind=kind, marks=marks, window_s=window_s),
            ))
        )  # fmt: skip
    if as_json:
        items = [{"type": kind, **what_if_json(answer)} for kind, answer in answers]
        document = {"mission": recording.name, "what_if": items}
        click.echo(json.dumps(document, indent=1, ensure_ascii=False))
        return
    click.echo(plain(f"{answers[0][1].parameter} = {show(value)}:"))
    for _, answer in answers:
        click.echo(plain(f"  {answer.text}"))
    _tell_caveats(answers[0][1])


def _tell_caveats(answer: WhatIf) -> None:
    for caveat in answer.caveats:
        click.echo(plain(f"  note: {caveat}"))


def _is_said(first: BlamedAdvice, groups: Sequence[MarkGroup]) -> bool:
    """Whether what all marks say together is what each of them says."""
    if len(groups) != 1 or not groups[0].suspects:
        return False
    joined = groups[0].suspects[0]
    same = joined.advice.suspect.parameter == first.accused.parameter
    return same and joined.remedy.value == first.remedy.value


def _together(found: Blame, first: BlamedAdvice, parameter: str | None) -> RenderableType:
    """What all marks of a mission say of its first suspect, or of the one that is asked about."""
    accused, tried = first.accused, first.remedy
    said = f"{percent(accused.probability)} that it is {accused.parameter}"
    verdict = found.text if parameter is None else said
    line = Text(f"{accused.position}  ")
    if tried.value is None:
        line.append(plain(f"{tried.parameter}: {tried.reason}"), style="dim")
    else:
        line.append(plain(tried.text), style="bold")
    parts = [Text(plain(verdict)), line, _place(accused.comparison)]
    if first.what_if is not None:
        parts.append(Text(plain(f"   {first.what_if.text}")))
    title = Text(found.title, style="bold")
    return Padding(Group(title, *map(_indented, parts)), (0, 0, 1, 0), expand=False)


def _group(group: MarkGroup, recording: Recording, parameter: str | None) -> RenderableType:
    seconds = [f"{(mark.time_ns - recording.start_ns) / 1e9:.1f}" for mark in group.marks]
    title = f"{many(len(seconds), 'mark').capitalize()} at {_list(seconds)} s: {_WHAT[group.type]}"
    parts: list[RenderableType] = [Text(title, style="bold")]
    for reason in group.reasons:
        lack = Text(plain(f"not enough evidence: {reason}"), style="yellow")
        parts.append(_indented(lack))
    for number, joined in enumerate(group.suspects, start=1):
        parts.append(_indented(_suspect(number, joined, len(seconds))))
    if not group.suspects:
        nobody = "no parameter has a score here"
        what = nobody if parameter is None else f"{parameter} has no score here"
        parts.append(_indented(Text(plain(what))))
    return Padding(Group(*parts), (0, 0, 1, 0), expand=False)


def _indented(part: RenderableType) -> RenderableType:
    return Padding(part, (0, 0, 0, 2), expand=False)


def _list(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def _suspect(number: int, joined: JoinedAdvice, marks: int) -> RenderableType:
    advice = joined.advice
    tried, smallest, found = joined.remedy, advice.suggestion, advice.suspect.comparison
    line = Text(f"{number}  ")
    if tried.value is None:
        line.append(plain(f"{smallest.parameter}: {smallest.reason or tried.reason}"), style="dim")
    else:
        line.append(plain(tried.text), style="bold" if number == 1 else "")
    lines = [line]
    lines.append(_place(found))
    if joined.what_if is not None:
        lines.append(Text(plain(f"   {joined.what_if.text}")))
    if smallest.value is not None and smallest.value != tried.value:
        lines.append(Text(plain(f"   the smallest change: {smallest.text}")))
    if marks > 1 and joined.agreed < marks:
        lines.append(
            Text(f"   among the first suspects at {joined.named} of {many(marks, 'mark')}")
        )
    if advice.declared is not None:
        lines.append(Text(plain(f"   declared at {advice.declared.place}"), style="dim"))
    return Group(*lines)


def _place(found: Comparison) -> Text:
    place = plain(f"{found.file}:{found.lineno}")
    code = f"  {plain(found.source_code.strip())}" if found.source_code else ""
    return Text(f"   {place}{code}", style="dim")
