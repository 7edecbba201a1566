"""Whether one group of missions has other values than the rest: rank sums.

The test of Wilcoxon (1945), Mann and Whitney (1947), with the mean rank for ties. Over strata (van
Elteren 1960) each stratum compares only its own missions and has the weight 1 / (n + 1), which is
best against a shift that is the same in all. Small samples without ties have their exact
distribution, others the normal one with half a step of continuity.
"""

from __future__ import annotations

from functools import lru_cache
from math import comb, erfc, sqrt
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Bools, Floats, Int32s, Int64s

_EXACT = 400
"""The exact distribution is worked out up to so many pairs of the two groups."""


class RankSums(NamedTuple):
    """Of each of n comparisons: how likely chance is to rank the groups so far apart.

    ``chance`` float64[n], two-sided; nan where the groups cannot be compared. ``side`` float64[n],
    the sign of the difference: 1 if the group's values are larger.
    """

    chance: Floats
    side: Floats


class _Cells(NamedTuple):
    """Of each cell with both groups: sizes, the excess of the rank sum, and its variance."""

    cell: Int64s
    group: Int64s
    every: Int64s
    excess: Floats
    variance: Floats
    tied: Bools


def rank_sums(which: Int64s, stratum: Int64s, values: Floats, group: Bools, count: int) -> RankSums:
    """Compare the group with the rest in each of ``count`` comparisons, within strata.

    Args:
        which: int64[r], the comparison of each row, below ``count``.
        stratum: int64[r]; rows of different strata are not compared.
        values: float64[r]; nan is left out.
        group: bool[r], whether the row is of the group.
        count: how many comparisons there are.
    """
    width = int(stratum.max(initial=0)) + 1
    cells = _cells(which.astype(np.int64) * width + stratum, values, group)
    own = cells.cell // width
    weight = 1.0 / (cells.every + 1.0)
    excess = summed(own, weight * cells.excess, count)
    variance = summed(own, weight**2 * cells.variance, count)
    step = np.zeros(count)
    np.maximum.at(step, own, weight)
    chance = _normal(excess, variance, step)
    alone = np.bincount(own, minlength=count)
    for n in np.flatnonzero((alone[own] == 1) & ~cells.tied).tolist():
        group_size, rest = int(cells.group[n]), int(cells.every[n] - cells.group[n])
        if group_size * rest <= _EXACT:
            chance[own[n]] = exact_chance(float(cells.excess[n]), group_size, rest)
    return RankSums(np.where(alone > 0, chance, np.nan), np.sign(excess))


def summed(group: Int64s | Int32s, values: Floats, count: int) -> Floats:
    """float64[count]: the sum of the values of each group."""
    return np.bincount(group, values, count).astype(np.float64)


def _normal(excess: Floats, variance: Floats, step: Floats) -> Floats:
    chance = np.ones(excess.size)
    some = variance > 0
    score = np.maximum(0.0, np.abs(excess[some]) - step[some] / 2) / np.sqrt(variance[some])
    chance[some] = [erfc(one / sqrt(2.0)) for one in score.tolist()]
    return chance


def each_against_rest(
    which: Int64s, member: Int64s, values: Floats, shape: tuple[int, int]
) -> Floats:
    """The chance of the values of each member against those of all others.

    Args:
        which: int64[r], the comparison of each row.
        member: int64[r], whose row it is.
        values: float64[r]; nan is left out.
        shape: how many comparisons and members there are.

    Returns:
        float64[comparisons, members]: two-sided; nan where there is nothing to compare.
    """
    ranked = _ranked(which, values)
    count, width = shape
    own = which[ranked.order] * width + member[ranked.order]
    size = np.bincount(own, minlength=count * width)
    total = summed(own, ranked.rank, count * width)
    every, tied = np.zeros(count, np.int64), np.zeros(count)
    every[ranked.cell], tied[ranked.cell] = ranked.every, ranked.ties
    every, tied = np.repeat(every, width), np.repeat(tied, width)
    both = np.flatnonzero((size > 0) & (size < every))
    size, every, tied = size[both], every[both], tied[both]
    excess = total[both] - size * (every + 1) / 2.0
    chance = _normal(excess, _variance(size, every, tied), np.ones(both.size))
    for n in np.flatnonzero(tied == 0).tolist():
        group, rest = int(size[n]), int(every[n] - size[n])
        if group * rest <= _EXACT:
            chance[n] = exact_chance(float(excess[n]), group, rest)
    found = np.full(count * width, np.nan)
    found[both] = chance
    return found.reshape(shape)


