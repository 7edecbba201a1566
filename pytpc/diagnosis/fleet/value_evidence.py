r"""How well the values of a parameter explain which missions of a fleet went wrong.

If a parameter is the cause, some of its values are wrong ones, W. A mission with a value in W
mostly goes wrong; another one goes wrong as seldom as without the parameter. The evidence is the
log of how much likelier the verdicts are then than if they had nothing to do with the parameter:

    in W       B(b + 9, g + 1) / B(9, 1) / product of P(verdict)
    not in W   product of P'(verdict) / P(verdict),  P'(bad) = (1 - x) P(bad)

with b bad and g good missions in W, and the beta function B: the share of missions that go wrong
with a wrong value is not known, and mostly near nine tenths (``MOSTLY``). P(bad) is the share of
bad missions of the robot, drawn towards that of the fleet (``TOWARDS``): so not all settings of a
robot that often goes wrong are suspicious. x is the part of the bad missions that the parameter
explains. It is not known either, and mostly more than half (``COMMON``); the mean over x counts.
So a bad mission with a value that is right has another cause, or its marks were slips, and vetoes
nothing.

Which values are wrong is not known. Of thresholds and other numbers they are all from one on, or
all up to one, each as likely: so a value between those of two good missions is wrong only if one of
these is. Of flags, texts and equality, and of few numbers (``BETWEEN``), any values may be wrong,
each with the probability ``WRONG``. At least one bad mission has a wrong value, and at least one
good mission has none: a value with which all flew, also those that went right, is no cause.

The wrong values are the same for all robots, or each robot has its own, or none, as what is right
for one may be wrong for its sister (``OWN``). Good missions of the same robot with the same value
speak against it either way, those of sisters only in the first case. A bad mission whose value is
not known counts ``UNSAID``. P(bad) is that of the missions in which the value is known: what is
compared only when something has gone wrong, as in a recovery, is not suspicious for that. The
evidence is at least ``UNCHANGED``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Bools, Floats, Int32s, Int64s
from pytpc.diagnosis.ranking.known_good import BETWEEN, UNCHANGED

MOSTLY = (9, 1)
"""Missions that go wrong with a wrong value, and those that do not: what is known before. The error
needs the situation in which it shows, and somebody who sees it."""

COMMON = 2
"""The part of the bad missions that the common cause explains has the density 2 x: two thirds in
the mean. In the study one treatment in five has no parameter to blame; in a fleet marks are slips,
and several things go wrong at once."""

OTHER = 1.0 / (COMMON + 1.0)
"""The part of the bad missions that have another cause, before any is known."""

_ROUNDING = 1e-9
_PARTS = 16
EXPLAINED = ((np.arange(_PARTS) + 0.5) / _PARTS) ** (1.0 / COMMON)
"""The parts x of the bad missions that are explained, each as likely: quantiles of ``COMMON``."""

TOWARDS = 4
"""So many missions of the whole fleet count to each robot's own. A few, as robots differ."""

OWN = math.exp(-3.0)
"""How likely it is that what is wrong for a robot is right for its sister. As little as that a
value between two good ones is wrong (``BETWEEN``): it was known to be good somewhere else."""

WRONG = 0.2
"""How likely each value of a flag or text is a wrong one. Most are right."""

UNSAID = math.log((1.0 + OTHER) / 2.0)
"""The evidence of a bad mission whose value is not known: as likely right as wrong."""


class Missions(NamedTuple):
    """The judged missions of a fleet: ``robot`` int64[m], ``bad`` bool[m] (others are good).

    ``chance`` float64[m] is log P(verdict), ``outside`` float64[x, m] is log P'(verdict) less that,
    see the module's docstring.
    """

    robot: Int64s
    bad: Bools
    chance: Floats
    outside: Floats

    @classmethod
    def of(cls, robot: Int32s | Int64s, bad: Bools) -> Missions:
        """The missions of these robots."""
        every = np.bincount(robot)
        wrong = np.bincount(robot, bad, every.size)
        whole = (float(bad.sum()) + 0.5) / (bad.size + 1.0)
        share = ((wrong + TOWARDS * whole) / (every + TOWARDS))[robot]
        left = (1.0 - EXPLAINED)[:, None]
        outside = np.where(bad, np.log(left), np.log1p(-left * share) - np.log1p(-share))
        chance = np.log(np.where(bad, share, 1.0 - share))
        return cls(robot.astype(np.int64), bad, chance, outside)

    def take(self, rows: Int64s | Bools) -> Missions:
        """Some of them."""
        return Missions(self.robot[rows], self.bad[rows], self.chance[rows], self.outside[:, rows])


class _Counts(NamedTuple):
    """Of k values in order the missions that had each: how many bad and good ones there are.

    ``chance`` float64[k] and ``outside`` float64[x, k] are the sums over them.
    """

    bad: Int64s
    good: Int64s
    chance: Floats
    outside: Floats

    @classmethod
    def of(cls, value: Int64s, missions: Missions) -> _Counts:
        order = np.argsort(value, kind="stable")
        value = value[order]
        starts = np.flatnonzero(np.append(True, value[1:] != value[:-1]))
        bad = np.add.reduceat(missions.bad[order].astype(np.int64), starts)
        every = np.diff(np.append(starts, value.size))
        chance = np.add.reduceat(missions.chance[order], starts)
        outside = np.add.reduceat(missions.outside[:, order], starts, axis=1)
        return cls(bad, every - bad, chance, outside)


