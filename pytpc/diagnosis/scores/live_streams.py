"""The part of a log that `live_scores` keeps of each comparison in each node."""

from __future__ import annotations

from array import array
from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from pytpc.diagnosis.scores.scores import NEVER
from pytpc.recording.events import Bools, Floats, Int64s
from pytpc.recording.summaries import Summary

AGAIN = 0.25
"""How much of the kept time passes between two looks for what can be forgotten."""


class Rows(NamedTuple):
    """Evaluations of one stream in the order of time, equal times in the order of arrival."""

    time_ns: Int64s
    number: Int64s
    result: Bools
    cmp: Floats
    thresh: Floats
    res: Bools


@dataclass
class Counted:
    """What is still known about forgotten evaluations."""

    count: int = 0
    first_ns: int = 0
    flops: int = 0
    last_flop_ns: int = NEVER
    finite: int = 0
    highest: float = -np.inf
    lowest: float = np.inf

    def take(self, rows: Rows, before: bool | None) -> None:
        """Count ``rows``; the result before the first of them was ``before``."""
        if not self.count:
            self.first_ns = int(rows.time_ns[0])
        self.count += rows.time_ns.size
        first = rows.result[:1] if before is None else np.array([before])
        flops = np.flatnonzero(np.diff(rows.result, prepend=first))
        if flops.size:
            self.flops += flops.size
            self.last_flop_ns = max(self.last_flop_ns, int(rows.time_ns[flops[-1]]))
        finite = np.isfinite(rows.cmp) & np.isfinite(rows.thresh)
        self.finite += int(np.count_nonzero(finite))
        values = np.concatenate([rows.cmp[finite], rows.thresh[finite]])
        self.highest = max(self.highest, float(values.max(initial=-np.inf)))
        self.lowest = min(self.lowest, float(values.min(initial=np.inf)))


class EventStream:
    """The evaluations of one comparison in one node.

    If some were forgotten, the last of them is still kept as the first row: it is counted already,
    and its result is compared with that of the next one.
    """

    def __init__(self) -> None:
        """Start empty. ``look_ns`` is when to look for what can be forgotten."""
        self.look_ns = 2**63 - 1
        self.times = array("q")
        self.numbers = array("q")
        self.results = array("b")
        self.cmps = array("d")
        self.threshs = array("d")
        self.ress = array("b")
        self._columns: tuple[array[Any], ...] = (
            self.times,
            self.numbers,
            self.results,
            self.cmps,
            self.threshs,
            self.ress,
        )
        self.counted = Counted()

    def insert(self, row: tuple[int, int, bool, float, float, bool]) -> bool:
        """Insert a row that is older than the newest; False if its place is forgotten."""
        place = bisect_right(self.times, row[0])
        if not place and self.counted.count:
            return False
        for column, value in zip(self._columns, row, strict=True):
            column.insert(place, value)
        return True

    def forget(self, horizon_ns: int) -> None:
        """Forget what is before the horizon, except for the last row; count it."""
        known = 1 if self.counted.count else 0
        cut = bisect_left(self.times, horizon_ns)
        if cut <= known:
            return
        before = bool(self.results[0]) if known else None
        self.counted.take(self.rows(known, cut), before)
        for column in self._columns:
            del column[: cut - 1]

    def rows(self, first: int = 0, last: int | None = None) -> Rows:
        """A copy of rows."""
        return Rows(
            np.array(self.times[first:last], np.int64),
            np.array(self.numbers[first:last], np.int64),
            np.array(self.results[first:last], np.bool_),
            np.array(self.cmps[first:last], np.float64),
            np.array(self.threshs[first:last], np.float64),
            np.array(self.ress[first:last], np.bool_),
        )


@dataclass
class SummaryStream:
    """The summaries of one comparison in one node, and the extremes of forgotten ones."""

    kept: list[Summary] = field(default_factory=list)
    looked_at_ns: int = NEVER
    newest_ns: int = NEVER
    first_ns: int = 2**63 - 1
    forgotten_ns: int = NEVER
    highest: float = -np.inf
    lowest: float = np.inf

    def add(self, summary: Summary, keep_ns: int) -> None:
        """Keep a summary, and forget what ended more than ``keep_ns`` before the newest."""
        self.kept.append(summary)
        self.newest_ns = max(self.newest_ns, end_of(summary))
        self.first_ns = min(self.first_ns, summary.begin_ns, summary.end_ns)
        if self.newest_ns - self.looked_at_ns > keep_ns * AGAIN:
            self.looked_at_ns = self.newest_ns
            self._forget(self.newest_ns - keep_ns)

    def _forget(self, horizon_ns: int) -> None:
        """The newest one is always kept."""
        newest = max(self.kept, key=end_of)
        kept = []
        for summary in self.kept:
            if end_of(summary) >= horizon_ns or summary is newest:
                kept.append(summary)
                continue
            self.forgotten_ns = max(self.forgotten_ns, end_of(summary))
            if summary.count > summary.odd:
                self.highest = max(self.highest, summary.high)
                self.lowest = min(self.lowest, summary.low)
        self.kept = kept


def end_of(summary: Summary) -> int:
    """When it ended; if the clock was set back, its begin may be later than its end."""
    return max(summary.begin_ns, summary.end_ns)
