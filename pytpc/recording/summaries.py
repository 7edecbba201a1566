"""Summaries of evaluations as columns: what the policy ``edges`` keeps of a site in a period.

Under ``edges`` the events hold the first evaluation of each comparison and its flops; all
evaluations, those too, are in the summaries. The columns are those of docs/reference/formats.md.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from pytpc.base import columns as tables
from pytpc.base.columns import Bools, Columns, Floats, Int32s, Int64s, frozen, sorted_words

_INTEGERS = ("begin_ns", "end_ns", "count", "flops", "far", "odd")
_BOOLS = ("result", "res")
_FLOATS = ("cmp", "thresh", "diff_min", "diff_max", "diff_mean", "abs_mean", "low", "high")

SCHEMA = pa.schema(
    [
        pa.field("key", tables.WORDS, nullable=False),
        pa.field("node", tables.WORDS, nullable=False),
        *(pa.field(name, pa.int64(), nullable=False) for name in _INTEGERS),
        *(pa.field(name, pa.bool_(), nullable=False) for name in _BOOLS),
        *(pa.field(name, pa.float64(), nullable=False) for name in _FLOATS),
    ]
)


@dataclass(frozen=True, slots=True)
class Summary:
    """All evaluations of one comparison in one thread and period, in the order of the columns.

    ``begin_ns`` and ``end_ns`` enclose them; ``result``, ``res``, ``cmp`` and ``thresh`` are those
    of the last. ``count``, ``flops`` and ``odd`` count all of them, the flops, and those whose cmp
    or thresh is not finite. The rest is about the others alone, NaN where there are none: diff is
    cmp - thresh, ``abs_mean`` the mean of its absolute value, ``far`` counts those where that is
    above 1e-4, ``low`` and ``high`` are the extremes of all cmp and thresh.
    """

    key: str
    node: str
    begin_ns: int
    end_ns: int
    count: int
    flops: int
    far: int
    odd: int
    result: bool
    res: bool
    cmp: float
    thresh: float
    diff_min: float
    diff_max: float
    diff_mean: float
    abs_mean: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Summaries:
    """n summaries, sorted by ``begin_ns``; equal ones keep their recorded order.

    ``key`` and ``node`` are int32[n], codes into ``keys`` and ``nodes``; the other columns are
    int64, bool or float64[n] as ``SCHEMA`` has them, and mean what ``Summary`` says. The arrays
    are read-only. Make one with ``of``, which sorts and checks.
    """

    key: Int32s
    node: Int32s
    begin_ns: Int64s
    end_ns: Int64s
    count: Int64s
    flops: Int64s
    far: Int64s
    odd: Int64s
    result: Bools
    res: Bools
    cmp: Floats
    thresh: Floats
    diff_min: Floats
    diff_max: Floats
    diff_mean: Floats
    abs_mean: Floats
    low: Floats
    high: Floats
    keys: tuple[str, ...]
    nodes: tuple[str, ...]

    @classmethod
    def of(
        cls, *, keys: Iterable[str], nodes: Iterable[str], **columns: npt.ArrayLike
    ) -> Summaries:
        """Sort the columns by ``begin_ns`` (stably) and check that they fit together.

        Raises:
            ValueError: columns of different lengths, a code without a word, or a word twice.
            TypeError: a column is missing or has another name.
        """
        typed: dict[str, npt.NDArray[np.generic]] = {}
        for name, values in columns.items():
            kind = np.int32 if name in {"key", "node"} else np.int64
            if name in _BOOLS or name in _FLOATS:
                typed[name] = np.asarray(values, np.bool_ if name in _BOOLS else np.float64)
            else:
                typed[name] = np.asarray(values, kind)
        begins = typed["begin_ns"]
        tables.check_columns(typed, begins.size)
        if bool(np.any(begins[1:] < begins[:-1])):  # type: ignore[operator]
            order = np.argsort(begins, kind="stable")
            typed = {name: column[order] for name, column in typed.items()}
        columns_of: dict[str, npt.NDArray[np.generic]] = {
            name: frozen(column) for name, column in typed.items()
        }
        table = cls(**columns_of, keys=tuple(keys), nodes=tuple(nodes))  # type: ignore[arg-type]
        tables.check_words(table.key, table.keys)
        tables.check_words(table.node, table.nodes)
        return table

    @classmethod
    def empty(cls) -> Summaries:
        """No summaries."""
        return cls.of(keys=(), nodes=(), **{name: [] for name in SCHEMA.names})

    def __len__(self) -> int:
        """The number of summaries."""
        return int(self.begin_ns.size)

    def equals(self, other: Summaries) -> bool:
        """Whether both hold the same summaries (NaN equals NaN) under the same words."""
        theirs = other.columns()
        return (self.keys, self.nodes) == (other.keys, other.nodes) and all(
            np.array_equal(mine, theirs[name], equal_nan=mine.dtype == np.float64)
            for name, mine in self.columns().items()
        )

    def take(self, rows: slice | Int64s | Bools) -> Summaries:
        """The summaries at ``rows`` (a slice, row numbers or a mask), with the same words."""
        columns = {name: column[rows] for name, column in self.columns().items()}
        return Summaries.of(**columns, keys=self.keys, nodes=self.nodes)

    def columns(self) -> Columns:
        """The columns by name, in the order of ``SCHEMA``."""
        return {name: getattr(self, name) for name in SCHEMA.names}

    def to_arrow(self) -> pa.Table:
        """The table in the schema ``SCHEMA``."""
        return tables.to_arrow(self.columns(), {"key": self.keys, "node": self.nodes}, SCHEMA)

    @classmethod
    def from_arrow(cls, table: pa.Table) -> Summaries:
        """The reverse of ``to_arrow``; the rows may be in any order and the columns in chunks.

        Raises:
            InputError: a column is missing, is of another type or has empty places.
        """
        columns, words = tables.from_arrow(table, SCHEMA)
        return cls.of(**columns, keys=words["key"], nodes=words["node"])


class SummaryBuilder:
    """Collects summaries one at a time."""

    def __init__(self) -> None:
        """Start with none."""
        self._columns: dict[str, array[Any]] = {
            name: array("d" if name in _FLOATS else "b" if name in _BOOLS else "q")
            for name in SCHEMA.names
        }
        self._keys: dict[str, int] = {}
        self._nodes: dict[str, int] = {}

    def __len__(self) -> int:
        """How many were added."""
        return len(self._columns["begin_ns"])

    def add(self, summary: Summary) -> None:
        """Add one; those that begin at the same time keep the order of the calls."""
        key = self._keys.setdefault(summary.key, len(self._keys))
        node = self._nodes.setdefault(summary.node, len(self._nodes))
        for name, column in self._columns.items():
            column.append(
                key if name == "key" else node if name == "node" else getattr(summary, name)
            )

    def build(self) -> Summaries:
        """The table; its keys and nodes are sorted, so that they depend on nothing else."""
        keys, key_places = sorted_words(self._keys)
        nodes, node_places = sorted_words(self._nodes)
        columns = {name: np.array(column) for name, column in self._columns.items()}
        columns["key"] = key_places[columns["key"].astype(np.int64)]
        columns["node"] = node_places[columns["node"].astype(np.int64)]
        return Summaries.of(**columns, keys=keys, nodes=nodes)


def concat_summaries(parts: Sequence[Summaries]) -> Summaries:
    """All summaries of ``parts``; those that begin at the same time keep the order of the parts.

    The keys and nodes of the result are sorted.
    """
    if not parts:
        return Summaries.empty()
    joined, keys, nodes = tables.join([(part.columns(), part.keys, part.nodes) for part in parts])
    return Summaries.of(**joined, keys=keys, nodes=nodes)


def write_summaries(summaries: Summaries, path: Path) -> None:
    """Write Parquet, atomically.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    tables.write_table(summaries.to_arrow(), path)


def read_summaries(path: Path) -> Summaries:
    """Read what ``write_summaries`` wrote.

    Raises:
        InputError: the file cannot be read, is no Parquet, or has other columns.
    """
    return tables.read_table(path, "summaries", Summaries.from_arrow)