class _Ranked(NamedTuple):
    """``order`` lists the known rows by cell and value, ``rank`` float64 is each one's in its cell.

    Of each cell: its number, where it begins, how many rows it has, and the sum of t^3 - t over
    runs of t equal values.
    """

    order: Int64s
    rank: Floats
    cell: Int64s
    starts: Int64s
    every: Int64s
    ties: Floats


def _ranked(cell: Int64s, values: Floats) -> _Ranked:
    known = np.flatnonzero(~np.isnan(values))
    order = known[np.lexsort((values[known], cell[known]))]
    cell, values = cell[order], values[order]
    if not order.size:
        return _Ranked(order, np.empty(0), order, order, order, np.empty(0))
    new = np.append(True, cell[1:] != cell[:-1])
    starts = np.flatnonzero(new)
    every = np.diff(np.append(starts, order.size))
    place = np.arange(order.size) - np.repeat(starts, every) + 1
    first = np.flatnonzero(new | np.append(True, values[1:] != values[:-1]))
    alike = np.diff(np.append(first, order.size))
    rank = np.repeat(place[first] + (alike - 1) / 2.0, alike)
    ties = np.add.reduceat(np.repeat(alike**2 - 1.0, alike), starts)
    return _Ranked(order, rank, cell[starts], starts, every, ties)


def _variance(size: Int64s, every: Int64s, ties: Floats) -> Floats:
    """That of a rank sum, with ties."""
    spread = every + 1.0 - ties / (every * (every - 1.0))
    return np.asarray(size * (every - size) / 12.0 * spread)


def _cells(cell: Int64s, values: Floats, group: Bools) -> _Cells:
    ranked = _ranked(cell, values)
    if not ranked.order.size:
        none = np.empty(0, np.int64)
        return _Cells(none, none, none, np.empty(0), np.empty(0), np.empty(0, np.bool_))
    own = group[ranked.order]
    size = np.add.reduceat(own.astype(np.int64), ranked.starts)
    total = np.add.reduceat(np.where(own, ranked.rank, 0.0), ranked.starts)
    both = (size > 0) & (size < ranked.every)
    size, every, ties = size[both], ranked.every[both], ranked.ties[both]
    excess = total[both] - size * (every + 1) / 2.0
    variance = _variance(size, every, ties)
    return _Cells(ranked.cell[both], size, every, excess, variance, ties > 0)


def exact_chance(excess: float, group: int, rest: int) -> float:
    """The two-sided chance of a rank sum that is so far from its mean, without ties."""
    ways = _ways(group, rest)
    middle = group * rest / 2.0
    below = int(np.floor(middle - abs(excess) + 1e-9))
    return min(1.0, 2.0 * sum(ways[: below + 1]) / comb(group + rest, group))


@lru_cache(1024)
def _ways(group: int, rest: int) -> tuple[int, ...]:
    """In how many orders k pairs of one of the group and one of the rest are in order, by k.

    The coefficients of Gauss's binomial, by Pascal's rule for the last one in the order.
    """
    rows: list[list[int]] = [[1] for _ in range(rest + 1)]
    for size in range(1, group + 1):
        longer: list[list[int]] = [[1]]
        for others in range(1, rest + 1):
            ways = [0] * (size * others + 1)
            for k, number in enumerate(longer[-1]):
                ways[k] += number
            for k, number in enumerate(rows[others]):
                ways[k + others] += number
            longer.append(ways)
        rows = longer
    return tuple(rows[rest])
