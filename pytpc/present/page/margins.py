"""How near the comparisons of a mission came to turning, as a table of the page."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.diagnosis.results.mission_answer import MissionAnswer
from pytpc.present.margin_tables import BehaviourTexts, group_text

MOST = 100
"""So many comparisons are in the table."""


@dataclass(frozen=True)
class MarginsView:
    """The rows, the nearest to turning first; how many are left out; the groups, in words."""

    rows: list[BehaviourTexts]
    more: int
    groups: list[str]


def margins_view(answer: MissionAnswer) -> MarginsView:
    """The table of a mission."""
    found = answer.behaviours
    return MarginsView(
        [BehaviourTexts.of(one) for one in found[:MOST]],
        max(0, len(found) - MOST),
        [group_text(one) for one in answer.groups],
    )
