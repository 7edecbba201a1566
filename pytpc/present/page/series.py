"""The data of the plots, from the events: thinned to what a plot can show, extremes kept."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pytpc.recording.events import Bools, Floats, Int64s
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries

POINTS = 1200
"""The most points of a line; a plot is about 600 pixels wide."""

SPANS = 300
"""The most summaries in a plot."""

BINS = 600
"""The number of columns of a lane of the timeline."""

NOTHING, FALSE, TRUE, BOTH = range(4)
"""What was evaluated in a column of a lane."""

_AROUND_S = (20.0, 6.0)
_FLOP_MARGIN_S = 4.0
_GAP_S = 2.0
_GAP_FACTOR = 10.0
_HOLD_PERIODS = 3.0


@dataclass(frozen=True, slots=True)
class PlotData:
    """The evaluations of one TPC around a mark; times are seconds since the recording began.

    ``time``, ``cmp`` and ``thresh`` are float64[n], at most ``POINTS`` and the gaps: a NaN stands
    where the TPC was not evaluated for a while. ``steps`` float64[k] and ``outcome`` bool[k] are
    the changes of the result, among ``evaluations`` evaluations until ``ends``. ``kept``
    float64[4, k] are the summaries, see `kept_of`, and ``kept_results`` their results, see
    `results_of`.
    """

    time: Floats
    cmp: Floats
    thresh: Floats
    steps: Floats
    outcome: Bools
    ends: float
    flops: Floats
    evaluations: int
    begin: float
    end: float
    kept: Floats
    kept_results: Floats


def kept_of(summaries: Summaries, key: str, start_ns: int) -> Floats:
    """float64[4, k]: begin and end of each summary of a TPC, lowest and highest compared value.

    Times are seconds since the recording began; summaries without finite values are left out.
    """
    own = summaries.take(summaries.rows_of(key))
    found = np.stack(
        [
            (own.begin_ns - start_ns) / 1e9,
            (own.end_ns - start_ns) / 1e9,
            own.thresh + own.diff_min,
            own.thresh + own.diff_max,
        ]
    )
    return found[:, np.isfinite(found).all(axis=0)]


def results_of(summaries: Summaries, key: str, start_ns: int) -> Floats:
    """float64[4, k]: begin and end of each summary of a TPC, least and greatest result (0 or 1).

    Times are seconds since the recording began. A summary with flops has both results.
    """
    own = summaries.take(summaries.rows_of(key))
    both = own.flops > 0
    times = (np.stack([own.begin_ns, own.end_ns]) - start_ns) / 1e9
    return np.concatenate([times, [own.result & ~both, own.result | both]]).astype(np.float64)


def joined_spans(kept: Floats, most: int) -> Floats:
    """The summaries of `kept_of` or `results_of`, those of one column of a plot joined.

    There are at most ``most`` and one.
    A plot of 600 pixels shows no more, and each span is drawn by itself.
    """
    if kept.shape[1] <= most:
        return kept
    begin, end, lowest, highest = kept
    width = (float(end.max()) - float(begin.min())) / most
    column = np.floor((begin - begin.min()) / width if width > 0 else np.zeros(begin.size))
    order = np.argsort(column, kind="stable")
    first = np.flatnonzero(np.diff(column[order], prepend=-1.0))
    return np.stack(
        [
            np.minimum.reduceat(begin[order], first),
            np.maximum.reduceat(end[order], first),
            np.minimum.reduceat(lowest[order], first),
            np.maximum.reduceat(highest[order], first),
        ]
    )


def plot_data(recording: Recording, key: str, mark_ns: int) -> PlotData:
    """The evaluations from 20 s before a mark, or from the last flop if that is earlier, to 6 s
    after it, within the recording."""
    events, start_ns, end_ns = recording.events, recording.start_ns, recording.end_ns
    rows = events.rows_of(key)
    times = events.time_ns[rows]
    begin = mark_ns - round(_AROUND_S[0] * 1e9)
    flops = times[events.flop[rows]]
    before = flops[flops <= mark_ns]
    if before.size:
        begin = min(begin, int(before[-1]) - round(_FLOP_MARGIN_S * 1e9))
    begin = max(begin, min(start_ns, mark_ns))
    end = max(min(mark_ns + round(_AROUND_S[1] * 1e9), end_ns), mark_ns)
    inside = rows[(times >= begin) & (times <= end)]
    seconds = (events.time_ns[inside] - start_ns) / 1e9
    kept = thin(seconds, events.cmp[inside], POINTS)
    lines = with_gaps(seconds[kept], events.cmp[inside][kept], events.thresh[inside][kept])
    result = events.result[inside]
    change = np.flatnonzero(np.concatenate([[True], result[1:] != result[:-1]])[: result.size])
    kept_changes = change[thin(seconds[change], result[change].astype(np.float64), POINTS)]
    shown = flops[(flops >= begin) & (flops <= end)]
    from_to = (begin - start_ns) / 1e9, (end - start_ns) / 1e9
    spans = [one(recording.summaries, key, start_ns) for one in (kept_of, results_of)]
    kept_spans, kept_results = (
        one[:, (one[1] >= from_to[0]) & (one[0] <= from_to[1])] for one in spans
    )
    return PlotData(
        time=lines[0],
        cmp=lines[1],
        thresh=lines[2],
        steps=seconds[kept_changes],
        outcome=result[kept_changes],
        ends=float(seconds[-1]) if seconds.size else 0.0,
        flops=(shown - start_ns) / 1e9,
        evaluations=int(inside.size),
        begin=from_to[0],
        end=from_to[1],
        kept=kept_spans,
        kept_results=kept_results,
    )


def thin(time: Floats, values: Floats, most: int) -> Int64s:
    """Which of n points to draw: all where n <= ``most``, else the first, last, lowest and highest
    of each of ``most``/4 equal spans of time; ascending row numbers, at most ``most``."""
    n = time.size
    if n <= most:
        return np.arange(n, dtype=np.int64)
    spans = max(1, most // 4)
    width = float(time[-1] - time[0]) or 1.0
    span = np.minimum(((time - time[0]) / width * spans).astype(np.int64), spans - 1)
    first = np.flatnonzero(np.concatenate([[True], span[1:] != span[:-1]]))
    last = np.append(first[1:], n) - 1
    # NaN must not hide the extremes of its span.
    unknown = np.isnan(values)
    low = np.lexsort((np.where(unknown, np.inf, values), span))[first]
    high = np.lexsort((np.where(unknown, -np.inf, values), span))[last]
    return np.unique(np.concatenate([first, last, low, high])).astype(np.int64)


def with_gaps(time: Floats, *columns: Floats) -> list[Floats]:
    """The columns with a NaN wherever a point comes long after the one before."""
    gap = np.flatnonzero(np.diff(time) > gap_after(time)) + 1
    return [np.insert(column, gap, np.nan) for column in (time, *columns)]


def gap_after(time: Floats) -> float:
    """Seconds without an evaluation after which a line is interrupted."""
    steps = np.diff(time)
    return max(_GAP_S, _GAP_FACTOR * float(np.median(steps))) if steps.size else _GAP_S


def lane(recording: Recording, key: str, bins: int = BINS) -> npt.NDArray[np.int8]:
    """int8[bins]: the results of the TPC ``key`` in equal spans of the mission.

    A result holds until the next one, if that comes within 2 s and three usual periods of the TPC:
    a slow TPC is not a row of dots, and a pause stays a pause. A summary with flops counts as both
    results in all of its period.
    """
    events, summaries = recording.events, recording.summaries
    start_ns, end_ns = recording.start_ns, recording.end_ns
    states = np.zeros(bins, dtype=np.int8)
    rows = events.rows_of(key)
    times, result = events.time_ns[rows], events.result[rows]
    place = (times - start_ns) * bins // max(1, end_ns - start_ns)
    place = np.clip(place, 0, bins - 1)
    states[place[result]] |= TRUE
    states[place[~result]] |= FALSE
    steps = np.diff(times)
    if steps.size:
        usual = min(_GAP_S * 1e9, _HOLD_PERIODS * float(np.median(steps)))
        for row in np.flatnonzero((np.diff(place) > 1) & (steps <= usual)):
            states[place[row] + 1 : place[row + 1]] = TRUE if result[row] else FALSE
    own = summaries.take(summaries.rows_of(key))
    if len(own):
        ends = np.stack([own.begin_ns, own.end_ns]) - start_ns
        spans = np.clip(ends * bins // max(1, end_ns - start_ns), 0, bins - 1)
        known = np.where(own.flops > 0, BOTH, np.where(own.result, TRUE, FALSE))
        for first, last, state in zip(*spans.tolist(), known.tolist(), strict=True):
            states[first : last + 1] |= state
    return states


def runs(states: npt.NDArray[np.int8]) -> list[tuple[int, int, int]]:
    """Runs of equal columns as (state, first column, number of columns), without the empty ones."""
    first = np.flatnonzero(np.concatenate([[True], states[1:] != states[:-1]]))
    lengths = np.diff(np.append(first, states.size))
    return [
        (int(states[begin]), int(begin), int(length))
        for begin, length in zip(first, lengths, strict=True)
        if states[begin] != NOTHING
    ]