def value_evidence(
    missions: Missions, known: Int64s, value: Int64s, *, ordered: bool, several: bool
) -> float:
    """The log odds that a parameter is the cause of the bad missions, by its values.

    Args:
        missions: all judged ones.
        known: int64[k], those in which the parameter's value is known.
        value: int64[k], the values, or codes that rise with them.
        ordered: whether a wrong value is one that is too large or too small.
        several: whether the fleet has several robots.
    """
    own = Missions.of(missions.robot[known], missions.bad[known])
    unsaid = int(missions.bad.sum()) - int(own.bad.sum())
    silent = max(unsaid * UNSAID, UNCHANGED / 2)
    if not own.bad.any():
        return silent
    found = _log_ratio(_Counts.of(value, own), ordered)
    if several:
        apart = _of_each_robot(value, own, ordered)
        found = np.logaddexp(math.log1p(-OWN) + found, math.log(OWN) + apart)
    mean = float(np.logaddexp.reduce(found)) - math.log(_PARTS)
    return float(np.logaddexp(mean + silent, UNCHANGED))


def _of_each_robot(value: Int64s, missions: Missions, ordered: bool) -> Floats:
    """The same if each robot has wrong values of its own, or none, and at least one has some."""
    robots = np.unique(missions.robot[missions.bad])
    others = ~np.isin(missions.robot, robots)
    every = missions.outside[:, others].sum(axis=1)
    nobody = every.copy()
    for one in robots.tolist():
        rows = missions.robot == one
        own = missions.take(rows)
        none = own.outside.sum(axis=1)
        some = _log_ratio(_Counts.of(value[rows], own), ordered)
        every += np.logaddexp(none, some) - math.log(2.0)
        nobody += none - math.log(2.0)
    return _less(every, nobody)


def _log_ratio(counts: _Counts, ordered: bool) -> Floats:
    """float64[x]: the log of the mean ratio over the sets of wrong values; -inf without one."""
    free = _free(counts)
    if not ordered:
        return free
    return np.logaddexp(BETWEEN + free, math.log1p(-math.exp(BETWEEN)) + _cuts(counts))


def _cuts(counts: _Counts) -> Floats:
    """Wrong are all values from one on, or all up to one."""
    bad, good, chance = (np.cumsum(column) for column in counts[:3])
    wrong, right, said = (
        np.concatenate([column[:-1], column[-1:], column[-1] - column[:-1]])
        for column in (bad, good, chance)
    )
    possible = wrong > 0
    if good[-1]:
        possible &= right < good[-1]
    some = np.flatnonzero(possible)
    if not some.size:
        return np.full(_PARTS, -np.inf)
    upto = np.cumsum(counts.outside, axis=1)
    whole = upto[:, -1:]
    left = np.concatenate([whole - upto[:, :-1], np.zeros_like(whole), upto[:, :-1]], axis=1)
    found = _goes(wrong[some], right[some]) - said[some] + left[:, some]
    return np.asarray(np.logaddexp.reduce(found, axis=1) - math.log(wrong.size))


def _free(counts: _Counts) -> Floats:
    """Each value may be wrong by itself."""
    inside = math.log(WRONG) + _goes(counts.bad, counts.good) - counts.chance
    outside = math.log1p(-WRONG) + counts.outside
    inside = np.broadcast_to(inside, outside.shape)
    both = np.logaddexp(inside, outside)
    has_bad, has_good = counts.bad > 0, counts.good > 0
    every = both.sum(axis=1)
    nothing = np.where(has_bad, outside, both).sum(axis=1)
    if not has_good.any():
        return _less(every, nothing)
    all_good = np.where(has_good, inside, both).sum(axis=1)
    if not np.any(has_bad & has_good):
        # What has no bad value and leaves out no good one is taken away twice below.
        every = np.logaddexp(every, np.where(has_bad, outside, inside).sum(axis=1))
    return _less(every, np.logaddexp(nothing, all_good))


def _less(whole: Floats, part: Floats) -> Floats:
    """The log of sums without a part of each; -inf where nothing is left."""
    left = -np.expm1(np.minimum(part - whole, 0.0))
    with np.errstate(divide="ignore"):
        return np.where(left > _ROUNDING, whole + np.log(left), -np.inf)


def _goes(bad: Int64s, good: Int64s) -> Floats:
    """The log probability of the verdicts of missions with wrong values."""
    a, b = MOSTLY
    top = int((bad + good).max(initial=0)) + a + b
    # logs[n] = log((n - 1)!) = log(gamma(n)).
    logs = np.concatenate([[0.0, 0.0], np.cumsum(np.log(np.arange(1, top + 1)))])
    before = math.lgamma(a) + math.lgamma(b) - math.lgamma(a + b)
    return np.asarray(logs[bad + a] + logs[good + b] - logs[bad + good + a + b] - before)
