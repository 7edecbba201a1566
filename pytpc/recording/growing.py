"""A recording that grows while its mission runs."""

from __future__ import annotations

import threading
from array import array
from collections.abc import Callable, Iterable
from typing import Generic, TypeVar

import numpy as np

from pytpc.base.columns import WordTable
from pytpc.recording.events import Events
from pytpc.recording.marks import Mark
from pytpc.recording.mission import ReadName, Recording
from pytpc.recording.summaries import Summaries, Summary

MOST_ROWS = 2_000_000
"""So many reports are kept of a mission: 100 MB at most."""

Table = TypeVar("Table", bound=WordTable)


class GrowingTable(Generic[Table]):
    """The rows of a table of events or summaries, as they come."""

    def __init__(self, kind: type[Table]) -> None:
        """Start without a row; ``kind`` is what ``rows`` makes."""
        self._kind = kind
        self._columns = {name: array(np.dtype(of).char) for name, of in _numbers(kind).items()}
        self._words: dict[str, dict[str, int]] = {"key": {}, "node": {}}

    def __len__(self) -> int:
        return len(self._columns["key"])

    def add(self, row: object) -> None:
        """Add an object that has an attribute for each column, key and node as text."""
        for name, column in self._columns.items():
            value = getattr(row, name)
            words = self._words.get(name)
            column.append(value if words is None else words.setdefault(value, len(words)))

    def rows(self) -> Callable[[], Table]:
        """A copy of the rows so far; the function sorts it by time, which takes longer."""
        columns = {name: np.array(self._columns[name], of) for name, of in self._kind.kinds.items()}
        keys, nodes = tuple(self._words["key"]), tuple(self._words["node"])
        return lambda: self._kind.of(keys=keys, nodes=nodes, **columns)


def _numbers(kind: type[WordTable]) -> dict[str, type[np.generic]]:
    """The columns; an array has no bool."""
    return {name: np.int8 if of is np.bool_ else of for name, of in kind.kinds.items()}


class GrowingRecording:
    """What is known of a running mission; one thread may add while another one reads."""

    def __init__(self, most: int = MOST_ROWS) -> None:
        """Start without a report; of more than ``most`` reports the later ones are left out."""
        self._most = most
        self._lock = threading.Lock()
        self.clear()

    def clear(self) -> None:
        """Forget all: the clock was set back."""
        with self._lock:
            self._events, self._summaries = GrowingTable(Events), GrowingTable(Summaries)
            self._names: set[ReadName] = set()
            self.is_full = False

    def add(self, item: object) -> None:
        """Take in an evaluation, a summary or the name of a parameter."""
        with self._lock:
            if isinstance(item, ReadName):
                self._names.add(item)
            elif len(self._events) + len(self._summaries) >= self._most:
                self.is_full = True
            elif isinstance(item, Summary):
                self._summaries.add(item)
            else:
                self._events.add(item)

    def recording(self, marks: Iterable[Mark]) -> Recording:
        """The mission so far, with these marks."""
        with self._lock:
            event_rows, summary_rows = self._events.rows(), self._summaries.rows()
            names = tuple(sorted(self._names))
        events, summaries = event_rows(), summary_rows()
        times = [events.time_ns, summaries.begin_ns, summaries.end_ns]
        every = np.concatenate(times) if len(events) + len(summaries) else np.zeros(1, np.int64)
        return Recording(
            "the running robot",
            events,
            tuple(sorted(marks, key=Mark.order)),
            int(every.min()),
            int(every.max()),
            summaries=summaries,
            names=names,
        )
