"""Suggestions as text for a terminal: by all marks together, and by marks with the same answer."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from pytpc.base.wording import many, percent, plain
from pytpc.diagnosis.results.advice import BlamedAdvice, JoinedAdvice, MarkGroup
from pytpc.diagnosis.results.suspects import Blame
from pytpc.present.ranking_tables import TYPE_WORDS, indented
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Comparison


def together_text(found: Blame, first: BlamedAdvice, parameter: str | None) -> RenderableType:
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
    return Padding(Group(title, *map(indented, parts)), (0, 0, 1, 0), expand=False)


def group_text(group: MarkGroup, recording: Recording, parameter: str | None) -> RenderableType:
    """What to do at marks that say the same."""
    seconds = [f"{(mark.time_ns - recording.start_ns) / 1e9:.1f}" for mark in group.marks]
    title = (
        f"{many(len(seconds), 'mark').capitalize()} at {_list(seconds)} s: {TYPE_WORDS[group.type]}"
    )
    parts: list[RenderableType] = [Text(title, style="bold")]
    for reason in group.reasons:
        lack = Text(plain(f"not enough evidence: {reason}"), style="yellow")
        parts.append(indented(lack))
    for number, joined in enumerate(group.suspects, start=1):
        parts.append(indented(_suspect(number, joined, len(seconds))))
    if not group.suspects:
        nobody = "no parameter has a score here"
        what = nobody if parameter is None else f"{parameter} has no score here"
        parts.append(indented(Text(plain(what))))
    return Padding(Group(*parts), (0, 0, 1, 0), expand=False)


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
