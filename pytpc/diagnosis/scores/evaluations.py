"""The first and last evaluation of each comparison up to a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from pytpc.diagnosis.results.suspects import Evaluation
from pytpc.recording.events import Bools, Events, Int64s
from pytpc.recording.summaries import Summaries


class Evaluations(Protocol):
    """What a ranking needs besides the scores: from a whole log, or from the reports so far."""

    @property
    def first_ns(self) -> Mapping[str, int]:
        """When each comparison was first evaluated; without those that never were."""
        ...

    def reported_ns(self, mark_ns: int) -> int | None:
        """When the last evaluation up to the mark was; None if there is none."""
        ...

    def last(self, key: str, mark_ns: int) -> Evaluation:
        """The last known evaluation up to the mark; only for keys in ``first_ns``."""
        ...


class LoggedEvaluations:
    """The evaluations of a recording."""

    def __init__(self, events: Events, summaries: Summaries) -> None:
        """``events`` has the keys of the TPCs; other keys of ``summaries`` are left out."""
        self.events = events
        self.summaries = summaries
        self._codes = {key: code for code, key in enumerate(events.keys)}
        self._of: dict[str, list[KeyRows]] = {}

    @cached_property
    def first_ns(self) -> dict[str, int]:
        """When each comparison was first evaluated."""
        first = {}
        for key, code in self._codes.items():
            rows, own = self.events.by_key.rows(code), self._rows_of(key)
            times = [int(self.events.time_ns[rows[0]])] if rows.size else []
            times += [int(self.summaries.begin_ns[own].min())] if own.size else []
            if times:
                first[key] = min(times)
        return first

    def reported_ns(self, mark_ns: int) -> int | None:
        """When the last evaluation up to the mark was; a summary lasts to its end."""
        place = int(np.searchsorted(self.events.time_ns, mark_ns, side="right"))
        times = [int(self.events.time_ns[place - 1])] if place else []
        begun = self._ours & (self.summaries.begin_ns <= mark_ns)
        times += [min(mark_ns, int(self.summaries.end_ns[begun].max()))] if begun.any() else []
        return max(times, default=None)

    @cached_property
    def _ours(self) -> Bools:
        """Which summaries are of the TPCs."""
        ours = np.array([key in self._codes for key in self.summaries.keys] or [False])
        return np.asarray(ours[self.summaries.key])

    def last(self, key: str, mark_ns: int) -> Evaluation:
        """The last known evaluation up to the mark: a report, or the last of a summary.

        If the mark is within the first period, it is the first one after it.
        """
        if key not in self._of:
            self._of[key] = list(self._tables(key))
        found = [rows.at(mark_ns) for rows in self._of[key]]
        before = [evaluation for evaluation in found if evaluation.time_ns <= mark_ns]
        return max(before) if before else min(found)

    def _tables(self, key: str) -> Iterator[KeyRows]:
        rows = self.events.by_key.rows(self._codes[key])
        if rows.size:
            yield KeyRows(self.events, rows, self.events.time_ns[rows])
        own = self._rows_of(key)
        if own.size:
            own = own[np.argsort(self.summaries.end_ns[own], kind="stable")]
            yield KeyRows(self.summaries, own, self.summaries.end_ns[own])

    def _rows_of(self, key: str) -> Int64s:
        """The summaries of a key; a table may know a key and have none."""
        return self.summaries.rows_of(key)


class KeyRows(NamedTuple):
    """The rows of one key, in the order of ``times_ns``; there is at least one."""

    table: Events | Summaries
    rows: Int64s
    times_ns: Int64s

    def at(self, mark_ns: int) -> Evaluation:
        """The last up to the mark, else the first."""
        place = max(0, int(np.searchsorted(self.times_ns, mark_ns, side="right")) - 1)
        row, table = int(self.rows[place]), self.table
        return Evaluation(
            int(self.times_ns[place]),
            bool(table.result[row]),
            float(table.cmp[row]),
            float(table.thresh[row]),
            bool(table.res[row]),
            table.nodes[table.node[row]],
        )
