"""Whether a series rises or falls, and how fast, without an assumption about its noise.

The slope is the median of those of all pairs of points (Theil 1950, Sen 1968). It counts if chance
would order the points so seldom: the test of Mann (1945) and Kendall, with the exact distribution
for few points.
"""

from __future__ import annotations

from functools import lru_cache
from math import erfc, factorial, sqrt
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Floats

CHANCE = 0.01
"""How likely a slope is to be seen where there is none."""

_EXACT = 40


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
    first, second = np.triu_indices(times.size, 1)
    if not first.size:
        return None
    steps = values[second] - values[first]
    slope = float(np.median(steps / (times[second] - times[first])))
    order = int(np.sign(steps).sum())
    return Trend(slope, _chance(order, values))


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
    spread = _pairs(count) - sum(_pairs(int(tie)) for tie in ties)
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
