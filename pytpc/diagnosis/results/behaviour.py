"""How near the comparisons of a mission came to turning, and how that changed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from pytpc.static.link_unit import Comparison

NEAR = 0.05
"""A margin of at most this part of the range of all values and thresholds is near."""


class Distribution(NamedTuple):
    """Of margins, weighted by time: the smallest, and what 5, 50 and 95 % of the time are below."""

    least: float
    low: float
    median: float
    high: float


@dataclass(frozen=True, slots=True)
class Drift:
    """The margin rises or falls over time: ``per_minute`` in its unit.

    ``turns_in_s`` is after how many seconds of watching it would be 0; None if it rises.
    """

    per_minute: float
    turns_in_s: float | None


@dataclass(frozen=True, slots=True)
class Behaviour:
    """What a comparison did in a node over a mission.

    Attributes:
        key: of the comparison, with the number of its instance.
        node: that evaluated it.
        parameter: its name in this mission.
        comparison: what the analysis found.
        evaluations: how many there were.
        seconds: for how long it was evaluated; pauses do not count.
        margins: |value - threshold|, in the parameter's ``unit`` if that is known; None for flags,
            text and values that are no numbers.
        unit: ``parameter``, or ``value`` if the arithmetic from the parameter has other numbers.
        reach: the range of the values and thresholds in the same unit.
        true_share: the share of its seconds in which its result was true.
        turns: how often its result changed.
        near_misses: how often the value came near to the threshold and left without turning.
        undecided: the share of its seconds in which the value was near; None without margins.
        drift: if the margin clearly rises or falls; else None.
    """

    key: str
    node: str
    parameter: str
    comparison: Comparison
    evaluations: int
    seconds: float
    margins: Distribution | None
    unit: str
    reach: float
    true_share: float
    turns: int
    near_misses: int
    undecided: float | None
    drift: Drift | None

    @property
    def place(self) -> str:
        """Where it is compared: ``file:line``."""
        return f"{self.comparison.file}:{self.comparison.lineno}"

    @property
    def turns_per_minute(self) -> float:
        """How often it turns."""
        return 60.0 * self.turns / self.seconds if self.seconds > 0 else 0.0

    @property
    def nearest(self) -> float | None:
        """The smallest margin as a part of its reach: 0 on the threshold."""
        if self.margins is None or self.reach <= 0:
            return None
        return self.margins.least / self.reach

    @property
    def is_near(self) -> bool:
        """Whether it came near to its threshold, or turned."""
        return self.nearest is not None and self.nearest <= NEAR

    @property
    def drift_text(self) -> str:
        """``-0.02 a minute: 0 in 4.1 min``; empty without a drift."""
        if self.drift is None:
            return ""
        rate = f"{self.drift.per_minute:.3g} a minute"
        left = self.drift.turns_in_s
        if left is None:
            return rate
        return f"{rate}: 0 in {f'{left:.0f} s' if left < 120.0 else f'{left / 60.0:.0f} min'}"


@dataclass(frozen=True, slots=True)
class OverMissions:
    """A comparison over several missions, in their order; None where one did not evaluate it.

    ``trend`` is by how much the median margin changes from one mission to the next, if it clearly
    rises or falls; ``zero_in`` after how many more missions it would be 0.
    """

    key: str
    node: str
    parameter: str
    comparison: Comparison
    behaviours: tuple[Behaviour | None, ...]
    trend: float | None
    zero_in: float | None

    @property
    def place(self) -> str:
        """Where it is compared: ``file:line``."""
        return f"{self.comparison.file}:{self.comparison.lineno}"
