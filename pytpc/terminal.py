"""Rankings as tables for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from pytpc.advice.declared import Declared, declared_for
from pytpc.advice.suggest import Suggestion, suggest
from pytpc.ingest.recording import Recording
from pytpc.scoring.ranking import MarkRanking, Suspect
from pytpc.scoring.scores import WINDOW_S
from pytpc.static_info import StaticInfo
from pytpc.words import exact, plain, show

_WHAT = {
    "I": "type I, did what it should not",
    "II": "type II, does not do what it should",
    None: "no type",
}
_WAYS = {"raise": "raise to", "lower": "lower to", "switch": "switch to"}


@dataclass(frozen=True, slots=True)
class Row:
    """A suspect with what is suggested for it."""

    suspect: Suspect
    advice: Suggestion


def rows_of(
    ranking: MarkRanking,
    recording: Recording,
    static_info: StaticInfo,
    top: int,
    *,
    declared: Sequence[Declared] = (),
    window_s: float = WINDOW_S,
) -> list[Row]:
    """The first ``top`` suspects at a mark, each with its suggestion.

    ``declared`` is what is declared of parameters, ``window_s`` the window of type II in seconds:
    the one that ranked them.
    """
    return [
        Row(
            suspect,
            suggest(
                recording.events,
                suspect.comparison,
                ranking.mark.time_ns,
                suspect.type,
                unit=static_info.unit_of(suspect.key),
                window_s=window_s,
                summaries=recording.summaries,
                declared=declared_for(declared, suspect, static_info.source_path(suspect.key)),
            ),
        )
        for suspect in ranking.suspects[:top]
    ]


def print_rankings(
    console: Console,
    recording: Recording,
    rankings: Sequence[tuple[MarkRanking, list[Row]]],
) -> None:
    """Print a table for each mark: position, parameter, value, suggestion, source line, score."""
    for number, (ranking, rows) in enumerate(rankings, start=1):
        console.print(_mark(number, ranking, recording, rows), highlight=False)


def _mark(
    number: int, ranking: MarkRanking, recording: Recording, rows: list[Row]
) -> RenderableType:
    mark = ranking.mark
    seconds = (mark.time_ns - recording.start_ns) / 1e9
    by = f", by {mark.observer}" if mark.observer else ""
    title = Text(f"Mark {number} at {seconds:.1f} s: {_WHAT[mark.type]}{plain(by)}", style="bold")
    heading: list[RenderableType] = [title]
    if not ranking.enough:
        heading.append(Padding(_lack(ranking), (0, 0, 0, 2)))
    if not rows:
        return Padding(Group(*heading), (0, 0, 1, 0))
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
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


def _lack(ranking: MarkRanking) -> Text:
    return Text(plain(f"not enough evidence: {ranking.reason}"), style="yellow")


def _cells(row: Row, mixed: bool) -> list[Text]:
    suspect, advice = row.suspect, row.advice
    found = suspect.comparison
    current = advice.current if advice.current is not None else suspect.last.thresh
    place = Text(plain(f"{found.file}:{found.lineno}"))
    if found.source_code:
        place.append("\n" + plain(found.source_code.strip()), style="dim")
    if advice.direction is None:
        what = Text(plain(f"none: {advice.reason}"), style="dim")
    else:
        what = Text(f"{_WAYS[advice.direction]} ").append(exact(advice.value), style="bold")
    return [
        Text(f"{suspect.position}=" if suspect.tied else str(suspect.position)),
        Text(plain(suspect.parameter), style="bold" if suspect.position == 1 else ""),
        Text(show(current)),
        what,
        *([Text(suspect.type)] if mixed else []),
        Text(f"{suspect.score:.3g}"),
        place,
    ]
