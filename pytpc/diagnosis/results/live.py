"""What ``pytpc watch`` shows of a running mission."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from pytpc.diagnosis.results.suspects import MarkRanking, Suspect
from pytpc.diagnosis.results.turn_groups import TurnGroup
from pytpc.recording.marks import Mark, MarkType

_NAMED = 3


class Seen(NamedTuple):
    """One evaluation, as it was reported."""

    time_ns: int
    key: str
    node: str
    result: bool
    cmp: float
    thresh: float
    res: bool


class TrendPart(NamedTuple):
    """What a comparison did in one part of the window.

    ``distance`` is the mean of |cmp - thresh| over max - min, as D of the score of type II: 0 is on
    the threshold, NaN means not evaluated. ``flopped`` says whether the result changed.
    """

    distance: float
    flopped: bool


@dataclass(frozen=True, slots=True)
class LiveRow:
    """A suspect with the last ``parts`` of its comparison, the seconds since its last flop (None
    before the first), and its last evaluation (None if there are only summaries)."""

    suspect: Suspect
    last: Seen | None
    flop_s: float | None
    parts: tuple[TrendPart, ...]


@dataclass(frozen=True, slots=True)
class Look:
    """What to show of one instant: the rows by type (None: both combined), the reasons if there are
    none, and the groups of comparisons that turn as one."""

    now_ns: int
    rows: Mapping[MarkType | None, tuple[LiveRow, ...]]
    reasons: Mapping[MarkType | None, str]
    parameters: int
    groups: tuple[TurnGroup, ...] = ()

    def group_of(self, row: LiveRow) -> TurnGroup | None:
        """The group of a suspect's comparison."""
        node = None if row.last is None else row.last.node
        for group in self.groups:
            if any((one.key, one.node) == (row.suspect.key, node) for one in group.members):
                return group
        return None


class Kept(NamedTuple):
    """A mark with what was known when it was made."""

    mark: Mark
    ranking: MarkRanking
    look: Look

    def words(self) -> str:
        """The first suspects, or the reason why there are none."""
        (rows,), (reason,) = self.look.rows.values(), self.look.reasons.values()
        firsts = [row.suspect for row in rows[:_NAMED]]
        named = [f"{one.position}{'=' if one.tied else ''} {one.parameter}" for one in firsts]
        return ", ".join(named) or reason or "no parameter has a score"
