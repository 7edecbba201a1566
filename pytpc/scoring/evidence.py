"""What a log has of each comparison up to a time, beside the scores."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from pytpc.events import Events, Int64s
from pytpc.summaries import Summaries


class Evaluation(NamedTuple):
    """One evaluation, as it was reported, or the last of a summary."""

    time_ns: int
    result: bool
    cmp: float
    thresh: float
    res: bool
    node: str


class Evidence(Protocol):
    """What a ranking is made of beside the scores: of a whole log, or of what came so far."""

    @property
    def first_ns(self) -> Mapping[str, int]:
        """When each comparison was evaluated first; those that never were are not in it."""
        ...

    @property
    def last_ns(self) -> int:
        """When anything was evaluated last; only where ``first_ns`` is not empty."""
        ...

    def last(self, key: str, mark_ns: int) -> Evaluation:
        """The last evaluation up to the mark that is known; only of keys in ``first_ns``."""
        ...


class Log:
    """The evidence of a recording."""

    def __init__(self, events: Events, summaries: Summaries) -> None:
        """``events`` has the keys of the TPCs; other keys of ``summaries`` are left out."""
        self.events = events
        self.summaries = summaries
        self._codes = {key: code for code, key in enumerate(events.keys)}
        self._summary_codes = {key: code for code, key in enumerate(summaries.keys)}

    @cached_property
    def first_ns(self) -> dict[str, int]:
        """When each comparison was evaluated first."""
        first = {}
        for key, code in self._codes.items():
            rows, own = self.events.by_key.rows(code), self._rows_of(key)
            times = [int(self.events.time_ns[rows[0]])] if rows.size else []
            times += [int(self.summaries.begin_ns[own].min())] if own.size else []
            if times:
                first[key] = min(times)
        return first

    @cached_property
    def last_ns(self) -> int:
        """When anything was evaluated last."""
        times = [int(self.events.time_ns[-1])] if len(self.events) else []
        ends = [self.summaries.end_ns[self._rows_of(key)] for key in self._codes]
        times += [int(end.max()) for end in ends if end.size]
        return max(times)

    def last(self, key: str, mark_ns: int) -> Evaluation:
        """The last evaluation up to the mark that is known: a report, or the last of a summary.

        Where the mark is within the first period, it is the first of these.
        """
        rows = self.events.by_key.rows(self._codes[key])
        found = [_at(self.events, self.events.time_ns, rows, mark_ns)] if rows.size else []
        own = self._rows_of(key)
        if own.size:
            own = own[np.argsort(self.summaries.end_ns[own], kind="stable")]
            found.append(_at(self.summaries, self.summaries.end_ns, own, mark_ns))
        before = [evaluation for evaluation in found if evaluation.time_ns <= mark_ns]
        return max(before) if before else min(found)

    def _rows_of(self, key: str) -> Int64s:
        """The summaries of a key; a table may know a key and have none."""
        return np.flatnonzero(self.summaries.key == self._summary_codes.get(key, -1))


def _at(table: Events | Summaries, times: Int64s, rows: Int64s, mark_ns: int) -> Evaluation:
    """The last of ``rows`` up to the mark, else the first; they are in the order of ``times``."""
    place = int(np.searchsorted(times[rows], mark_ns, side="right")) - 1
    row = int(rows[max(0, place)])
    return Evaluation(
        int(times[row]),
        bool(table.result[row]),
        float(table.cmp[row]),
        float(table.thresh[row]),
        bool(table.res[row]),
        table.nodes[table.node[row]],
    )
