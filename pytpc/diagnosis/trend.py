"""Whether a series rises or falls, and how fast, without an assumption about its noise.

The slope is the median of those of all pairs of points (Theil 1950, Sen 1968). It counts if chance
would order the points so seldom: the test of Mann (1945) and Kendall, with the exact distribution
for few points.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import ceil, erfc, factorial, floor, sqrt
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Floats, Int64s, frozen

CHANCE = 0.01
"""How likely a slope is to be seen where there is none."""

_EXACT = 40
_WIDTH = 1.96


class Trend(NamedTuple):
    """``slope`` is per unit of the times; ``chance`` that of an order that is at least as clear."""

    slope: float
    chance: float

    @property
    def is_clear(self) -> bool:
        """Whether the series rises or falls."""
        return self.slope != 0.0 and self.chance <= CHANCE


def trend_of(times: Floats, values: Floats) -> Trend | None:
    """The trend of a series; None with fewer than two points.

    Args:
        times: float64[n], rising.
        values: float64[n], finite.
    """
    if times.size < 2:
        return None
    steps, slopes = _pairs_of(times, values)
    order = int(np.sign(steps).sum())
    return Trend(float(np.median(slopes)), _chance(order, values))


class Line(NamedTuple):
    """A line through a series: ``slope`` per unit of the times, and the value at time 0."""

    slope: float
    start: float

    def at(self, time: float) -> float:
        """The value at a time."""
        return self.start + self.slope * time

    @property
    def zero(self) -> float | None:
        """When it falls to 0; None if it does not fall."""
        return -self.start / self.slope if self.slope < 0 else None


def joint_trend(series: Sequence[tuple[Floats, Floats]]) -> Trend | None:
    """The trend that several series share; None if each has fewer than two points.

    Only points of one series are compared, so that their levels and times do not matter: Kendall's
    sums are added up, and so are their variances (van Belle and Hughes 1984).

    Args:
        series: times, rising, and finite values, of each.
    """
    if len(series) == 1:
        return trend_of(*series[0])
    both = [_pairs_of(*one) for one in series]
    slopes = np.concatenate([slopes for _, slopes in both]) if both else np.empty(0)
    if not slopes.size:
        return None
    order = sum(int(np.sign(steps).sum()) for steps, _ in both)
    return Trend(float(np.median(slopes)), _by_normal(order, _spread(series)))


def lines_of(series: Sequence[tuple[Floats, Floats]]) -> tuple[Line, Line, Line]:
    """The line with the slope of `joint_trend`, and those with the ends of its 95 % interval.

    The interval are two of the slopes of all pairs, by the normal distribution of Kendall's sum
    (Sen 1968). Each line has the median distance 0 to the points of the median series.

    Args:
        series: as for `joint_trend`; one has at least two points.
    """
    slopes = np.sort(np.concatenate([_pairs_of(*one)[1] for one in series]))
    off = _WIDTH * sqrt(max(0, _spread(series)) / 18.0)
    low = max(0, floor((slopes.size - off) / 2.0) - 1)
    high = min(slopes.size - 1, ceil((slopes.size + off) / 2.0))
    chosen = (float(np.median(slopes)), float(slopes[low]), float(slopes[high]))
    found = []
    for slope in chosen:
        found.append(Line(slope, float(np.median(levels_of(series, slope)))))
    return found[0], found[1], found[2]


def levels_of(series: Sequence[tuple[Floats, Floats]], slope: float) -> Floats:
    """float64[n]: the median of each series at time 0, without this slope; see `joint_trend`."""
    return np.array([np.median(values - slope * times) for times, values in series])


def _pairs_of(times: Floats, values: Floats) -> tuple[Floats, Floats]:
    """By how much the values of all pairs of points differ, and the slopes."""
    first, second = _triangle(times.size)
    steps = values[second] - values[first]
    return steps, steps / (times[second] - times[first])


@lru_cache(8)
def _triangle(count: int) -> tuple[Int64s, Int64s]:
    """The places of all pairs of so many points."""
    first, second = np.triu_indices(count, 1)
    return frozen(first), frozen(second)


def _chance(order: int, values: Floats) -> float:
    """How likely a random order has a sum of signs that is as far from 0, on either side."""
    count = values.size
    _, ties = np.unique(values, return_counts=True)
    if count <= _EXACT and ties.max() == 1:
        ways = _ways(count)
        pairs = count * (count - 1) // 2
        # The sum of signs of k pairs in the wrong order is `pairs` - 2 k.
        beyond = sum(ways[: (pairs - abs(order)) // 2 + 1])
        return min(1.0, 2.0 * beyond / factorial(count))
    return _by_normal(order, _spread([(values, values)]))


def _spread(series: Sequence[tuple[Floats, Floats]]) -> int:
    """18 times the variance of the sum of signs."""
    spread = 0
    for _, values in series:
        _, ties = np.unique(values, return_counts=True)
        spread += _pairs(values.size) - sum(_pairs(int(tie)) for tie in ties)
    return spread


def _by_normal(order: int, spread: int) -> float:
    if spread <= 0:
        return 1.0
    return erfc(max(0, abs(order) - 1) / sqrt(spread / 18.0) / sqrt(2.0))


def _pairs(count: int) -> int:
    return count * (count - 1) * (2 * count + 5)


@lru_cache(_EXACT + 1)
def _ways(count: int) -> tuple[int, ...]:
    """How many orders of ``count`` things have k pairs in the wrong order, for each k."""
    ways = [1]
    for more in range(2, count + 1):
        longer = [0] * (len(ways) + more - 1)
        for place, number in enumerate(ways):
            for step in range(more):
                longer[place + step] += number
        ways = longer
    return tuple(ways)
