"""The score of type II where the policy ``edges`` kept summaries instead of every evaluation.

A summary describes all evaluations of one comparison, thread and period: their number, the smallest
and largest cmp - thresh, the mean of its absolute value, the extremes of the values. The flops are
events, so their number is exact. A summary inside the window gives its part of D exactly. One that
straddles an end of the window is taken as spread evenly: the share of its span inside the window
counts. The score is an estimate then; docs/explanation/decisions.md says why there are no bounds.

max_i and min_i are those of summaries that ended by m; if none did, of those that began by m.
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
FLOP_SLACK_NS = 100_000_000
_SLACK_NS = 1_000_000
_TINY = 1e-200


class LogTables(NamedTuple):
    """What scores are computed from.

    ``before`` is what was forgotten, including the extremes of forgotten summaries; None: nothing.
    """

    events: Events
    summaries: Summaries
    before: Before | None = None


def type2_of_summaries(
    reports: LogTables,
    marks_ns: npt.ArrayLike,
    distance: npt.ArrayLike,
    formula: Formula = DEFAULT,
) -> Floats:
    """Type II from first evaluations, flops and summaries; the arguments are those of ``type2``.

    Keys of ``summaries`` that are not among ``events.keys`` are left out. A key may have both
    summaries and evaluations that are in none (another node, or another policy before).

    Raises:
        ValueError: ``distance`` is not one number for each key, or an argument is negative.
    """
    events, summaries, before = reports
    earlier = before or Before.nothing(len(events.keys))
    scores = type2(events, marks_ns, distance, formula, earlier)
    marks, distances = checked(events, marks_ns, distance)
    begins = marks - round(formula.window_s * 1e9)
    nearness = distances / distances.max(initial=1.0)
    for code, key in enumerate(events.keys):
        rows = summaries.rows_of(key)
        if rows.size:
            # What is beyond a double is looked for where it matters, in ``scores``.
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                own = _KeySummaries(events, code, summaries, rows, earlier)
                scores[:, code] = own.scores(begins, marks, formula, float(nearness[code]))
    return scores


class _KeySummaries:
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
        # If the clock was set back, a span may begin after its end.
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
        largest = np.maximum(np.abs(least), np.abs(most))
        nearest = np.minimum(np.abs(least), np.abs(most))
        smallest = np.where((least <= 0) & (most >= 0), 0.0, nearest)
        # The mean of equal differences is that difference, so that equal scores stay equal.
        mean = np.where(np.isfinite(mean + largest), np.clip(mean, smallest, largest), np.inf)
        self.sum = mean * self.count

    def scores(self, begins: Int64s, marks: Int64s, formula: Formula, nearness: float) -> Floats:
        """The score at each mark."""
        window = self._window(begins, marks)
        least, most = self._spreads(marks)
        width = np.where(least > 0, least, most)
        ratio = window.total / window.number / width
        # No difference exceeds the spread: all that is known of what is beyond a double.
        ratio = np.clip(np.where(np.isfinite(ratio), ratio, 1.0), 0.0, 1.0)
        flops = np.maximum(1.0, count_within(self.flops, begins, marks))
        value = ratio**formula.alpha * flops**formula.beta * window.far**formula.gamma
        none = (window.number <= 0) | (most <= 0)
        return np.where(none, NONE, beside_none(value * nearness**formula.delta))

    def _spreads(self, marks: Int64s) -> tuple[Floats, Floats]:
        """max - min of summaries that ended by each mark, and of all that began by it."""
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
        return found[0], found[1]

    def _window(self, begins: Int64s, marks: Int64s) -> _SummedWindow:
        """What is in each window."""
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
        # The share of each that is in the window. A window that has no more than an end of a span
        # has its mean difference.
        inside = np.minimum(self.end[row], marks[mark]) - np.maximum(self.begin[row], begins[mark])
        share = np.where(span[row] > 0, np.maximum(inside / span[row], _TINY), 1.0)
        between = RangeSums(self.sum[short]).over(middle, outer)
        counts = np.concatenate([[0], np.cumsum(self.count[short])])
        fars = np.concatenate([[0], np.cumsum(self.far[short])])
        return _SummedWindow(
            between + _sum_by(mark, self.sum[row] * share, marks.size),
            counts[outer] - counts[middle] + _sum_by(mark, self.count[row] * share, marks.size),
            fars[outer] - fars[middle] + _sum_by(mark, self.far[row] * share, marks.size),
        )


class _SummedWindow(NamedTuple):
    """The evaluations in the windows of all marks: the sum of |cmp - thresh|, how many, and of how
    many it is above ``EQUAL``."""

    total: Floats
    number: Floats
    far: Floats


def covered(events: Events, rows: Int64s, summaries: Summaries, own: Int64s) -> Bools:
    """bool[rows]: evaluations that one of the summaries ``own`` of the same node has taken in."""
    covered = np.zeros(rows.size, np.bool_)
    times, nodes = events.time_ns[rows], events.node[rows]
    telling = events.flop[rows] | (events.previous[rows] < 0)
    slack = np.where(telling, FLOP_SLACK_NS, _SLACK_NS)
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
