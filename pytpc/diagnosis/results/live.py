"""What ``pytpc watch`` shows of a running mission."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from pytpc.diagnosis.results.suspects import MarkRanking, Suspect
from pytpc.recording.marks import Mark, MarkType

_NAMED = 3


class Seen(NamedTuple):
    """One evaluation, as it came."""

    time_ns: int
    key: str
    node: str
    result: bool
    cmp: float
    thresh: float
    res: bool


class TrendPart(NamedTuple):
    """What a comparison did in one part of the window.

    ``distance`` is the mean of |cmp - thresh| over max - min (0 is on the threshold, as D of the
    score of type II), NaN where it was not evaluated; ``flopped`` says whether the result changed.
    """

    distance: float
    flopped: bool


@dataclass(frozen=True, slots=True)
class LiveRow:
    """A suspect as it is shown: ``parts`` are the last ``BINS`` of its comparison; ``flop_s`` are
    the seconds since its last flop, None where it has not flopped; ``last`` is its last evaluation,
    None where there are summaries alone."""

    suspect: Suspect
    last: Seen | None
    flop_s: float | None
    parts: tuple[TrendPart, ...]


@dataclass(frozen=True, slots=True)
class Look:
    """What is to be shown of one instant: the rows by type (None: both combined), and why there
    are none where there are none."""

    now_ns: int
    rows: Mapping[MarkType | None, tuple[LiveRow, ...]]
    reasons: Mapping[MarkType | None, str]
    parameters: int


class Kept(NamedTuple):
    """A mark with what was known when it was made."""

    mark: Mark
    ranking: MarkRanking
    look: Look

    def words(self) -> str:
        """The first suspects, or why there is none."""
        (rows,), (reason,) = self.look.rows.values(), self.look.reasons.values()
        firsts = [row.suspect for row in rows[:_NAMED]]
        named = [f"{one.position}{'=' if one.tied else ''} {one.parameter}" for one in firsts]
        return ", ".join(named) or reason or "no parameter has a score"
