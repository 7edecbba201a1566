"""What ``pytpc live`` shows of single comparisons while a mission runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pytpc.diagnosis.results.live import Seen, TrendPart
from pytpc.static.link_unit import Comparison


@dataclass(frozen=True, slots=True)
class Compared:
    """A comparison with a parameter that was evaluated lately.

    Attributes:
        comparison: what the analysis found.
        parameter: the name of its parameter.
        last: its last evaluation, or the last one of a summary.
        since_ns: since when no change of its result is known: the last flop, or the first report.
        spread: the range of all its values and thresholds so far; 0 without one.
        parts: the window in parts, as in `LiveRow`.
    """

    comparison: Comparison
    parameter: str
    last: Seen
    since_ns: int
    spread: float
    parts: tuple[TrendPart, ...]


@dataclass(frozen=True, slots=True)
class NearRow:
    """A comparison with its margin.

    ``share`` is the margin over the range of its values so far (as D of the score of type II);
    None for a flag, a text, and one without a range. ``margin`` is in the parameter's unit if
    ``in_unit``, else in that of the compared value; None where ``share`` is.
    """

    compared: Compared
    share: float | None
    margin: float | None
    in_unit: bool


@dataclass(frozen=True, slots=True)
class TurningLook:
    """The comparisons of an instant.

    Attributes:
        near: those with a margin, the nearest to turning first.
        held: those whose result has been the same for a whole window, the nearest first.
        turns: the last flops, the newest first.
    """

    near: Sequence[NearRow]
    held: Sequence[NearRow]
    turns: Sequence[Seen]
