"""How near the comparisons of a mission came to turning, as a table of the page."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.base.wording import percent
from pytpc.diagnosis.results.behaviour import Behaviour
from pytpc.diagnosis.results.mission_answer import MissionAnswer
from pytpc.present.margin_tables import group_text, short

MOST = 100
"""So many comparisons are in the table."""


@dataclass(frozen=True)
class BehaviourView:
    """A comparison, as a row; texts that are empty have no value."""

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


@dataclass(frozen=True)
class MarginsView:
    """The rows, the nearest to turning first; how many are left out; the groups, in words."""

    rows: list[BehaviourView]
    more: int
    groups: list[str]


def margins_view(answer: MissionAnswer) -> MarginsView:
    """The table of a mission."""
    found = answer.behaviours
    return MarginsView(
        [_row(one) for one in found[:MOST]],
        max(0, len(found) - MOST),
        [group_text(one) for one in answer.groups],
    )


def _row(one: Behaviour) -> BehaviourView:
    margins = one.margins
    return BehaviourView(
        parameter=one.parameter,
        nearest="" if one.nearest is None else percent(one.nearest),
        median="" if margins is None else short(margins.median),
        spread="" if margins is None else f"{short(margins.low)} to {short(margins.high)}",
        true=percent(one.true_share),
        turns=f"{one.turns:,}",
        misses="" if margins is None else f"{one.near_misses:,}",
        undecided="" if one.undecided is None else percent(one.undecided),
        drift=one.drift_text,
        place=one.place,
    )
