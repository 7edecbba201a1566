"""Importance of the parameters of a fleet, with missions as runs.

The predicates of a comparison are that it was ever true, ever false, that it turned, and that its
threshold was another one than usual: than in most good missions of the robot, or of the fleet where
the robot has none. Each was observed in the missions that evaluated the comparison.
"""

from __future__ import annotations

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.diagnosis.fleet.rows import Rows
from pytpc.diagnosis.fleet.settings import same_numbers
from pytpc.diagnosis.importance import importances


def fleet_importance(rows: Rows) -> Floats:
    """float64[p]: the greatest Importance of the predicates of each parameter's comparisons."""
    best = np.zeros(len(rows.parameters))
    bad = rows.bad[rows.mission]
    judged = bad | rows.good[rows.mission]
    count, every = len(rows.series), int(rows.bad.sum())
    seen = _counts(rows, judged, bad, count)
    other, has_usual = _unusual(rows)
    turned = rows.turns > 0
    for true, observed in (
        (rows.was_true, seen),
        (rows.was_false, seen),
        (turned, seen),
        (other, _counts(rows, judged & has_usual, bad, count)),
    ):
        found = importances(*_counts(rows, judged & true, bad, count), *observed, every)
        np.maximum.at(best, rows.of_series, found)
    return best


def _counts(rows: Rows, which: Bools, bad: Bools, count: int) -> tuple[Int64s, Int64s]:
    """int64[s]: how many bad and how many good of these rows each comparison has."""
    failing = np.bincount(rows.which[which & bad], minlength=count)
    passing = np.bincount(rows.which[which & ~bad], minlength=count)
    return failing, passing


def _unusual(rows: Rows) -> tuple[Bools, Bools]:
    """bool[n]: whether the threshold is not the usual one; and whether a usual one is known."""
    good = rows.good[rows.mission] & ~np.isnan(rows.thresh)
    thresh = same_numbers(rows.thresh)
    width = max(1, len(rows.robots))
    own = rows.which.astype(np.int64) * width + rows.robot[rows.mission]
    usual = most_frequent(own[good], thresh[good], len(rows.series) * width)[own]
    whole = most_frequent(rows.which[good].astype(np.int64), thresh[good], len(rows.series))
    usual = np.where(np.isnan(usual), whole[rows.which], usual)
    known = ~np.isnan(usual) & ~np.isnan(thresh)
    return known & (thresh != usual), known


def most_frequent(group: Int64s, values: Floats, count: int) -> Floats:
    """float64[count]: the most frequent value of each group, of equal ones the smallest; or nan."""
    found = np.full(count, np.nan)
    if not group.size:
        return found
    order = np.lexsort((values, group))
    group, values = group[order], values[order]
    new = np.ones(group.size, np.bool_)
    new[1:] = (group[1:] != group[:-1]) | (values[1:] != values[:-1])
    starts = np.flatnonzero(new)
    length = np.diff(np.append(starts, group.size))
    # The longest run last, of equal ones the first.
    best = np.lexsort((-values[starts], length, group[starts]))
    found[group[starts][best]] = values[starts][best]
    return found
