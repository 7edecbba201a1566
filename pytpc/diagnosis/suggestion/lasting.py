"""Thresholds that would last: how far the values of a comparison get, by its history.

A mark of type II says that the robot is stuck. The usual outcome of the comparison before the mark
kept it there, so nearly all of these evaluations should have the other outcome:

- steady values: all except outliers (4 standard deviations, by the median of absolute deviations,
  so the way there does not count), and one standard deviation more;
- one decision that held for most of that time: the program acted on it and did not compare again,
  so it should not have changed, as for type I;
- values that grow towards the threshold: what half of the ramps reach; with one ramp, what it had
  reached in the middle of the window.

A mark of type I says that the outcome should not have changed. Each stay on the wrong side has an
extreme value, its peak. If n peaks are spread evenly between a begin and an unknown end, the end is
with a probability of 2/3 within 3 ** (1/n) times the way to the largest (Goodman, "Serial Number
Analysis", JASA 1952). A stay that the program itself ended by acting does not show the end: if
there is no other, n is 1, and the way is three times as long.

Each value that was tried and did not help adds a standard deviation, or raises the probability to
4/5 and 6/7 (5 and 7 in place of 3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np

from pytpc.base.columns import Bools, Floats, Int64s
from pytpc.base.off_scale import off_scale
from pytpc.diagnosis.suggestion.suggestion_case import EQUALITIES
from pytpc.diagnosis.thresholds.replay import Track
from pytpc.diagnosis.thresholds.threshold_sets import outcomes, thresholds_for
from pytpc.recording.marks import MarkType

Ground = Literal["steady", "ramps", "peaks", "growth"]
_SIGMAS = 4.0
_MAD_TO_SIGMA = 1.4826
_OUTER = 0.05
_MORE_UPS = 3
_RESET = 2.0
_RUN_UP = 5
_STEPS_BEYOND = 1.5
_WAY = 3.0


@dataclass(frozen=True, slots=True)
class Lasting:
    """What is wanted of one comparison.

    A threshold that gives ``outcome`` for the compared value ``edge`` would last; ``least`` is the
    compared value of the smallest change in this direction, ``up`` whether thresholds have to be
    higher. ``ground`` is the rule that decided, ``count`` the number of evaluations (``steady``),
    ramps or stays. ``near`` is the distance as a part of the range of the values, or how long (s)
    before the first mark the result changed; a smaller one is likelier the cause.
    """

    kind: MarkType
    outcome: bool
    edge: float
    least: float
    up: bool
    ground: Ground
    count: int
    near: float


@dataclass(frozen=True, slots=True)
class _Series:
    """Evaluations of one comparison in one node: ``time_ns``, ``cmp``, own outcome ``went``."""

    time_ns: Int64s
    cmp: Floats
    went: Bools
    thresh: Floats

    def take(self, rows: Bools | slice) -> _Series:
        return _Series(self.time_ns[rows], self.cmp[rows], self.went[rows], self.thresh[rows])


def lasting(
    track: Track, kind: MarkType, marks_ns: Sequence[int], window_s: float, tries: int = 0
) -> Lasting | None:
    """What would last for one comparison; None if the log does not say.

    Args:
        track: its evaluations.
        kind: the type of error.
        marks_ns: the marks of this type, at least one.
        window_s: the window before a mark.
        tries: how many values were tried and did not help.
    """
    relation = track.comparison.relation
    if relation == "flag" or relation in EQUALITIES:
        return None
    series = _series(track, max(marks_ns))
    if not series.cmp.size:
        return None
    window = round(window_s * 1e9)
    marks = np.sort(np.asarray(marks_ns, dtype=np.int64))
    if kind == "II":
        return _standing(series, relation, marks, window, tries)
    return _stays(series, relation, marks, window, tries)


def _series(track: Track, end_ns: int) -> _Series:
    """The finite evaluations up to a time in the busiest node; of summaries both ends.

    Without those off the scale: no threshold can be meant for them.
    """
    kept = track.kept.take(track.kept.end_ns <= end_ns)
    low, high = kept.thresh + kept.diff_min, kept.thresh + kept.diff_max
    time_ns = np.concatenate([track.time_ns, kept.begin_ns, kept.end_ns])
    cmp = np.concatenate([track.cmp, low, high])
    thresh = np.concatenate([track.thresh, kept.thresh, kept.thresh])
    node = track.node
    good = np.isfinite(cmp) & np.isfinite(thresh) & (time_ns <= end_ns)
    if node.size and np.ptp(node) > 0:
        most = int(np.argmax(np.bincount(node[track.time_ns <= end_ns], minlength=1)))
        good[: node.size] &= node == most
    good[good] = ~off_scale(cmp[good], thresh[good])
    order = np.argsort(time_ns, kind="stable")
    order = order[good[order]]
    cmp, thresh = cmp[order], thresh[order]
    went = outcomes(track.comparison.relation, cmp, thresh)
    return _Series(time_ns[order], cmp, went, thresh)


def _is_up(relation: str, outcome: bool) -> bool:
    """Whether higher thresholds give an outcome."""
    return bool(np.isinf(thresholds_for(relation, 0.0, outcome)[0].high))


def _standing(
    series: _Series, relation: str, marks: Int64s, window: int, tries: int
) -> Lasting | None:
    inside = np.zeros(series.time_ns.size, dtype=np.bool_)
    for mark in marks.tolist():
        inside |= (series.time_ns >= mark - window) & (series.time_ns <= mark)
    part = series.take(inside)
    decided = _held(series, marks, window)
    if decided is not None:
        found = _stays(decided, relation, marks, window, tries)
        if found is not None:
            way = found.least - float(series.thresh[-1])
            return replace(found, kind="II", near=_share(way, series))
    if not part.cmp.size:
        return None
    outcome = not bool(np.mean(part.went) >= 1 / 2)
    up = _is_up(relation, outcome)
    # Worked out as if higher thresholds were wanted.
    sign = 1.0 if up else -1.0
    values = sign * part.cmp
    stuck = values[part.went != outcome]
    near = _share(float(np.min(stuck)) - sign * float(part.thresh[-1]), series)
    ramps = _ramps(-values)
    if ramps is None:
        edge = _steady_end(values, tries)
        why: tuple[Ground, int] = ("steady", part.cmp.size)
    else:
        first = values[part.time_ns <= marks[0]]
        peaks = -ramps if ramps.size > 1 else (first if first.size else values)
        edge = float(np.quantile(peaks, min(1.0, 1 / 2 + tries / 4), method="higher"))
        why = ("ramps", ramps.size)
    least = float(np.min(stuck))
    return Lasting("II", outcome, sign * max(edge, least), sign * least, up, *why, near)


def _held(series: _Series, marks: Int64s, window: int) -> _Series | None:
    """The evaluations behind a decision that held for most of the time before the first marks.

    None if there is none. The program acted on the decision and did not compare again. They begin
    at the change before the one that decided.
    """
    begin, end = int(marks[0]) - window, int(marks[marks <= marks[0] + window][-1])
    until = series.take(series.time_ns <= end)
    if not until.time_ns.size or 2 * (end - max(begin, int(until.time_ns[-1]))) <= end - begin:
        return None
    change = np.flatnonzero(until.went[1:] != until.went[:-1]) + 1
    return until.take(slice(int(change[-2]) if change.size > 1 else 0, None))


def _share(way: float, series: _Series) -> float:
    every = np.concatenate([series.cmp, series.thresh])
    size = float(np.ptp(every))
    return abs(way) / size if size else 0.0


def _steady_end(values: Floats, tries: int) -> float:
    """Above all steady values and their noise; for values below 0 at most half of the way to 0."""
    middle = float(np.median(values))
    sigma = _MAD_TO_SIGMA * float(np.median(np.abs(values - middle)))
    if sigma == 0:
        end = float(np.quantile(values, 1 - _OUTER, method="higher"))
        return end + (end - middle) * tries
    end = float(np.max(values[np.abs(values - middle) <= _SIGMAS * sigma]))
    beyond = end + sigma * (1 + tries)
    return min(beyond, end / 2) if end < 0 else beyond


def _ramps(values: Floats) -> Floats | None:
    """The peaks of values that grow and are reset; None if they do not grow."""
    steps = np.diff(values)
    ups, downs = steps[steps > 0], steps[steps < 0]
    if ups.size < _MORE_UPS * max(1, downs.size):
        return None
    if downs.size and float(np.min(-downs)) < _RESET * float(np.median(ups)):
        return None
    if np.count_nonzero(steps == 0) > steps.size / 2:
        return None
    return np.asarray(values[np.append(np.flatnonzero(steps < 0), values.size - 1)])


def _stays(
    series: _Series, relation: str, marks: Int64s, window: int, tries: int
) -> Lasting | None:
    """What would last by the stays on the wrong side; the first change in the window began them."""
    change = np.flatnonzero(series.went[1:] != series.went[:-1]) + 1
    if not change.size and series.time_ns[0] >= marks[0] - window:
        # What was never evaluated before had no outcome, and this one is the change.
        change = np.zeros(1, dtype=np.int64)
    when = series.time_ns[change]
    first = _first_change(when, marks, window)
    if first is None:
        return None
    base = not bool(series.went[change[first]])
    up = _is_up(relation, base)
    sign = 1.0 if up else -1.0
    values, threshs = sign * series.cmp, sign * series.thresh
    recent = series.time_ns >= min(int(marks[0]) - window, int(when[first]))
    step = _step(values[recent])
    peaks, ended = [], []
    for begin, end in pairwise([*change[first:].tolist(), values.size]):
        if bool(series.went[begin]) == base or not _is_before(
            int(series.time_ns[begin]), marks, window
        ):
            continue
        peak = float(np.max(values[begin:end]))
        is_near = peak - float(threshs[begin]) <= _STEPS_BEYOND * step
        peaks.append(peak)
        cut = is_near and _climbs(values[max(0, begin - _RUN_UP) : begin + 1])
        ended.append(end < values.size and not cut)
    before = values[(series.went == base) & recent]
    lowest = float(np.quantile(before, _OUTER, method="lower")) if before.size else 0.0
    lowest = min(lowest, _begin_of_climb(values[: change[first] + 1]))
    count = max(1, sum(ended))
    edge = _estimate(max(peaks), lowest, (_WAY + 2 * tries) ** (1 / count))
    if np.max(values) <= 0:
        # What is never on the other side of 0 does not get there.
        edge = min(edge, 0.0)
    ground: Ground = "peaks" if any(ended) else "growth"
    least = sign * float(values[change[first]])
    near = (int(marks[0]) - int(when[first])) / 1e9
    # Of -0.0 it would be said "at most -0".
    return Lasting("I", base, sign * edge + 0.0, least, up, ground, count, near)


def _first_change(when: Int64s, marks: Int64s, window: int) -> int | None:
    """The first change in the window before the first mark, or else the last one before it.

    If there is none, the first change in the windows before the other marks.
    """
    early = when <= marks[0]
    soon = np.flatnonzero(early & (when >= marks[0] - window))
    if soon.size:
        return int(soon[0])
    if early.any():
        return int(np.flatnonzero(early)[-1])
    later = [n for n, time_ns in enumerate(when.tolist()) if _is_before(time_ns, marks, window)]
    return later[0] if later else None


def _is_before(time_ns: int, marks: Int64s, window: int) -> bool:
    """Whether a mark may mean a stay that began then."""
    inside = (time_ns >= marks - window) & (time_ns <= marks)
    return bool(np.any(inside)) or time_ns <= int(marks[0])


def _step(values: Floats) -> float:
    steps = np.abs(np.diff(values))
    steps = steps[steps > 0]
    return float(np.median(steps)) if steps.size else 0.0


def _climbs(values: Floats) -> bool:
    """Whether the values grow steadily, not in one jump."""
    steps = np.diff(values)
    return bool(np.all(steps >= 0)) and int(np.count_nonzero(steps > 0)) > 1


def _begin_of_climb(values: Floats) -> float:
    """Where the climb to the last value began, perhaps long before the window."""
    falls = np.flatnonzero(np.diff(values) < 0)
    return float(values[falls[-1] + 1 if falls.size else 0])


def _estimate(peak: float, begin: float, factor: float) -> float:
    """Beyond the peak, by the way from the begin or by the value itself, whichever is less far."""
    by_way = begin + (peak - begin) * factor
    if peak == 0:
        return by_way
    by_size = peak * factor if peak > 0 else peak / factor
    return min(by_way, by_size) if by_way > peak else by_size
