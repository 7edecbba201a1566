"""Rankings as tables, and suggestions as lines, for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from pytpc.base.wording import exact, many, percent, plain, show, shown_value
from pytpc.diagnosis.results.advice import (
    BlamedAdvice,
    JoinedAdvice,
    MarkGroup,
    Remedy,
    Suggested,
    Suggestion,
)
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.differences import Difference, RunDifferences
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.present.listing import Heading, Listing
from pytpc.recording.marks import MarkType
from pytpc.recording.mission import Recording

_TYPE_WORDS = {
    "I": "type I, did what it should not",
    "II": "type II, does not do what it should",
    None: "no type",
}
_KINDS: dict[MarkType, str] = {"I": "I: did", "II": "II: does not"}
_DIFFERENCES = 8
_TERMS = (
    "Type I: it did what it should not. Type II: it does not do what it should. None of the"
    " parameters: a fault in the code, or something around the robot."
)
_SCORES = "The lower the score, the more suspicious. `pytpc rank --help` explains the terms."
_NUMBER = Heading("#", right=True, in_line=True)
_PARAMETER = Heading("Parameter", in_line=True)
_COMPARED = Heading("Compared at")
_BLAMED = (
    _NUMBER,
    _PARAMETER,
    Heading("Probability", right=True, in_line=True),
    Heading("Type", in_line=True),
    Heading("Value", right=True),
    Heading("To try"),
    _COMPARED,
)
_DIFFERING = (
    _PARAMETER,
    Heading("Good run", right=True),
    Heading("This run", right=True),
    Heading("Set at"),
    Heading("What it changed"),
)
_BY_TYPE = Heading("By type")
_RANKED = (
    _NUMBER,
    _PARAMETER,
    Heading("Value", right=True),
    Heading("Suggestion"),
    _BY_TYPE,
    Heading("Score", right=True),
    _COMPARED,
)
_WAYS = {"raise": "raise to", "lower": "lower to", "switch": "switch to"}


def print_rankings(
    console: Console,
    recording: Recording,
    rankings: Sequence[tuple[MarkRanking, list[Suggested]]],
) -> None:
    """Print a table for each mark: position, parameter, value, suggestion, source line, score."""
    for number, (ranking, rows) in enumerate(rankings, start=1):
        console.print(_mark(console, number, (ranking, rows), recording), highlight=False)
    if rankings:
        console.print(_indented(Text(_SCORES, style="dim")), highlight=False)


def print_diagnosis(console: Console, found: Diagnosis) -> None:
    """Print the answer about a mission: what differs, the verdict, and the suspects with advice."""
    blame = found.blame
    if found.differences is not None:
        print_differences(console, found.differences)
    parts: list[RenderableType] = [Text(blame.title, style="bold"), _verdict(found)]
    parts += [_indented(Text(plain(note), style="yellow")) for note in blame.notes]
    if found.shown:
        rows = [
            _blamed_cells(one, with_first=place > 0)
            for group in found.by_group
            for place, one in enumerate(group)
        ]
        parts.append(_indented(_listing(console, _BLAMED, rows)))
    parts += [_indented(Text(plain(one.sentence))) for one in found.groups]
    parts += [_indented(line) for one in found.shown for line in _followed(one)]
    if found.folded_text:
        parts.append(_indented(Text(found.folded_text, style="dim")))
    if found.shown:
        parts.append(_indented(Text(_TERMS, style="dim")))
    console.print(Padding(Group(*parts), (0, 0, 1, 0), expand=False), highlight=False)


def _followed(one: BlamedAdvice) -> list[Text]:
    """What other nodes did after the comparison of a suspect turned; one path is enough here."""
    name = one.accused.parameter
    return [Text(plain(f"{name} {each.sentence}")) for each in one.accused.followed[:1]]


def _verdict(found: Diagnosis) -> RenderableType:
    style = "bold" if found.accused is not None else "yellow"
    return _indented(Text(plain(found.headline), style=style))


def print_differences(
    console: Console, found: RunDifferences, *, most: int | None = _DIFFERENCES, each: bool = False
) -> None:
    """Print what differs from good runs.

    Args:
        console: where to.
        found: the differences.
        most: how many are listed; None: all.
        each: also print what became of each replayed comparison, and the full names.
    """
    parts: list[RenderableType] = [Text(plain(found.title), style="bold")]
    if found.found:
        rows = [_difference_cells(one, each=each) for one in found.found[:most]]
        parts.append(_indented(_listing(console, _DIFFERING, rows)))
        if most is not None and len(found.found) > most:
            more = f"and {len(found.found) - most:,} more: `pytpc diff GOOD BAD` shows all"
            parts.append(_indented(Text(more, style="dim")))
    parts += [_indented(Text(plain(note), style="yellow")) for note in found.notes]
    console.print(Padding(Group(*parts), (0, 0, 1, 0), expand=False), highlight=False)


def _difference_cells(one: Difference, *, each: bool) -> list[Text]:
    effect = Text(plain(one.effect), style="" if one.turned else "dim")
    # What became of the only comparison is said already.
    is_only = len(one.replayed) == len(one.compared_at) == 1
    for replayed in one.replayed if each else ():
        first = "" if replayed.first_s is None else f", first at {replayed.first_s:.1f} s"
        of = f"{replayed.turned:,} of {replayed.evaluations:,}"
        effect.append(first if is_only else f"\n{plain(replayed.place)}: {of}{first}")
        if replayed.source_code:
            effect.append(f"\n{plain(replayed.source_code)}", style="dim")
    return [
        Text(plain(one.parameter if each else one.name), style="bold" if one.turned else ""),
        Text(shown_value(one.good.value)),
        Text(shown_value(one.bad.value)),
        Text(plain(one.bad.place)),
        effect,
    ]


def _blamed_cells(one: BlamedAdvice, *, with_first: bool) -> list[Text]:
    """The cells of a suspect; ``with_first``: it is shown below another one of its group."""
    accused, tried = one.accused, one.remedy
    name = plain(accused.parameter)
    return [
        Text(f"{accused.position}=" if accused.tied else str(accused.position)),
        Text(f"with {name}" if with_first else name, style="bold" if accused.position == 1 else ""),
        Text(percent(accused.probability)),
        Text("" if accused.type is None else _KINDS[accused.type]),
        Text(one.current),
        _advised(tried),
        _place(accused.place, accused.condition),
    ]


def _mark(
    console: Console,
    number: int,
    ranked: tuple[MarkRanking, list[Suggested]],
    recording: Recording,
) -> RenderableType:
    ranking, rows = ranked
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
    # Scores of both types stand in one list where the mark's type is not all that counts.
    mixed = any(row.suspect.type != mark.type for row in rows)
    headings = [one for one in _RANKED if mixed or one is not _BY_TYPE]
    listing = _listing(console, headings, [_cells(row, mixed) for row in rows])
    return Group(*heading, Padding(listing, (0, 0, 1, 2), expand=False))


def _listing(
    console: Console, headings: Sequence[Heading], rows: Sequence[Sequence[Text]]
) -> Listing:
    return Listing(headings, rows, one_line=not console.is_terminal)


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
        _place(suspect.place, suspect.condition),
    ]


def _advised(found: Suggestion | Remedy) -> Text:
    if found.direction is None:
        return Text(plain(f"none: {found.reason}"), style="dim")
    return Text(f"{_WAYS[found.direction]} ").append(exact(found.value), style="bold")


def _place(place: str, condition: str) -> Text:
    """The source line and the condition below it, if it is known."""
    text = Text(plain(place))
    if condition:
        text.append("\n" + plain(condition), style="dim")
    return text


def print_suggestions(console: Console, found: Diagnosis, parameter: str | None) -> None:
    """Print what all marks of a mission say: the verdict, and what to try for each suspect.

    With ``parameter``, only that one is shown, however likely it is.
    """
    parts: list[RenderableType] = [Text(found.blame.title, style="bold")]
    shown = found.shown if parameter is None else found.advice
    if parameter is None:
        parts.append(_verdict(found))
        parts += [_indented(Text(plain(note), style="yellow")) for note in found.blame.notes]
    parts += [_indented(_suggested(found, one)) for one in shown]
    if parameter is None:
        parts += [_indented(Text(plain(one.sentence))) for one in found.groups]
    if parameter is None and found.folded_text:
        parts.append(_indented(Text(found.folded_text, style="dim")))
    console.print(Padding(Group(*parts), (0, 0, 1, 0), expand=False), highlight=False)


def _suggested(found: Diagnosis, one: BlamedAdvice) -> RenderableType:
    accused, tried = one.accused, one.remedy
    line = Text(f"{accused.position}  ")
    style = "bold" if one is found.to_try else ""
    if tried.value is None:
        line.append(plain(f"{tried.parameter}: {tried.reason}"), style="dim")
    else:
        line.append(plain(tried.text), style=style)
    lines = [line, Text(f"   {percent(accused.probability)} that it is this one", style=style)]
    lines.append(_place_line(accused.place, accused.condition))
    if one.what_if is not None:
        lines.append(Text(plain(f"   {one.what_if.text}")))
    lines += [Text(plain(f"   it {each.sentence}")) for each in accused.followed]
    smallest = tried.smallest
    if smallest is not None and smallest.value not in {None, tried.value}:
        lines.append(Text(plain(f"   the smallest change: {smallest.text}")))
    return Group(*lines)


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
    tried, smallest, suspect = joined.remedy, advice.suggestion, advice.suspect
    line = Text(f"{number}  ")
    if tried.value is None:
        line.append(plain(f"{smallest.parameter}: {smallest.reason or tried.reason}"), style="dim")
    else:
        line.append(plain(tried.text), style="bold" if number == 1 else "")
    lines = [line, _place_line(suspect.place, suspect.condition)]
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


def _place_line(place: str, condition: str) -> Text:
    """The same in one line."""
    return Text(plain(f"   {place}  {condition}".rstrip()), style="dim")
