"""Evaluations of threshold predicate comparisons as columns: in numpy, Arrow and Parquet.

``Events`` is one table sorted by time; ``EventBuilder`` makes it from records one at a time,
``read_parquet`` and ``write_parquet`` keep it on disk. The columns are those of
docs/reference/formats.md.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from pytpc.base import columns as tables
from pytpc.base.columns import Bools, Columns, Floats, Int32s, Int64s, frozen, sorted_words

__all__ = ["SCHEMA", "Bools", "EventBuilder", "Events", "Floats", "Int32s", "Int64s", "KeyIndex"]
__all__ += ["Report", "concat", "read_parquet", "write_parquet"]

SCHEMA = pa.schema(
    [
        pa.field("time_ns", pa.int64(), nullable=False),
        pa.field("key", tables.WORDS, nullable=False),
        pa.field("result", pa.bool_(), nullable=False),
        pa.field("cmp", pa.float64(), nullable=False),
        pa.field("thresh", pa.float64(), nullable=False),
        pa.field("res", pa.bool_(), nullable=False),
        pa.field("node", tables.WORDS, nullable=False),
    ]
)
"""SPEC 6. Parquet keeps it; a file with other columns or types is refused."""


class Report(NamedTuple):
    """What one evaluation reports: SPEC 5's ``log_one``."""

    key: str
    result: bool
    cmp: float
    thresh: float
    res: bool


@dataclass(frozen=True)
class KeyIndex:
    """The rows of every key together.

    ``order`` int64[n] lists rows by key, then by place in the table; the rows of key code ``k``
    are ``order[offsets[k]:offsets[k + 1]]``.
    """

    order: Int64s
    offsets: Int64s

    def rows(self, code: int) -> Int64s:
        """The rows of one key, in the order of time."""
        return self.order[self.offsets[code] : self.offsets[code + 1]]


@dataclass(frozen=True, eq=False)
class Events:
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

    @classmethod
    def of(
        cls,
        *,
        time_ns: npt.ArrayLike,
        key: npt.ArrayLike,
        result: npt.ArrayLike,
        cmp: npt.ArrayLike,
        thresh: npt.ArrayLike,
        res: npt.ArrayLike,
        node: npt.ArrayLike,
        keys: Iterable[str],
        nodes: Iterable[str],
    ) -> Events:
        """Sort the columns by time (stably) and check that they fit together.

        Raises:
            ValueError: columns of different lengths, a code without a word, or a word twice.
        """
        table = cls(
            frozen(np.asarray(time_ns, dtype=np.int64)),
            frozen(np.asarray(key, dtype=np.int32)),
            frozen(np.asarray(result, dtype=np.bool_)),
            frozen(np.asarray(cmp, dtype=np.float64)),
            frozen(np.asarray(thresh, dtype=np.float64)),
            frozen(np.asarray(res, dtype=np.bool_)),
            frozen(np.asarray(node, dtype=np.int32)),
            tuple(keys),
            tuple(nodes),
        )
        tables.check_columns(table._columns(), len(table))
        tables.check_words(table.key, table.keys)
        tables.check_words(table.node, table.nodes)
        if bool(np.any(table.time_ns[1:] < table.time_ns[:-1])):
            return table.take(np.argsort(table.time_ns, kind="stable"))
        return table

    @classmethod
    def empty(cls, keys: Iterable[str] = ()) -> Events:
        """No evaluations, of the given keys."""
        return cls.of(
            time_ns=[], key=[], result=[], cmp=[], thresh=[], res=[], node=[], keys=keys, nodes=()
        )

    def __len__(self) -> int:
        """The number of evaluations."""
        return int(self.time_ns.size)

    def equals(self, other: Events) -> bool:
        """Whether both hold the same evaluations (NaN equals NaN) under the same words."""
        theirs = other._columns()
        return (self.keys, self.nodes) == (other.keys, other.nodes) and all(
            np.array_equal(mine, theirs[name], equal_nan=mine.dtype == np.float64)
            for name, mine in self._columns().items()
        )

    @cached_property
    def by_key(self) -> KeyIndex:
        """Where the rows of every key are; worked out once."""
        order = np.argsort(self.key, kind="stable").astype(np.int64)
        counts = np.bincount(self.key, minlength=len(self.keys))
        offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        return KeyIndex(frozen(order), frozen(offsets))

    @cached_property
    def previous(self) -> Int64s:
        """int64[n]: for each row the row of the same key's evaluation before it, -1 where none.

        Before means in the same node: where two processes run the same code, an evaluation in one
        says nothing about the other.
        """
        order = np.lexsort((self.node, self.key))
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

    def take(self, rows: slice | Int64s | Bools) -> Events:
        """The evaluations at ``rows`` (a slice, row numbers or a mask), with the same words."""
        columns = {name: column[rows] for name, column in self._columns().items()}
        return Events.of(**columns, keys=self.keys, nodes=self.nodes)

    def with_keys(self, keys: Sequence[str]) -> Events:
        """The same table with ``keys`` as its keys; evaluations of other keys are left out."""
        codes = tables.recode(self.key, self.keys, keys)
        kept = codes >= 0
        columns = {name: column[kept] for name, column in self._columns().items()}
        columns["key"] = codes[kept]
        return Events.of(**columns, keys=keys, nodes=self.nodes)

    def to_arrow(self) -> pa.Table:
        """The table in the schema ``SCHEMA``."""
        return tables.to_arrow(self._columns(), {"key": self.keys, "node": self.nodes}, SCHEMA)

    @classmethod
    def from_arrow(cls, table: pa.Table) -> Events:
        """The reverse of ``to_arrow``; the rows may be in any order and the columns in chunks.

        Raises:
            InputError: a column is missing, is of another type or has empty places.
        """
        columns, words = tables.from_arrow(table, SCHEMA)
        return cls.of(**columns, keys=words["key"], nodes=words["node"])

    def _columns(self) -> Columns:
        return {
            "time_ns": self.time_ns,
            "key": self.key,
            "result": self.result,
            "cmp": self.cmp,
            "thresh": self.thresh,
            "res": self.res,
            "node": self.node,
        }


