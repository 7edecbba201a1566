"""Rankings as tables, and suggestions as lines, for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from pytpc.base.wording import exact, many, percent, plain, show
from pytpc.diagnosis.results.advice import (
    BlamedAdvice,
    JoinedAdvice,
    MarkGroup,
    Remedy,
    Suggested,
    Suggestion,
)
from pytpc.diagnosis.results.suspects import Blame, MarkRanking
from pytpc.recording.marks import MarkType
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Comparison

_TYPE_WORDS = {
    "I": "type I, did what it should not",
    "II": "type II, does not do what it should",
    None: "no type",
}
_KINDS: dict[MarkType, str] = {"I": "I: did", "II": "II: does not"}
_WAYS = {"raise": "raise to", "lower": "lower to", "switch": "switch to"}


def print_rankings(
    console: Console,
    recording: Recording,
    rankings: Sequence[tuple[MarkRanking, list[Suggested]]],
) -> None:
    """Print a table for each mark: position, parameter, value, suggestion, source line, score."""
    for number, (ranking, rows) in enumerate(rankings, start=1):
        console.print(_mark(number, ranking, recording, rows), highlight=False)


def print_blame(console: Console, blame: Blame, advice: Sequence[BlamedAdvice]) -> None:
    """Print what all marks say together: the verdict, and a table of the suspects with advice."""
    verdict = Text(plain(blame.text), style="bold" if blame.accused is not None else "yellow")
    parts: list[RenderableType] = [Text(blame.title, style="bold"), _indented(verdict)]
    parts += [_indented(Text(plain(note), style="yellow")) for note in blame.notes]
    if advice:
        table = _table()
        table.add_column("#", justify="right")
        table.add_column("Parameter", overflow="fold")
        table.add_column("Probability", justify="right")
        table.add_column("Type")
        table.add_column("Value", justify="right")
        table.add_column("To try", overflow="fold")
        table.add_column("Compared at", overflow="fold")
        for one in advice:
            table.add_row(*_blamed_cells(one))
        parts.append(_indented(table))
    console.print(Padding(Group(*parts), (0, 0, 1, 0), expand=False), highlight=False)


def _blamed_cells(one: BlamedAdvice) -> list[Text]:
    accused, tried = one.accused, one.remedy
    current = accused.last.thresh if tried.current is None else tried.current
    return [
        Text(f"{accused.position}=" if accused.tied else str(accused.position)),
        Text(plain(accused.parameter), style="bold" if accused.position == 1 else ""),
        Text(percent(accused.probability)),
        Text(_KINDS[accused.type]),
        Text(show(current)),
        _advised(tried),
        _place(accused.comparison),
    ]


def _mark(
    number: int, ranking: MarkRanking, recording: Recording, rows: list[Suggested]
) -> RenderableType:
    mark = ranking.mark
    seconds = (mark.time_ns - recording.start_ns) / 1e9
    by = f", by {mark.observer}" if mark.observer else ""
    title = Text(
        f"Mark {number} at {seconds:.1f} s: {_TYPE_WORDS[mark.type]}{plain(by)}", style="bold"
    )
    heading: list[RenderableType] = [title]
    if not ranking.enough:
        heading.append(_indented(_lack(ranking.reason)))
    if not rows:
        return Padding(Group(*heading), (0, 0, 1, 0))
    table = _table()
    table.add_column("#", justify="right")
    table.add_column("Parameter", overflow="fold")
    table.add_column("Value", justify="right")
    table.add_column("Suggestion", overflow="fold")
    # Scores of both types stand in one list where the mark's type is not all that counts.
    mixed = any(row.suspect.type != mark.type for row in rows)
    if mixed:
        table.add_column("By type")
    table.add_column("Score", justify="right")
    table.add_column("Compared at", overflow="fold")
    for row in rows:
        table.add_row(*_cells(row, mixed))
    return Group(*heading, Padding(table, (0, 0, 1, 2)))


def _table() -> Table:
    return Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))


def _indented(part: RenderableType) -> RenderableType:
    """A part below a title."""
    return Padding(part, (0, 0, 0, 2), expand=False)


def _lack(reason: str) -> Text:
    return Text(plain(f"not enough evidence: {reason}"), style="yellow")


def _cells(row: Suggested, mixed: bool) -> list[Text]:
    suspect, advice = row.suspect, row.suggestion
    current = advice.current if advice.current is not None else suspect.last.thresh
    return [
        Text(f"{suspect.position}=" if suspect.tied else str(suspect.position)),
        Text(plain(suspect.parameter), style="bold" if suspect.position == 1 else ""),
        Text(show(current)),
        _advised(advice),
        *([Text(suspect.type)] if mixed else []),
        Text(f"{suspect.score:.3g}"),
        _place(suspect.comparison),
    ]


def _advised(found: Suggestion | Remedy) -> Text:
    if found.direction is None:
        return Text(plain(f"none: {found.reason}"), style="dim")
    return Text(f"{_WAYS[found.direction]} ").append(exact(found.value), style="bold")


def _place(found: Comparison) -> Text:
    """The source line and the condition below it."""
    place = Text(plain(f"{found.file}:{found.lineno}"))
    if found.source_code:
        place.append("\n" + plain(found.source_code.strip()), style="dim")
    return place


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
    parts = [Text(plain(verdict)), line, _place_line(accused.comparison)]
    if first.what_if is not None:
        parts.append(Text(plain(f"   {first.what_if.text}")))
    title = Text(found.title, style="bold")
    return Padding(Group(title, *map(_indented, parts)), (0, 0, 1, 0), expand=False)


def group_text(group: MarkGroup, recording: Recording, parameter: str | None) -> RenderableType:
    """What to do at marks that say the same."""
    seconds = [f"{(mark.time_ns - recording.start_ns) / 1e9:.1f}" for mark in group.marks]
    marks = many(len(seconds), "mark").capitalize()
    title = f"{marks} at {_list(seconds)} s: {_TYPE_WORDS[group.type]}"
    parts: list[RenderableType] = [Text(title, style="bold")]
    for reason in group.reasons:
        parts.append(_indented(_lack(reason)))
    for number, joined in enumerate(group.suspects, start=1):
        parts.append(_indented(_suspect(number, joined, len(seconds))))
    if not group.suspects:
        nobody = "no parameter has a score here"
        what = nobody if parameter is None else f"{parameter} has no score here"
        parts.append(_indented(Text(plain(what))))
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
    lines = [line, _place_line(found)]
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


def _place_line(found: Comparison) -> Text:
    """The same in one line."""
    place = plain(f"{found.file}:{found.lineno}")
    code = f"  {plain(found.source_code.strip())}" if found.source_code else ""
    return Text(f"   {place}{code}", style="dim")
