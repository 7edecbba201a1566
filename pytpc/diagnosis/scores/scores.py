"""Scores and ranks of docs/reference/scores.md, for all TPCs at many times at once.

``type1`` and ``type2`` give a table float64[marks, keys] of scores: lower is more suspicious,
``NONE`` where there is none. ``ranks`` turns it into ranks in [0, 1], ``by_parameter`` joins the
TPCs of a parameter, ``combined`` joins the ranks of both types where the observer gave no type.

What the formulas leave open: an evaluation at exactly m is "up to m", and the window [m - w, m]
includes both ends. A flop happens at the later of its two evaluations, which have the same key and
node. An evaluation whose cmp or thresh is NaN or infinite counts for flops, but not for D, n_i,
max_i and min_i. max_i and min_i are those up to m, so a score computed after the mission is the
score that an observer would have got during it. If m is the time of the last flop, S1 is 0.

One key at one time costs O(log n), however long the window is.

With the policy ``edges`` there are summaries instead of every evaluation. Type I is the same number
then, because the first evaluation and all flops are events; for type II see
`pytpc.diagnosis.scores.summary_scores`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from pytpc.diagnosis.question import WINDOW_S
from pytpc.recording.events import Bools, Events, Floats, Int64s

NONE = 9999.9
"""The score of a TPC that has none."""

EQUAL = 1e-4
"""Up to this difference a value counts as the threshold itself (n_i of type II)."""

NEVER = -(2**63)
"""The time of something that never happened."""

_LARGE = 2.0**960
_SCALE = 2.0**-64


class Before(NamedTuple):
    """What was forgotten before the first row of a table, for each of its k keys.

    ``flops`` int64[k], how many; ``last_flop_ns`` int64[k], the last of them (``NEVER`` where there
    is none); ``finite`` int64[k], evaluations with finite values, and ``highest`` and ``lowest``
    float64[k] the extremes of these values (-inf and inf where there are none).
    """

    flops: Int64s
    last_flop_ns: Int64s
    finite: Int64s
    highest: Floats
    lowest: Floats

    @classmethod
    def nothing(cls, keys: int) -> Before:
        """Nothing was forgotten."""
        return cls(
            np.zeros(keys, np.int64),
            np.full(keys, NEVER),
            np.zeros(keys, np.int64),
            np.full(keys, -np.inf),
            np.full(keys, np.inf),
        )


class Formula(NamedTuple):
    """The window in seconds and the exponents of a score.

    The window, ``alpha`` and type II's ``gamma`` are at least 0.
    """

    window_s: float = WINDOW_S
    alpha: float = 1.0
    beta: float = 1.0
    gamma: float = 0.0
    delta: float = 0.0


DEFAULT = Formula()
"""The thesis's exponents and window."""


def type1(
    events: Events,
    marks_ns: npt.ArrayLike,
    distance: npt.ArrayLike,
    formula: Formula = DEFAULT,
    before: Before | None = None,
) -> Floats:
    """Type I, recent flop: (m - t_last_flop)^alpha * (1 + flops up to m)^beta * d_i^gamma.

    Args:
        events: the evaluations.
        marks_ns: int64[marks], the times m in nanoseconds, in any order.
        distance: float64[keys], d_i of ``events.keys``.
        formula: its ``alpha`` is the exponent of the seconds since the last flop, ``beta`` of the
            number of flops, ``gamma`` of the distance.
        before: what was before the first of ``events``; no mark may be earlier.

    Returns:
        float64[marks, keys]; ``NONE`` where the key has not flopped up to m.

    Raises:
        ValueError: ``distance`` is not one number for each key, or ``alpha`` is negative.
    """
    marks, distances = checked(events, marks_ns, distance)
    alpha, beta, gamma = formula.alpha, formula.beta, formula.gamma
    not_negative(alpha=alpha)
    earlier = before or Before.nothing(len(events.keys))
    scores = np.full((marks.size, len(events.keys)), NONE)
    for code in range(len(events.keys)):
        rows = events.by_key.rows(code)
        flops = events.time_ns[rows[events.flop[rows]]]
        place = np.searchsorted(flops, marks, side="right")
        count = place + earlier.flops[code]
        some = count > 0
        last = np.concatenate([[NEVER], flops])[place[some]]
        seconds = (marks[some] - np.maximum(last, earlier.last_flop_ns[code])) / 1e9
        value = seconds**alpha * (1.0 + count[some]) ** beta * distances[code] ** gamma
        scores[some, code] = beside_none(value)
    return scores