class EventBuilder:
    """Collects evaluations one at a time; 38 bytes each until ``build``."""

    def __init__(self) -> None:
        """Start with none."""
        self._times = array("q")
        self._keys = array("i")
        self._results = array("b")
        self._cmps = array("d")
        self._threshs = array("d")
        self._ress = array("b")
        self._nodes = array("i")
        self._key_codes: dict[str, int] = {}
        self._node_codes: dict[str, int] = {}

    def add(self, time_ns: int, node: str, report: Report) -> None:
        """Add one evaluation; the order of equal times is the order of the calls."""
        key, result, cmp, thresh, res = report
        self._times.append(time_ns)
        self._keys.append(self._key_codes.setdefault(key, len(self._key_codes)))
        self._results.append(result)
        self._cmps.append(cmp)
        self._threshs.append(thresh)
        self._ress.append(res)
        self._nodes.append(self._node_codes.setdefault(node, len(self._node_codes)))

    def build(self) -> Events:
        """The table; its keys and nodes are sorted, so that they depend on nothing else."""
        keys, key_places = sorted_words(self._key_codes)
        nodes, node_places = sorted_words(self._node_codes)
        return Events.of(
            time_ns=np.array(self._times, dtype=np.int64),
            key=key_places[np.array(self._keys, dtype=np.int32)],
            result=np.array(self._results, dtype=np.bool_),
            cmp=np.array(self._cmps, dtype=np.float64),
            thresh=np.array(self._threshs, dtype=np.float64),
            res=np.array(self._ress, dtype=np.bool_),
            node=node_places[np.array(self._nodes, dtype=np.int32)],
            keys=keys,
            nodes=nodes,
        )


def concat(parts: Sequence[Events]) -> Events:
    """All evaluations of ``parts``; equal times keep the order of the parts.

    The keys and nodes of the result are sorted.
    """
    if not parts:
        return Events.empty()
    joined, keys, nodes = tables.join([(part._columns(), part.keys, part.nodes) for part in parts])
    return Events.of(**joined, keys=keys, nodes=nodes)


def write_parquet(events: Events, path: Path) -> None:
    """Write the table, atomically.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    tables.write_table(events.to_arrow(), path)


def read_parquet(path: Path) -> Events:
    """Read what ``write_parquet`` wrote.

    Raises:
        InputError: the file cannot be read, is no Parquet, or has other columns.
    """
    return tables.read_table(path, "events", Events.from_arrow)
