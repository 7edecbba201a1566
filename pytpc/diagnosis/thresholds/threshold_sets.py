"""Sets of thresholds that give a comparison one outcome."""

from __future__ import annotations

import math

import numpy as np

from pytpc.base.columns import Bools, Floats
from pytpc.diagnosis.thresholds.intervals import EVERYWHERE, Interval, Intervals

_RELATIONS: dict[str, np.ufunc] = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
}
_OPPOSITE = {"<": ">=", ">=": "<", ">": "<=", "<=": ">", "==": "!=", "!=": "=="}


def outcomes(relation: str, cmp: Floats, thresh: Floats | float) -> Bools:
    """bool[n]: ``cmp relation thresh``, the relation as in docs/reference/formats.md."""
    return np.asarray(_RELATIONS[relation](cmp, thresh), dtype=np.bool_)


def thresholds_for(relation: str, cmp: float, outcome: bool) -> Intervals:
    """The finite thresholds T with ``(cmp relation T) == outcome``; ``relation`` is no ``flag``.

    NaN is unequal to every threshold, and no order holds for it.

    >>> thresholds_for(">=", 3, False)[0].words()
    'above 3'
    """
    if math.isnan(cmp):
        return EVERYWHERE if outcome == (relation == "!=") else ()
    wanted = relation if outcome else _OPPOSITE[relation]
    sets = {
        "<": [Interval.above(cmp)],
        "<=": [Interval.above(cmp, inclusive=True)],
        ">": [Interval.below(cmp)],
        ">=": [Interval.below(cmp, inclusive=True)],
        "==": [Interval.point(cmp)],
        "!=": [Interval.below(cmp), Interval.above(cmp)],
    }[wanted]
    if math.isinf(cmp):
        # Every finite number is above -inf, and differs from it.
        holds_of_all = bool(_RELATIONS[wanted](cmp, 0.0))
        return EVERYWHERE if holds_of_all else ()
    return tuple(sets)


def thresholds_for_one(relation: str, cmps: Floats, outcome: bool, current: float) -> Intervals:
    """The thresholds with which at least one of ``cmps`` (float64[n], finite) has ``outcome``.

    An extreme value decides; for equality up to 16 values next to ``current``.
    """
    if not cmps.size:
        return ()
    wanted = relation if outcome else _OPPOSITE[relation]
    if wanted in {"<", "<="}:
        return thresholds_for(wanted, float(cmps.min()), True)
    if wanted in {">", ">="}:
        return thresholds_for(wanted, float(cmps.max()), True)
    distinct = np.unique(cmps)
    if wanted == "==":
        nearest = distinct[np.argsort(np.abs(distinct - current), kind="stable")[:_POINTS]]
        return tuple(Interval.point(float(cmp)) for cmp in np.sort(nearest))
    # Of two different values every threshold is unequal to one.
    return EVERYWHERE if distinct.size > 1 else thresholds_for("!=", float(distinct[0]), True)


_POINTS = 16
