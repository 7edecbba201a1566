"""How otherwise the comparisons of each parameter behave in the bad missions of a fleet.

For each comparison four measures are compared between bad and good missions of the same robot, by
rank sums over the robots (`rank_sum`): the share of time in which it was true, its turns per
minute, its median margin with the sign of its usual result, and its least margin. The chance of a
parameter is the least of its tests, times their number (Bonferroni).

A chance p is turned into evidence by the most that it can be worth, -1 / (e p log p) (Sellke,
Bayarri and Berger 2001), and at most ``MOST``. What follows from the error behaves otherwise as
well, and often more clearly than the cause. So this decides between parameters that the values and
the diagnoses leave equal, and cannot outweigh either. Behaviour that is as usual says nothing: a
threshold that is crossed too early changes little else than one time.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.diagnosis.fleet.rank_sum import rank_sums
from pytpc.diagnosis.fleet.rows import Rows

MOST = 2.0
"""The most that the behaviour counts, in log odds: less than one mission's diagnosis may, or the
values of two."""

MEASURES = ("true share", "turns per minute", "median margin", "least margin")


class Differing(NamedTuple):
    """Which comparisons behave otherwise in bad missions.

    ``evidence`` float64[p]. ``shows`` int64[p] is the comparison of each parameter that differs
    most, ``measure`` int64[p] by which of ``MEASURES``, ``side`` float64[p] the sign of the
    difference, and ``chance`` float64[p] that of the parameter.
    """

    evidence: Floats
    shows: Int64s
    measure: Int64s
    side: Floats
    chance: Floats


def measures(rows: Rows) -> tuple[Floats, ...]:
    """What ``MEASURES`` names, float64[n] each."""
    return rows.true_share, rows.turn_rate, rows.signed_median, rows.least


def differing(rows: Rows) -> Differing:
    """Compare bad with good missions of the same robots; of all robots where none has both."""
    judged = np.flatnonzero((rows.bad | rows.good)[rows.mission])
    mission, which = rows.mission[judged], rows.which[judged].astype(np.int64)
    bad, robot = rows.bad[mission], rows.robot[mission].astype(np.int64)
    count = len(rows.series)
    chances, sides = np.ones((4, count)), np.zeros((4, count))
    tested = np.zeros((4, count), np.bool_)
    for place, column in enumerate(measures(rows)):
        values = column[judged]
        own = rank_sums(which, robot, values, bad, count)
        every = rank_sums(which, np.zeros_like(robot), values, bad, count)
        among = np.isnan(own.chance)
        tested[place] = ~(among & np.isnan(every.chance))
        # Robots differ for other reasons, so that a difference between them says half as much.
        chances[place] = np.where(among, np.sqrt(every.chance), own.chance)
        sides[place] = np.where(among, every.side, own.side)
    chances[~tested] = 1.0
    return _by_parameter(rows, chances, sides, tested)


def _by_parameter(rows: Rows, chances: Floats, sides: Floats, tested: Bools) -> Differing:
    names = len(rows.parameters)
    shows, measure = np.full(names, -1, np.int64), np.zeros(names, np.int64)
    side, chance = np.zeros(names), np.ones(names)
    tests = np.bincount(rows.of_series, tested.sum(axis=0), names)
    best = chances.argmin(axis=0) if chances.size else np.empty(0, np.int64)
    least = chances.min(axis=0) if chances.size else np.empty(0)
    # Backwards, so that of equal ones the first stays.
    for one in np.argsort(least, kind="stable")[::-1].tolist():
        own = int(rows.of_series[one])
        shows[own], measure[own] = one, best[one]
        side[own], chance[own] = sides[best[one], one], least[one]
    chance = np.minimum(1.0, chance * np.maximum(1.0, tests))
    evidence = np.array([worth(one) for one in chance.tolist()])
    return Differing(evidence, shows, measure, side, chance)


def worth(chance: float) -> float:
    """The evidence in a chance, in log odds: from 0 to ``MOST``."""
    if chance >= math.exp(-1.0):
        return 0.0
    if chance <= 0.0:
        return MOST
    return min(MOST, -math.log(-math.e * chance * math.log(chance)))
