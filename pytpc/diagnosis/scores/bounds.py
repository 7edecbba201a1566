"""Type II of SPEC 7 where the policy ``edges`` kept summaries instead of every evaluation.

A summary says of all evaluations of one comparison, thread and period: how many, the smallest and
largest cmp - thresh, the mean of its absolute value, the extremes of the values. The flops are
events, so their number is exact. A summary that lies within the window, or outside of it, gives its
part of D exactly. Of one that straddles an end of the window, or m, any number of its evaluations
may be in the window; D then lies between the smallest and the largest mean that they allow:

- |cmp - thresh| of each lies in [a, b], and n of them sum to A. The fewest that k of them can sum
  to, and the most, is as if n - K of them were b and K were a, K = (n b - A) / (b - a): the
  smallest sum takes those at a first, the largest those at b.
- So the smallest mean over the window takes, from all straddling summaries, whatever lies below the
  mean, and no more; likewise the largest. That is a fractional program; Dinkelbach's iteration
  (Management Science 13, 1967) settles it in a few steps.
- max_i - min_i is at least that of what is known to be up to m, and at most that with all
  summaries that began before it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from pytpc.diagnosis.scores.scores import (
    DEFAULT,
    EQUAL,
    NONE,
    Before,
    Formula,
    RangeSums,
    beside_none,
    checked,
    count_within,
    type2,
)
from pytpc.recording.events import Bools, Events, Floats, Int64s
from pytpc.recording.summaries import Summaries

# How far the time of a report may be outside of the summary that has it: a report on /rosout has
# the time at which it was written, and the two may come by different clocks. Under ``edges`` a
# report is a flop or a first one, so that of others hardly any doubt is left.
_FLOP_SLACK_NS = 100_000_000
_SLACK_NS = 1_000_000


class Bounds(NamedTuple):
    """float64[marks, keys] each: ``low`` <= the exact score <= ``high``, up to rounding.

    ``value`` is between them: evaluations of a straddling summary taken as spread evenly over it.
    All three are the same number where the score is exact. Where there may be no score at all,
    ``high`` is at least ``NONE``; where there is none, all three are ``NONE``.
    """

    low: Floats
    value: Floats
    high: Floats


class Reports(NamedTuple):
    """What scores are worked out from.

    ``before`` is what was before the first of ``events`` and ``summaries``, the extremes of earlier
    summaries among it; None: nothing.
    """

    events: Events
    summaries: Summaries
    before: Before | None = None


def type2_bounds(
    reports: Reports,
    marks_ns: npt.ArrayLike,
    distance: npt.ArrayLike,
    formula: Formula = DEFAULT,
) -> Bounds:
    """Type II from first evaluations, flops and summaries; the arguments are those of ``type2``.

    Keys of ``summaries`` that are not among ``events.keys`` are left out. A key may have both
    summaries and evaluations that are in none (another node, or another policy before).

    Raises:
        ValueError: ``distance`` is not one number for each key, or an argument is negative.
    """
    events, summaries, before = reports
    earlier = before or Before.nothing(len(events.keys))
    plain = type2(events, marks_ns, distance, formula, earlier)
    marks, distances = checked(events, marks_ns, distance)
    begins = marks - round(formula.window_s * 1e9)
    bounds = Bounds(plain, plain.copy(), plain.copy())
    nearness = distances / distances.max(initial=1.0)
    for code, key in enumerate(events.keys):
        if key not in summaries.keys:
            continue
        rows = np.flatnonzero(summaries.key == summaries.keys.index(key))
        if rows.size:
            # What is beyond a double is looked for where it matters, in ``scores``.
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                own = _Key(events, code, summaries, rows, earlier)
                columns = own.scores(begins, marks, formula, float(nearness[code]))
            for table, column in zip(bounds, columns, strict=True):
                table[:, code] = column
    return bounds


class _Spread(NamedTuple):
    """max - min up to each mark, at least and at most."""

    least: Floats
    most: Floats


class _Key:
    """The summaries of one key, and its evaluations that are in none, each as one of its own."""

    def __init__(
        self, events: Events, code: int, summaries: Summaries, rows: Int64s, before: Before
    ) -> None:
        self.before = float(before.highest[code]), float(before.lowest[code])
        evaluations = events.by_key.rows(code)
        flop = events.flop[evaluations]
        self.flops = events.time_ns[evaluations[flop]]
        finite = np.isfinite(events.cmp[evaluations]) & np.isfinite(events.thresh[evaluations])
        held = covered(events, evaluations, summaries, rows)
        self.known = evaluations[finite]
        self.times = events.time_ns[self.known]
        self.highest = _running_max(np.maximum(events.cmp[self.known], events.thresh[self.known]))
        self.lowest = -_running_max(-np.minimum(events.cmp[self.known], events.thresh[self.known]))
        alone = evaluations[finite & ~held]
        diff = events.cmp[alone] - events.thresh[alone]
        count = (summaries.count - summaries.odd)[rows]
        rows, count = rows[count > 0], count[count > 0]
        one, other = summaries.begin_ns[rows], summaries.end_ns[rows]
        at = events.time_ns[alone]
        low = np.minimum(events.cmp[alone], events.thresh[alone])
        high = np.maximum(events.cmp[alone], events.thresh[alone])
        # A clock that was put back may have turned a span round.
        begin = np.concatenate([np.minimum(one, other), at])
        end = np.concatenate([np.maximum(one, other), at])
        order = np.argsort(end, kind="stable")
        self.begin, self.end = begin[order], end[order]
        self.count = np.concatenate([count, np.ones(at.size, np.int64)])[order]
        self.far = np.concatenate([summaries.far[rows], np.abs(diff) > EQUAL])[order]
        mean = np.concatenate([summaries.abs_mean[rows], np.abs(diff)])[order]
        least = np.concatenate([summaries.diff_min[rows], diff])[order]
        most = np.concatenate([summaries.diff_max[rows], diff])[order]
        self.low = np.concatenate([summaries.low[rows], low])[order]
        self.high = np.concatenate([summaries.high[rows], high])[order]
        self.largest = np.maximum(np.abs(least), np.abs(most))
        nearest = np.minimum(np.abs(least), np.abs(most))
        self.smallest = np.where((least <= 0) & (most >= 0), 0.0, nearest)
        held = np.clip(mean, self.smallest, self.largest)
        self.mean = np.where(np.isfinite(mean + self.largest), held, np.inf)
        self.sum = self.mean * self.count

    def scores(
        self, begins: Int64s, marks: Int64s, formula: Formula, nearness: float
    ) -> tuple[Floats, Floats, Floats]:
        """The least, likely and greatest score at each mark."""
        window = self._window(begins, marks)
        spread = self._spread(marks)
        sure = window.number > 0
        sure |= (count_within(self.times, begins, marks) > 0) & window.some
        none = ~window.some | (spread.most <= 0)
        low = window.least() / spread.most
        high = window.most() / spread.least
        value = window.likely() / np.where(spread.least > 0, spread.least, spread.most)
        # Where something is beyond a double all that is known is that no difference exceeds the
        # spread.
        wild = ~(np.isfinite(low) & np.isfinite(spread.most))
        low = np.where(wild, 0.0, low)
        high = np.where(wild | ~(high <= 1.0), 1.0, high)
        value = np.clip(np.where(np.isfinite(value), value, 1.0), low, high)
        factor = np.maximum(1.0, count_within(self.flops, begins, marks)) ** formula.beta
        factor = factor * nearness**formula.delta
        far = [window.far**formula.gamma, window.far_likely() ** formula.gamma]
        far.append(window.far_most() ** formula.gamma)
        scores = [
            beside_none(ratio**formula.alpha * factor * n)
            for ratio, n in zip((low, value, high), far, strict=True)
        ]
        doubtful = ~sure | (spread.least <= 0)
        scores[2] = np.where(doubtful, np.maximum(scores[2], NONE), scores[2])
        first, likely, last = (np.where(none, NONE, column) for column in scores)
        return first, likely, last

    def _spread(self, marks: Int64s) -> _Spread:
        """From what had ended by each mark, and from all that had begun."""
        order = np.argsort(self.begin, kind="stable")
        ended = np.searchsorted(self.end, marks, side="right")
        begun = np.searchsorted(self.begin[order], marks, side="right")
        known = np.searchsorted(self.times, marks, side="right")
        found = []
        for rows, count in ((slice(None), ended), (order, begun)):
            highest = _up_to(_running_max(self.high[rows]), count)
            lowest = _up_to(_running_max(-self.low[rows]), count)
            highest = np.maximum(highest, _up_to(self.highest, known))
            lowest = np.maximum(lowest, _up_to(-self.lowest, known))
            highest = np.maximum(highest, self.before[0])
            lowest = np.maximum(lowest, -self.before[1])
            found.append(np.where(np.isfinite(highest), highest + lowest, 0.0))
        return _Spread(*found)

    def _window(self, begins: Int64s, marks: Int64s) -> _Window:
        """What is in each window for sure, and what straddles its ends."""
        first = np.searchsorted(self.end, begins, side="left")
        last = np.searchsorted(self.end, marks, side="right")
        # The few that are much longer than the others are looked at for every mark; any other that
        # straddles the beginning ends at most ``longest`` after it.
        span = self.end - self.begin
        longest = np.quantile(span, 0.99, method="lower") if span.size else 0
        short = np.flatnonzero(span <= longest)
        ends = self.end[short]
        middle = np.searchsorted(ends, np.minimum(begins + longest, marks), side="right")
        inner = np.searchsorted(ends, begins, side="left"), middle
        outer = np.searchsorted(ends, marks, side="right")
        by_begin = short[np.argsort(self.begin[short], kind="stable")]
        upper = np.searchsorted(self.begin[by_begin], marks, side="right")
        lower = np.searchsorted(self.begin[by_begin], marks - longest, side="left")
        long = np.flatnonzero(span > longest)
        every = np.zeros(marks.size, np.int64), np.full(marks.size, long.size)
        pairs = [_pairs(short, *inner), _pairs(by_begin, lower, upper), _pairs(long, *every)]
        after = self.end[pairs[1][1]] > marks[pairs[1][0]]
        pairs[1] = pairs[1][0][after], pairs[1][1][after]
        mark, row = (np.concatenate(columns) for columns in zip(*pairs, strict=True))
        within = (self.end[row] >= begins[mark]) & (self.begin[row] <= marks[mark])
        mark, row = mark[within], row[within]
        whole = (self.begin[row] >= begins[mark]) & (self.end[row] <= marks[mark])
        sums = RangeSums(self.sum[short]).over(middle, outer)
        counts = np.concatenate([[0], np.cumsum(self.count[short])])
        fars = np.concatenate([[0], np.cumsum(self.far[short])])
        ours, theirs = (mark[whole], row[whole]), (mark[~whole], row[~whole])
        beyond = np.where(np.isfinite(self.sum[theirs[1]]), 0.0, np.inf)
        return _Window(
            total=sums
            + _sum_by(ours[0], self.sum[ours[1]], marks.size)
            + _sum_by(theirs[0], beyond, marks.size),
            number=counts[outer]
            - counts[middle]
            + _sum_by(ours[0], self.count[ours[1]], marks.size),
            far=fars[outer] - fars[middle] + _sum_by(ours[0], self.far[ours[1]], marks.size),
            some=(last > first) | (np.bincount(theirs[0], minlength=marks.size) > 0),
            mark=theirs[0],
            parts=self._parts(theirs[1], begins[theirs[0]], marks[theirs[0]]),
        )

    def _parts(self, rows: Int64s, begins: Int64s, marks: Int64s) -> _Parts:
        """What straddles, each as some evaluations at its smallest difference and at its largest;
        ``share`` of it is likely in the window."""
        smallest, largest = self.smallest[rows], self.largest[rows]
        share = (largest - self.mean[rows]) / (largest - smallest)
        small = np.clip(np.nan_to_num(share, nan=0.0), 0.0, 1.0) * self.count[rows]
        inside = np.minimum(self.end[rows], marks) - np.maximum(self.begin[rows], begins)
        share = inside / (self.end[rows] - self.begin[rows])
        return _Parts(
            length=np.concatenate([small, self.count[rows] - small]),
            slope=np.concatenate([smallest, largest]),
            total=self.sum[rows] * share,
            number=self.count[rows] * share,
            far=self.far[rows],
            share=share,
        )


class _Parts(NamedTuple):
    """Straddling summaries; ``length`` and ``slope`` have two for each."""

    length: Floats
    slope: Floats
    total: Floats
    number: Floats
    far: Int64s
    share: Floats


class _Window(NamedTuple):
    """The windows of all marks: what is inside, and ``parts`` that straddle, of ``mark`` each."""

    total: Floats
    number: Floats
    far: Floats
    some: Bools
    mark: Int64s
    parts: _Parts

    def least(self) -> Floats:
        """The smallest mean difference at each mark."""
        return self._extreme(1.0)

    def most(self) -> Floats:
        """The largest."""
        return -self._extreme(-1.0)

    def likely(self) -> Floats:
        """The mean if every straddling summary is evenly spread."""
        total = self.total + _sum_by(self.mark, self.parts.total, self.total.size)
        count = self.number + _sum_by(self.mark, self.parts.number, self.total.size)
        return total / count

    def far_likely(self) -> Floats:
        """n_i likewise."""
        return self.far + _sum_by(self.mark, self.parts.far * self.parts.share, self.far.size)

    def far_most(self) -> Floats:
        """n_i with all that may be in the window."""
        return self.far + _sum_by(self.mark, self.parts.far, self.far.size)

    def _extreme(self, sign: float) -> Floats:
        """The smallest mean of ``sign`` times the differences, over any share of each part."""
        mark = np.concatenate([self.mark, self.mark])
        length, slope = self.parts.length, sign * self.parts.slope
        taken = np.ones(mark.size, np.bool_)
        while True:
            weight = np.where(taken, length, 0.0)
            gain = np.where(weight > 0, weight * slope, 0.0)
            total = sign * self.total + _sum_by(mark, gain, self.total.size)
            count = self.number + _sum_by(mark, weight, self.total.size)
            mean = total / count
            fewer = taken & (slope < mean[mark])
            # The last part of a window that has nothing else is that mean itself.
            left = self.number + _sum_by(mark, np.where(fewer, length, 0.0), self.total.size)
            fewer |= taken & (left[mark] <= 0)
            if np.array_equal(fewer, taken):
                return mean
            taken = fewer


def covered(events: Events, rows: Int64s, summaries: Summaries, own: Int64s) -> Bools:
    """bool[rows]: evaluations that one of the summaries ``own`` of the same node has taken in."""
    covered = np.zeros(rows.size, np.bool_)
    times, nodes = events.time_ns[rows], events.node[rows]
    telling = events.flop[rows] | (events.previous[rows] < 0)
    slack = np.where(telling, _FLOP_SLACK_NS, _SLACK_NS)
    for code, node in enumerate(events.nodes):
        if node not in summaries.nodes:
            continue
        theirs = own[summaries.node[own] == summaries.nodes.index(node)]
        mine = np.flatnonzero(nodes == code)
        if not theirs.size or not mine.size:
            continue
        order = np.argsort(summaries.begin_ns[theirs], kind="stable")
        begin = summaries.begin_ns[theirs][order]
        end = np.maximum.accumulate(summaries.end_ns[theirs][order])
        before = np.searchsorted(begin, times[mine] + slack[mine], side="right") - 1
        covered[mine] = (before >= 0) & (end[before] >= times[mine] - slack[mine])
    return covered


def _pairs(rows: Int64s, first: Int64s, last: Int64s) -> tuple[Int64s, Int64s]:
    """(mark, row) for each of ``rows[first:last]`` of each mark."""
    lengths = np.maximum(last - first, 0)
    mark = np.repeat(np.arange(first.size), lengths)
    start = np.cumsum(lengths) - lengths
    return mark, rows[np.arange(mark.size) - start[mark] + first[mark]]


def _sum_by(mark: Int64s, values: npt.NDArray[np.generic], size: int) -> Floats:
    sums = np.bincount(mark, weights=values.astype(np.float64), minlength=size)
    return sums.astype(np.float64)  # without a mark at all it is of integers


def _running_max(values: Floats) -> Floats:
    return np.maximum.accumulate(values) if values.size else values


def _up_to(running: Floats, count: Int64s) -> Floats:
    """The running maximum of the first ``count``, -inf for none."""
    return np.concatenate([[-np.inf], running])[count]
