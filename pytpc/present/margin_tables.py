"""How near comparisons came to turning, as tables and as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import ceil
from typing import NamedTuple

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from pytpc.base.wording import many, percent, plain
from pytpc.diagnosis.results.behaviour import Behaviour, OverMissions
from pytpc.diagnosis.results.turn_groups import GroupMember, TurnGroup
from pytpc.present.as_json import Json, finite
from pytpc.present.listing import Heading, Listing

_PARAMETER = Heading("Parameter", in_line=True)
_BEHAVIOUR = (
    _PARAMETER,
    Heading("Nearest", right=True, in_line=True),
    Heading("Margin", right=True),
    Heading("5 to 95 %", right=True),
    Heading("True", right=True),
    Heading("Turns", right=True),
    Heading("Misses", right=True),
    Heading("Undecided", right=True),
    Heading("Drift"),
    Heading("Compared at"),
)
_TERMS = (
    "Nearest: the smallest margin, as a part of the range of all values and thresholds. Margin: the"
    " median of |value - threshold| over time. Misses: how often it came near, below 5 %, and left"
    " without turning. Undecided: the share of time in which it was near."
)
_OVER = "Margin: the median of each mission. Trend: the change from one mission to the next."


def print_behaviours(
    console: Console, title: str, rows: Sequence[Behaviour], groups: Sequence[TurnGroup], rest: int
) -> None:
    """Print what the comparisons of a mission did; ``rest`` counts those that are left out."""
    parts: list[RenderableType] = [Text(plain(title), style="bold")]
    if rows:
        cells = [_cells(one) for one in rows]
        parts.append(_indented(Listing(_BEHAVIOUR, cells, one_line=not console.is_terminal)))
    if rest:
        parts.append(_indented(Text(f"and {rest:,} more: --top shows more", style="dim")))
    parts += [_indented(Text(plain(group_text(one)))) for one in groups]
    if rows:
        parts.append(_indented(Text(_TERMS, style="dim")))
    console.print(Padding(Group(*parts), (0, 0, 1, 0), expand=False), highlight=False)


def print_over_missions(
    console: Console, names: Sequence[str], rows: Sequence[OverMissions], rest: int
) -> None:
    """Print the median margins of each comparison over missions."""
    headings = (
        _PARAMETER,
        *(Heading(plain(name), right=True) for name in names),
        Heading("Trend"),
        Heading("Compared at"),
    )
    cells = [
        [
            Text(plain(one.parameter)),
            *(Text(median_text(each)) for each in one.behaviours),
            Text(_trend(one), style="bold" if one.zero_in is not None else ""),
            Text(plain(one.place)),
        ]
        for one in rows
    ]
    parts: list[RenderableType] = [Text(f"{many(len(names), 'mission')}", style="bold")]
    parts.append(_indented(Listing(headings, cells, one_line=not console.is_terminal)))
    if rest:
        parts.append(_indented(Text(f"and {rest:,} more: --top shows more", style="dim")))
    parts.append(_indented(Text(_OVER, style="dim")))
    console.print(Padding(Group(*parts), (0, 0, 1, 0), expand=False), highlight=False)


def group_text(group: TurnGroup) -> str:
    """The members of a group, each with how long after the first it turned."""
    nodes: dict[str, set[str]] = {}
    for one in group.members:
        nodes.setdefault(one.parameter, set()).add(one.node)
    named: dict[str, list[GroupMember]] = {}
    for one in group.members:
        node = f" in {one.node}" if len(nodes[one.parameter]) > 1 else ""
        named.setdefault(f"{one.parameter}{node}", []).append(one)
    told: list[str] = []
    for name, same in named.items():
        said = [many(len(same), "comparison")] if len(same) > 1 else []
        if group.kind == "in order" and told:
            said.append(f"{same[0].after_s:.1f} s later")
        told.append(f"{name} ({', '.join(said)})" if said else name)
    return f"One group: {', '.join(told)} {group.text}"


def _indented(part: RenderableType) -> RenderableType:
    return Padding(part, (0, 0, 0, 2), expand=False)


class BehaviourTexts(NamedTuple):
    """A comparison as texts; those that are empty have no value."""

    parameter: str
    nearest: str
    median: str
    spread: str
    true: str
    turns: str
    misses: str
    undecided: str
    drift: str
    place: str

    @classmethod
    def of(cls, one: Behaviour) -> BehaviourTexts:
        """How every output says it."""
        found = one.margins
        return cls(
            parameter=one.parameter,
            nearest="" if one.nearest is None else percent(one.nearest),
            median=median_text(one),
            spread="" if found is None else f"{short(found.low)} to {short(found.high)}",
            true=percent(one.true_share),
            turns=f"{one.turns:,}",
            misses="" if found is None else f"{one.near_misses:,}",
            undecided="" if one.undecided is None else percent(one.undecided),
            drift=one.drift_text,
            place=one.place,
        )


def _cells(one: Behaviour) -> list[Text]:
    cells = [Text(plain(text)) for text in BehaviourTexts.of(one)]
    if one.is_near:
        cells[1].stylize("bold")
    return cells


def short(value: float) -> str:
    """A margin to compare with others at a glance."""
    return f"{value:.3g}"


def median_text(one: Behaviour | None) -> str:
    """The median margin; empty if there is none."""
    return "" if one is None or one.margins is None else short(one.margins.median)


def _trend(one: OverMissions) -> str:
    if one.trend is None:
        return ""
    left = "" if one.zero_in is None else f": 0 in {many(ceil(one.zero_in), 'mission')}"
    return f"{short(one.trend)} a mission{left}"


def behaviour_json(one: Behaviour) -> Json:
    """A comparison of a mission."""
    return {
        "parameter": one.parameter,
        "node": one.node,
        "key": one.key,
        "file": one.comparison.file,
        "lineno": one.comparison.lineno,
        "source_code": one.comparison.source_code,
        "evaluations": one.evaluations,
        "seconds": one.seconds,
        "margins": None if one.margins is None else one.margins._asdict(),
        "unit": one.unit,
        "range": finite(one.reach),
        "nearest": one.nearest,
        "true_share": one.true_share,
        "turns": one.turns,
        "turns_per_minute": one.turns_per_minute,
        "near_misses": one.near_misses,
        "undecided": one.undecided,
        "drift": None if one.drift is None else asdict(one.drift),
    }


def over_json(one: OverMissions) -> Json:
    """A comparison over missions."""
    return {
        "parameter": one.parameter,
        "node": one.node,
        "key": one.key,
        "medians": [
            None if each is None or each.margins is None else each.margins.median
            for each in one.behaviours
        ],
        "trend": one.trend,
        "zero_in": one.zero_in,
    }