def type2(
    events: Events,
    marks_ns: npt.ArrayLike,
    distance: npt.ArrayLike,
    formula: Formula = DEFAULT,
    before: Before | None = None,
) -> Floats:
    """Type II, about to flop: D^alpha * max(1, flops)^beta * n_i^gamma * (d_i/d_max)^delta.

    D is the mean of |cmp - thresh| / (max_i - min_i), and flops and n_i (evaluations with
    |cmp - thresh| > 1e-4) are counted, over the window [m - w, m].

    The arguments are those of ``type1``; d_max is the largest distance. The formula's ``window_s``
    is w, ``alpha`` the exponent of D, ``beta`` of the number of flops in the window, ``gamma`` of
    n_i, ``delta`` of the distance. No window may begin before the first of ``events``.

    Returns:
        float64[marks, keys]; ``NONE`` where the key has no evaluation with finite values in the
        window, or only one value up to m (max_i = min_i).

    Raises:
        ValueError: ``distance`` is not one number for each key, or an argument is negative.
    """
    marks, distances = checked(events, marks_ns, distance)
    window_s, alpha, beta, gamma, delta = formula
    not_negative(window_s=window_s, alpha=alpha, gamma=gamma)
    begins = marks - round(window_s * 1e9)
    earlier = before or Before.nothing(len(events.keys))
    scores = np.full((marks.size, len(events.keys)), NONE)
    nearness = distances / distances.max(initial=1.0)
    for code in range(len(events.keys)):
        rows = events.by_key.rows(code)
        flops = events.time_ns[rows[events.flop[rows]]]
        flop_count = count_within(flops, begins, marks)
        window = _Differences(events, rows, earlier, code).over(begins, marks)
        some = window.usable
        value = (
            window.mean[some] ** alpha
            * np.maximum(1.0, flop_count[some]) ** beta
            * window.unequal[some] ** gamma
            * nearness[code] ** delta
        )
        scores[some, code] = beside_none(value)
    return scores


def ranks(scores: Floats) -> Floats:
    """Ranks of float64[marks, n] scores: 1 - index/n in ascending order, 0 where there is no score.

    1 is the most suspicious. The index of a score is how many are smaller, so that equal scores
    have equal ranks.
    """
    n = scores.shape[1]
    if not n:
        return np.zeros_like(scores)
    values = np.where(scores == NONE, np.inf, scores)
    order = np.argsort(values, axis=1)
    ascending = np.take_along_axis(values, order, axis=1)
    index = np.zeros(scores.shape, np.int64)
    index[:, 1:] = np.where(ascending[:, 1:] > ascending[:, :-1], np.arange(1, n), 0)
    np.maximum.accumulate(index, axis=1, out=index)
    result = np.empty_like(scores)
    np.put_along_axis(result, order, 1.0 - index / n, axis=1)
    result[scores == NONE] = 0.0
    return result


class ParameterTable(NamedTuple):
    """One score of the p parameters at t times.

    ``names`` sorted; ``scores`` float64[t, p]; ``best`` int64[t, p], the TPC that has that score,
    and ``distance`` float64[t, p] that one's; ``ranks`` float64[t, p].
    """

    names: tuple[str, ...]
    scores: Floats
    best: Int64s
    distance: Floats
    ranks: Floats


def by_parameter(
    scores: Floats, parameters: Sequence[str], distance: npt.ArrayLike, keys: Sequence[str]
) -> ParameterTable:
    """A parameter's score is the best of its TPCs'; of equal ones the nearer, then the first key.

    Args:
        scores: float64[marks, n].
        parameters: the name of the parameter of each TPC.
        distance: float64[n], theirs; that of a parameter is the one of its best TPC.
        keys: theirs.
    """
    names = sorted(set(parameters))
    number = {name: place for place, name in enumerate(names)}
    distances = np.asarray(distance, dtype=np.float64)
    columns: list[list[int]] = [[] for _ in names]
    for column in np.lexsort((np.asarray(list(keys)), distances)).tolist():
        columns[number[parameters[column]]].append(column)
    values = np.where(scores == NONE, np.inf, scores)
    best = np.empty((scores.shape[0], len(names)), dtype=np.int64)
    for place, own in enumerate(columns):
        best[:, place] = np.array(own)[np.argmin(values[:, own], axis=1)]
    joined = np.take_along_axis(scores, best, axis=1)
    # Without a TPC there is nothing to take a distance from.
    nearest = np.append(distances, np.inf)[best]
    return ParameterTable(tuple(names), joined, best, nearest, ranks(joined))


def combined(first: Floats, second: Floats, weight: float = 1.0) -> Floats:
    """The better of two ranks, after the second is multiplied by ``weight``.

    Args:
        first: float64[marks, n], ranks of the type that is believed, or of either where none is.
        second: float64[marks, n], ranks of the other type.
        weight: from 0 (the second type does not count) to 1 (it counts as much).

    Returns:
        float64[marks, n].
    """
    return np.maximum(first, weight * second)


class _Window(NamedTuple):
    """What the window before each mark holds; ``mean`` is D."""

    usable: Bools
    mean: Floats
    unequal: Floats


