"""Keeps of comparisons in hot loops what the policy ``edges`` would: flops, and summaries.

A file with more reports than fit into memory is condensed while it is read. The summaries of a
period are cut at the ends of the windows before the marks, so that each is in a window or outside:
the score of type II is then that of all evaluations, but for the rounding of sums.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Bools, Floats, Int32s, Int64s, order_of, recode
from pytpc.base.wording import many
from pytpc.ingest.gathering import EVENT_ROW, SUMMARY_ROW, Channel, Gathering, ReportColumns
from pytpc.ingest.spool import Rows
from pytpc.recording.events import Events
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries

WINDOW_NS = 12 * 10**9
"""The window of type II. A question with another one gets estimates."""
WHOLE_ROWS = 1 << 20
"""Comparisons that together have at most so many reports keep each of them."""
_PERIOD_NS = 10**8
_MOST_SUMMARIES = 1 << 19
_MOST_FLOPS = 1 << 21
_HELD = 1 << 16
_FAR = 1e-4
_SUMS = ("count", "flops", "far", "odd", "diff_mean", "abs_mean")


class Extent(NamedTuple):
    """How long a recording is, about, and in how many blocks it comes.

    ``period_ns`` is the length of a period; None: as short as the number of summaries allows, and
    then the user is told why the reports are condensed.
    """

    seconds: float
    blocks: int
    period_ns: int | None = None


class Condenser:
    """Takes the reports of one process, and hands in what is kept of them.

    They come in the order of time, or those of each key do where all of them are condensed.

    Args:
        gathering: takes in events and summaries. Its marks must be known.
        channel: of the process.
        node: code of its node.
        hot: bool[n]: for each code of a key whether its reports are condensed.
        extent: of the recording.
    """

    def __init__(
        self, gathering: Gathering, channel: Channel, node: int, hot: Bools, extent: Extent
    ) -> None:
        self._gathering = gathering
        self._channel = channel
        self._node = node
        self._hot = hot
        self._is_all = bool(hot.all())
        comparisons = max(1, int(np.count_nonzero(hot)))
        shortest = round(extent.seconds * 1e9 * comparisons / _MOST_SUMMARIES)
        self._period_ns = extent.period_ns or max(_PERIOD_NS, shortest)
        self._is_asked_for = extent.period_ns is not None
        # All flops are kept until there are very many; then so many of a comparison in a block.
        self._flops_left = _MOST_FLOPS
        self._most_flops = max(2, _MOST_FLOPS // (max(1, extent.blocks) * comparisons))
        marks = [*gathering.known_marks(), *gathering.marks_nearby]
        self._cuts = _window_ends([mark.time_ns for mark in marks])
        # Outcome of the last evaluation of each key, -1 before the first.
        self._last = np.full(hot.size, -1, np.int8)
        self._held: list[tuple[Rows, Int64s]] = []
        self._held_rows = 0
        self._span = (2**63 - 1, -(2**63))
        self._condensed = 0
        self._uncounted_flops = 0

    def add(self, block: ReportColumns) -> None:
        """Take in reports, at least one."""
        first, last = int(block.time_ns.min()), int(block.time_ns.max())
        self._span = min(self._span[0], first), max(self._span[1], last)
        if self._is_all:
            kept = self._condense(block)
        else:
            hot = self._hot[block.key]
            rows = np.flatnonzero(hot)
            whole = ~hot
            if rows.size:
                whole[self._condense(block, rows)] = True
            kept = np.flatnonzero(whole)
        self._gathering.add_events(self._channel, self._node, _part(block, kept))
        if self._held_rows >= _HELD:
            self._join()

    def finish(self) -> None:
        """Hand in the summaries, and say what was done."""
        if not self._held:
            return
        self._join()
        rows, _ = self._held[0]
        finite = (rows["count"] - rows["odd"]).astype(np.float64)
        finite[finite == 0] = np.nan
        with np.errstate(all="ignore"):
            rows["diff_mean"] /= finite
            rows["abs_mean"] /= finite
        self._gathering.summaries.append(rows)
        self._gathering.spans.append(self._span)
        if not self._is_asked_for:
            self._gathering.notes.append(self._note(rows))

    def _note(self, rows: Rows) -> str:
        comparisons = many(np.unique(rows["key"]).size, "comparison")
        period = f"{self._period_ns / 1e9:.1f} s"
        note = (
            f"{self._channel.source}: {many(self._condensed, 'evaluation')} of {comparisons} in hot"
            f" loops do not fit into memory: only their flops and summaries of {period} are used"
        )
        if self._uncounted_flops:
            note += (
                f", without {many(self._uncounted_flops, 'flop')} that others follow within"
                f" {period}, as there are very many"
            )
        note += (
            f"; at other times than marks, and with another window than {WINDOW_NS // 10**9} s, the"
            " score of type II is an estimate"
        )
        return note

    def _condense(self, block: ReportColumns, some: Int64s | None = None) -> Int64s:
        """Which of the reports, or of some, are kept as events; the others are in a summary."""
        key, time_ns = block.key, block.time_ns
        if some is not None:
            key, time_ns = key[some], time_ns[some]
        order = order_of(key)
        bounds, in_turn = self._periods(time_ns)
        key, time_ns, period = key[order], time_ns[order], in_turn[order]
        rows = order if some is None else some[order]
        result = block.result[rows]
        new_key = np.concatenate([[True], key[1:] != key[:-1]])
        starts = np.flatnonzero(new_key | np.concatenate([[True], period[1:] != period[:-1]]))
        heads = np.flatnonzero(new_key)
        tails = np.append(heads[1:], key.size) - 1
        before = np.empty(key.size, np.int8)
        before[1:] = result[:-1]
        before[heads] = self._last[key[heads]]
        self._last[key[tails]] = result[tails]
        flop = (before != result) & (before >= 0)
        flops = np.add.reduceat(flop, starts, dtype=np.int64)
        kept = self._some(flop, flops, starts) | (before < 0)
        partial = _summaries(block, rows, starts)
        partial["key"], partial["node"] = key[starts], self._node
        partial["channel"] = self._channel.code
        partial["flops"] = flops
        partial["begin_ns"] = np.minimum.reduceat(time_ns, starts)
        partial["end_ns"] = np.maximum.reduceat(time_ns, starts)
        self._held.append((partial, bounds[period[starts]]))
        self._held_rows += starts.size
        self._condensed += rows.size
        found: Int64s = np.sort(rows[kept])
        return found

    def _periods(self, time_ns: Int64s) -> tuple[Int64s, Int64s]:
        """The beginnings of periods, and for each report the number of its period."""
        first, last = int(time_ns.min()), int(time_ns.max())
        step = self._period_ns
        if (last - first) // step < time_ns.size:
            grid = np.arange(first // step * step, last + 1, step, dtype=np.int64)
        else:
            # The clock was set within the block: most periods in between have no report.
            grid = np.unique(time_ns // step) * step
        # A cut before this block may be in the same period.
        within = self._cuts[(self._cuts > grid[0]) & (self._cuts <= last)]
        bounds = np.union1d(grid, within)
        if bounds.size == 1:
            return bounds, np.zeros(time_ns.size, np.int64)
        # If the clock was set back, a report stays in the period of the one before it.
        begins = np.searchsorted(np.maximum.accumulate(time_ns), bounds, "left")
        return bounds, np.repeat(np.arange(bounds.size), np.diff(begins, append=time_ns.size))

    def _some(self, flop: Bools, flops: Int64s, starts: Int64s) -> Bools:
        """The flops that are kept: of very many in one period the last ones.

        An even number is left out, so that those that are kept still alternate.
        """
        self._flops_left -= int(flops.sum())
        if self._flops_left >= 0:
            return flop
        out = np.maximum(0, flops - self._most_flops) & ~1
        self._uncounted_flops += int(out.sum())
        number = np.cumsum(flop)
        before = number[starts] - flop[starts] + out
        lengths = np.diff(np.append(starts, flop.size))
        return flop & (number > np.repeat(before, lengths))

    def _join(self) -> None:
        """Make one summary of all parts of each."""
        rows = np.concatenate([part for part, _ in self._held])
        bound = np.concatenate([bound for _, bound in self._held])
        order = np.lexsort((bound, rows["key"]))
        rows, bound = rows[order], bound[order]
        key = rows["key"]
        starts = np.flatnonzero(
            np.concatenate([[True], (key[1:] != key[:-1]) | (bound[1:] != bound[:-1])])
        )
        whole = rows[np.append(starts[1:], rows.size) - 1]
        for name in _SUMS:
            whole[name] = np.add.reduceat(rows[name], starts)
        for name in ("begin_ns", "diff_min", "low"):
            whole[name] = np.fmin.reduceat(rows[name], starts)
        for name in ("end_ns", "diff_max", "high"):
            whole[name] = np.fmax.reduceat(rows[name], starts)
        self._held = [(whole, bound[starts])]
        # Those that cannot be joined any more do not count.
        self._held_rows = 0


def condensed(recording: Recording, period_ns: int) -> Recording:
    """What `Condenser` keeps of a recording in memory, with summaries of one length.

    Comparisons of which a node has summaries already stay as they are.

    Args:
        recording: it.
        period_ns: the length of a period.
    """
    events, summaries = recording.events, recording.summaries
    gathering = Gathering()
    gathering.marks += recording.marks
    gathering.keys.all(events.keys)
    gathering.nodes.all(events.nodes)
    extent = Extent(recording.seconds, 1, period_ns)
    hot = np.ones(len(events.keys), np.bool_)
    kept = _has_summaries(events, summaries)
    channel = gathering.channel("", "events")
    left = np.flatnonzero(~kept)
    left = left[order_of(events.node[left])]
    for rows in np.split(left, np.flatnonzero(np.diff(events.node[left])) + 1):
        if rows.size:
            node = int(events.node[rows[0]])
            condenser = Condenser(gathering, channel, node, hot, extent)
            condenser.add(_part(events, rows))
            condenser.finish()
    found = np.concatenate([np.empty(0, EVENT_ROW), *gathering.events.blocks()])
    made = np.concatenate([np.empty(0, SUMMARY_ROW), *gathering.summaries.blocks()])
    own = events.take(kept).columns()
    both = {name: np.concatenate([column, found[name]]) for name, column in own.items()}
    keys = sorted({*events.keys, *summaries.keys})
    nodes = sorted({*events.nodes, *summaries.nodes})
    earlier = summaries.columns()
    for column, before, now, words in (
        ("key", summaries.keys, events.keys, keys),
        ("node", summaries.nodes, events.nodes, nodes),
    ):
        earlier[column] = recode(getattr(summaries, column), before, words)
        made[column] = recode(made[column], now, words)
    joined = {name: np.concatenate([column, made[name]]) for name, column in earlier.items()}
    return replace(
        recording,
        events=Events.of(**both, keys=events.keys, nodes=events.nodes),
        summaries=Summaries.of(**joined, keys=keys, nodes=nodes),
    )


def _has_summaries(events: Events, summaries: Summaries) -> Bools:
    """bool[n]: the events whose comparison has summaries of the same node."""
    key = recode(summaries.key, summaries.keys, events.keys)
    node = recode(summaries.node, summaries.nodes, events.nodes)
    known = (key >= 0) & (node >= 0)
    pairs = np.zeros((len(events.keys), len(events.nodes)), np.bool_)
    pairs[key[known], node[known]] = True
    return np.asarray(pairs[events.key, events.node])


def hot_keys(sample: Int32s, keys: int, times: float) -> Bools:
    """bool[keys]: which keys have too many reports to keep each.

    There are ``times`` as many reports as in ``sample``.
    """
    counts = np.bincount(sample, minlength=keys) * times
    rising = np.argsort(counts, kind="stable")
    hot = np.zeros(keys, np.bool_)
    hot[rising] = np.cumsum(counts[rising]) > WHOLE_ROWS
    return hot


def _window_ends(marks_ns: list[int]) -> Int64s:
    """The first ns of each window, and the first behind it."""
    marks = np.array(marks_ns, np.int64)
    return np.unique(np.concatenate([marks - WINDOW_NS, marks + 1]))


def _summaries(block: ReportColumns, rows: Int64s, starts: Int64s) -> Rows:
    """A summary from each of ``starts`` on, with sums in place of means."""
    cmp, thresh = block.cmp[rows], block.thresh[rows]
    ends = np.append(starts[1:], rows.size)
    found = np.zeros(starts.size, SUMMARY_ROW)
    found["count"] = ends - starts
    found["result"] = block.result[rows[ends - 1]]
    found["res"] = block.res[rows[ends - 1]]
    found["cmp"], found["thresh"] = cmp[ends - 1], thresh[ends - 1]
    with np.errstate(all="ignore"):
        diff = cmp - thresh
        size = np.abs(diff)
        low, high = np.minimum(cmp, thresh), np.maximum(cmp, thresh)
        sums = diff, size
        if not np.isfinite(size.sum()):
            odd = ~(np.isfinite(cmp) & np.isfinite(thresh))
            found["odd"] = np.add.reduceat(odd, starts, dtype=np.int64)
            sums = np.where(odd, 0.0, diff), np.where(odd, 0.0, size)
            diff, size, low, high = (_without(odd, one) for one in (diff, size, low, high))
        found["far"] = np.add.reduceat(size > _FAR, starts, dtype=np.int64)
        found["diff_mean"] = np.add.reduceat(sums[0], starts)
        found["abs_mean"] = np.add.reduceat(sums[1], starts)
        found["diff_min"] = np.fmin.reduceat(diff, starts)
        found["diff_max"] = np.fmax.reduceat(diff, starts)
        found["low"] = np.fmin.reduceat(low, starts)
        found["high"] = np.fmax.reduceat(high, starts)
    return found


def _without(odd: Bools, values: Floats) -> Floats:
    return np.where(odd, np.nan, values)


def _part(block: ReportColumns | Events, kept: Bools | Int64s) -> ReportColumns:
    return ReportColumns(
        block.time_ns[kept],
        block.key[kept],
        block.result[kept],
        block.cmp[kept],
        block.thresh[kept],
        block.res[kept],
    )
