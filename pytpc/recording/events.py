"""Evaluations of threshold predicate comparisons as columns (docs/reference/formats.md#events)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from pytpc.base import columns as tables
from pytpc.base.columns import Bools, Floats, Int32s, Int64s, KeyIndex, frozen, order_of

__all__ = ["Bools", "Events", "Floats", "Int32s", "Int64s", "KeyIndex", "Report"]


class Report(NamedTuple):
    """What one evaluation reports: docs/reference/runtime.md#log_one."""

    key: str
    result: bool
    cmp: float
    thresh: float
    res: bool


@dataclass(frozen=True, eq=False)
class Events(tables.WordTable):
    """n evaluations, sorted by time; what happened at the same time keeps its recorded order.

    ``time_ns`` int64[n]; ``key`` int32[n], codes into ``keys``; ``result`` bool[n] (the predicate);
    ``cmp`` and ``thresh`` float64[n]; ``res`` bool[n] (this comparison); ``node`` int32[n], codes
    into ``nodes``. The arrays are read-only. Make one with ``of``, which sorts and checks.
    """

    time_ns: Int64s
    key: Int32s
    result: Bools
    cmp: Floats
    thresh: Floats
    res: Bools
    node: Int32s
    keys: tuple[str, ...]
    nodes: tuple[str, ...]

    order = "time_ns"
    what = "events"

    @cached_property
    def previous(self) -> Int64s:
        """int64[n]: for each row the row of the same key's evaluation before it, -1 where none.

        Before means in the same node: where two processes run the same code, an evaluation in one
        says nothing about the other.
        """
        order = order_of(self.key.astype(np.int64) * max(1, len(self.nodes)) + self.node)
        before = np.full(len(self), -1, dtype=np.int64)
        same = (self.key[order[1:]] == self.key[order[:-1]]) & (
            self.node[order[1:]] == self.node[order[:-1]]
        )
        before[order[1:][same]] = order[:-1][same]
        return frozen(before)

    @cached_property
    def flop(self) -> Bools:
        """bool[n]: evaluations whose ``result`` differs from that of the evaluation before."""
        known = self.previous >= 0
        return frozen(known & (self.result != self.result[self.previous]))

    def between(self, start_ns: int, end_ns: int) -> Events:
        """The evaluations of the closed span ``[start_ns, end_ns]``."""
        first = int(np.searchsorted(self.time_ns, start_ns, side="left"))
        last = int(np.searchsorted(self.time_ns, end_ns, side="right"))
        return self.take(slice(first, max(first, last)))

    def with_keys(self, keys: Sequence[str]) -> Events:
        """The same table with ``keys`` as its keys; evaluations of other keys are left out."""
        known = self.__dict__.get("_with_keys")
        if known is not None and known[0] == tuple(keys):
            found: Events = known[1]
            return found
        found = self._with_keys_of(keys)
        # Every question to a recording asks for the keys of the same static information.
        self.__dict__["_with_keys"] = tuple(keys), found
        return found

    def _with_keys_of(self, keys: Sequence[str]) -> Events:
        codes = tables.recode(self.key, self.keys, keys)
        kept = codes >= 0
        columns = {name: column[kept] for name, column in self.columns().items()}
        columns["key"] = codes[kept]
        return Events.of(**columns, keys=keys, nodes=self.nodes)