class _Differences:
    """|cmp - thresh| of one key, ready for sums over spans of time."""

    def __init__(self, events: Events, rows: Int64s, before: Before, code: int) -> None:
        finite = np.isfinite(events.cmp[rows]) & np.isfinite(events.thresh[rows])
        rows = rows[finite]
        cmp, thresh = events.cmp[rows], events.thresh[rows]
        span = float(before.highest[code]), float(before.lowest[code])
        skipped = int(before.finite[code])
        self.times = events.time_ns[rows]
        with np.errstate(over="ignore"):
            self.unequal = np.concatenate([[0], np.cumsum(np.abs(cmp - thresh) > EQUAL)])
        self.ratios = [_Ratio(cmp, thresh, span, skipped)]
        known = [abs(value) for value in span if math.isfinite(value)]
        if np.abs([cmp, thresh]).max(initial=max(known, default=0.0)) > _LARGE:
            # Differences and sums of the largest doubles overflow; a power of two changes no ratio.
            less = span[0] * _SCALE, span[1] * _SCALE
            self.ratios.append(_Ratio(cmp * _SCALE, thresh * _SCALE, less, skipped))

    def over(self, begins: Int64s, ends: Int64s) -> _Window:
        """D and n_i over the closed spans."""
        low = np.searchsorted(self.times, begins, side="left")
        high = np.searchsorted(self.times, ends, side="right")
        usable = high > low
        usable[usable] = self.ratios[0].spread(high[usable] - 1) > 0
        mean = np.zeros(begins.size)
        mean[usable] = self.ratios[0].mean(low[usable], high[usable])
        for smaller in self.ratios[1:]:
            again = usable & ~np.isfinite(mean)
            mean[again] = smaller.mean(low[again], high[again])
        return _Window(usable, mean, (self.unequal[high] - self.unequal[low]).astype(np.float64))


class _Ratio:
    """Means of |cmp - thresh| / (max - min), max and min over all up to the last of the span."""

    def __init__(
        self, cmp: Floats, thresh: Floats, span: tuple[float, float], skipped: int
    ) -> None:
        """``span`` has the extremes of before, ``skipped`` how many there were."""
        with np.errstate(over="ignore"):
            self.sums = RangeSums(np.abs(cmp - thresh), skipped)
        highest, lowest = np.maximum(cmp, thresh), np.minimum(cmp, thresh)
        self.highest = np.maximum(np.maximum.accumulate(highest), span[0])
        self.lowest = np.minimum(np.minimum.accumulate(lowest), span[1])

    def spread(self, last: Int64s) -> Floats:
        with np.errstate(over="ignore"):
            return self.highest[last] - self.lowest[last]

    def mean(self, low: Int64s, high: Int64s) -> Floats:
        """NaN or infinite where a difference, a sum or the spread is beyond a double."""
        with np.errstate(over="ignore", invalid="ignore"):
            spread = self.spread(high - 1)
            mean = self.sums.over(low, high) / (high - low) / spread
            return np.where(np.isfinite(spread), mean, np.nan)


class RangeSums:
    """Sums of any span of non-negative numbers, each from at most 2 log2(n) sums of blocks.

    A difference of two prefix sums would cost the same, but loses all digits of a window of small
    numbers after large ones. Here only non-negative numbers are added, so that the relative error
    stays below log2(n) roundings.
    """

    def __init__(self, values: Floats, skipped: int = 0) -> None:
        """``values`` float64[n], not negative. ``skipped`` values before them were left out: sums
        are the same to the last bit as with them."""
        self.shift = skipped % (1 << max(1, values.size).bit_length())
        self.levels = [np.concatenate([np.zeros(self.shift), values]) if self.shift else values]
        while self.levels[-1].size > 1:
            below = self.levels[-1]
            even = below[: below.size // 2 * 2]
            self.levels.append(even[0::2] + even[1::2])

    def over(self, low: Int64s, high: Int64s) -> Floats:
        """float64[spans]: the sums over ``[low, high)`` of the values that are there."""
        low, high = low + self.shift, high + self.shift
        total = np.zeros(low.size)
        for level in self.levels:
            odd = np.flatnonzero((low < high) & (low & 1 == 1))
            total[odd] += level[low[odd]]
            low[odd] += 1
            odd = np.flatnonzero((low < high) & (high & 1 == 1))
            high[odd] -= 1
            total[odd] += level[high[odd]]
            low >>= 1
            high >>= 1
        return total


def checked(
    events: Events, marks_ns: npt.ArrayLike, distance: npt.ArrayLike
) -> tuple[Int64s, Floats]:
    """The marks and distances as columns.

    Raises:
        ValueError: ``distance`` is not one number for each key.
    """
    distances = np.asarray(distance, dtype=np.float64)
    if distances.shape != (len(events.keys),):
        raise ValueError("one distance for each key is needed")
    return np.atleast_1d(np.asarray(marks_ns, dtype=np.int64)), distances


def not_negative(**arguments: float) -> None:
    """Refuse a negative argument by its name.

    Raises:
        ValueError: there is one.
    """
    for name, value in arguments.items():
        if not value >= 0:
            raise ValueError(f"{name} is negative")


def count_within(times: Int64s, begins: Int64s, ends: Int64s) -> Int64s:
    """int64[spans]: how many of the sorted ``times`` lie in each closed span."""
    return np.searchsorted(times, ends, side="right") - np.searchsorted(times, begins, side="left")


def beside_none(values: Floats) -> Floats:
    """Move a score that happens to be 9999.9 away from ``NONE``."""
    return np.where(values == NONE, np.nextafter(NONE, np.inf), values)
