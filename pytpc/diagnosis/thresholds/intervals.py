"""Sets of numbers as a few intervals, with or without their ends.

A set is a tuple of disjoint intervals in ascending order.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

from pytpc.base.wording import show


@dataclass(frozen=True, slots=True)
class Interval:
    """All numbers from ``low`` to ``high``; an infinite end is never included."""

    low: float = -math.inf
    high: float = math.inf
    low_inclusive: bool = False
    high_inclusive: bool = False

    @classmethod
    def point(cls, value: float) -> Interval:
        """The one number ``value``."""
        return cls(value, value, True, True)

    @classmethod
    def above(cls, low: float, inclusive: bool = False) -> Interval:
        """All numbers above ``low``, and ``low`` itself where ``inclusive``."""
        return cls(low, math.inf, inclusive and math.isfinite(low), False)

    @classmethod
    def below(cls, high: float, inclusive: bool = False) -> Interval:
        """All numbers below ``high``, and ``high`` itself where ``inclusive``."""
        return cls(-math.inf, high, False, inclusive and math.isfinite(high))

    @classmethod
    def closed(cls, low: float | None, high: float | None) -> Interval:
        """From ``low`` to ``high``, both in it; None is no end."""
        bottom = -math.inf if low is None else float(low)
        top = math.inf if high is None else float(high)
        return cls(bottom, top, math.isfinite(bottom), math.isfinite(top))

    def holds(self, value: float) -> bool:
        """Whether ``value`` lies in it."""
        above = value > self.low or (self.low_inclusive and value == self.low)
        below = value < self.high or (self.high_inclusive and value == self.high)
        return above and below

    @property
    def is_empty(self) -> bool:
        """Whether no double lies in it."""
        return self.first() > self.last()

    def first(self) -> float:
        """The smallest double in it; of one without a lower end the smallest finite one."""
        return self.low if self.low_inclusive else math.nextafter(self.low, math.inf)

    def last(self) -> float:
        """The largest double in it; of one without an upper end the largest finite one."""
        return self.high if self.high_inclusive else math.nextafter(self.high, -math.inf)

    def words(self) -> str:
        """``at least 3``, ``below 0.5``, ``from 1 to 2``, ``exactly 4``.

        >>> Interval.above(3).words(), Interval(1, 2, True, False).words()
        ('above 3', 'from 1 to below 2')
        """
        low, high = show(self.low), show(self.high)
        if self.low == self.high:
            return f"exactly {low}"
        if math.isinf(self.low) and math.isinf(self.high):
            return "any value"
        if math.isinf(self.high):
            return f"{'at least' if self.low_inclusive else 'above'} {low}"
        if math.isinf(self.low):
            return f"{'at most' if self.high_inclusive else 'below'} {high}"
        begin = f"from {low}" if self.low_inclusive else f"above {low}"
        return f"{begin} to {'' if self.high_inclusive else 'below '}{high}"


Intervals = tuple[Interval, ...]

EVERYWHERE: Intervals = (Interval(),)


def holds(intervals: Iterable[Interval], value: float) -> bool:
    """Whether ``value`` lies in one of them."""
    return any(interval.holds(value) for interval in intervals)


def union(intervals: Iterable[Interval]) -> Intervals:
    """The set of all that lies in one of ``intervals``, which may overlap and be in any order."""
    parts = sorted(
        (part for part in intervals if not part.is_empty),
        key=lambda part: (part.low, not part.low_inclusive),
    )
    result: list[Interval] = []
    for part in parts:
        if result and _touch(result[-1], part):
            before = result[-1]
            high, inclusive = max(
                (before.high, before.high_inclusive), (part.high, part.high_inclusive)
            )
            result[-1] = Interval(before.low, high, before.low_inclusive, inclusive)
        else:
            result.append(part)
    return tuple(result)


def intersection(first: Iterable[Interval], second: Iterable[Interval]) -> Intervals:
    """The set of all that lies in both."""
    others = tuple(second)
    return union(_both(one, other) for one in first for other in others)


def gaps(intervals: Intervals) -> Intervals:
    """What lies between the intervals of a set."""
    return tuple(
        Interval(one.high, other.low, not one.high_inclusive, not other.low_inclusive)
        for one, other in pairwise(intervals)
    )


def words(intervals: Intervals) -> str:
    """``at least 3 or below 0.5``; ``no value`` of the empty set."""
    return " or ".join(interval.words() for interval in intervals) or "no value"


def _touch(before: Interval, after: Interval) -> bool:
    """Whether no double is between two of which ``before`` does not begin later."""
    return after.first() <= math.nextafter(before.last(), math.inf)


def _both(one: Interval, other: Interval) -> Interval:
    low, low_exclusive = max((one.low, not one.low_inclusive), (other.low, not other.low_inclusive))
    high, high_inclusive = min((one.high, one.high_inclusive), (other.high, other.high_inclusive))
    return Interval(low, high, not low_exclusive, high_inclusive)
