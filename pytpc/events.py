"""Evaluations of threshold predicate comparisons as columns: in numpy, Arrow and Parquet.

``Events`` is one table sorted by time; ``EventBuilder`` makes it from records one at a time,
``read_parquet`` and ``write_parquet`` keep it on disk. The columns are those of docs/formats.md.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from pytpc.atomic import write_atomic
from pytpc.errors import InputError

Int64s = npt.NDArray[np.int64]
Int32s = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Scalar = TypeVar("Scalar", bound=np.generic)

_WORDS = pa.dictionary(pa.int32(), pa.string())
SCHEMA = pa.schema(
    [
        pa.field("time_ns", pa.int64(), nullable=False),
        pa.field("key", _WORDS, nullable=False),
        pa.field("result", pa.bool_(), nullable=False),
        pa.field("cmp", pa.float64(), nullable=False),
        pa.field("thresh", pa.float64(), nullable=False),
        pa.field("res", pa.bool_(), nullable=False),
        pa.field("node", _WORDS, nullable=False),
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
            _frozen(np.asarray(time_ns, dtype=np.int64)),
            _frozen(np.asarray(key, dtype=np.int32)),
            _frozen(np.asarray(result, dtype=np.bool_)),
            _frozen(np.asarray(cmp, dtype=np.float64)),
            _frozen(np.asarray(thresh, dtype=np.float64)),
            _frozen(np.asarray(res, dtype=np.bool_)),
            _frozen(np.asarray(node, dtype=np.int32)),
            tuple(keys),
            tuple(nodes),
        )
        if any(column.shape != (len(table),) for column in table._columns().values()):
            raise ValueError("columns of different lengths")
        for codes, words in ((table.key, table.keys), (table.node, table.nodes)):
            if len(set(words)) != len(words):
                raise ValueError("a key or node is named twice")
            if codes.size and (int(codes.min()) < 0 or int(codes.max()) >= len(words)):
                raise ValueError("a code has no key or node")
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
        return KeyIndex(_frozen(order), _frozen(offsets))

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
        return _frozen(before)

    @cached_property
    def flop(self) -> Bools:
        """bool[n]: evaluations whose ``result`` differs from that of the evaluation before."""
        known = self.previous >= 0
        return _frozen(known & (self.result != self.result[self.previous]))

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
        places = {key: place for place, key in enumerate(keys)}
        recode = np.array([places.get(key, -1) for key in self.keys] or [-1], dtype=np.int32)
        codes = recode[self.key]
        kept = codes >= 0
        columns = {name: column[kept] for name, column in self._columns().items()}
        columns["key"] = codes[kept]
        return Events.of(**columns, keys=keys, nodes=self.nodes)

    def to_arrow(self) -> pa.Table:
        """The table in the schema ``SCHEMA``."""
        columns: dict[str, object] = dict(self._columns())
        for name, words in (("key", self.keys), ("node", self.nodes)):
            columns[name] = pa.DictionaryArray.from_arrays(
                columns[name], pa.array(words, pa.string())
            )
        return pa.Table.from_arrays(
            [pa.array(columns[field.name], type=field.type) for field in SCHEMA], schema=SCHEMA
        )

    @classmethod
    def from_arrow(cls, table: pa.Table) -> Events:
        """The reverse of ``to_arrow``; the rows may be in any order and the columns in chunks.

        Raises:
            InputError: a column is missing, is of another type or has empty places.
        """
        columns: dict[str, npt.ArrayLike] = {}
        words: dict[str, list[str]] = {}
        for field in SCHEMA:
            found = table.schema.get_all_field_indices(field.name)
            if len(found) != 1:
                raise InputError(f"column {field.name} occurs {len(found)} times, not once")
            column = table.column(found[0])
            if column.type != field.type:
                raise InputError(f"column {field.name} is {column.type}, not {field.type}")
            if column.null_count:
                raise InputError(f"column {field.name} has {column.null_count} empty places")
            if field.type == _WORDS:
                columns[field.name], words[field.name] = _codes(column)
            else:
                columns[field.name] = column.to_numpy()
        return cls.of(**columns, keys=words["key"], nodes=words["node"])

    def _columns(self) -> dict[str, npt.NDArray[np.generic]]:
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
        keys, key_places = _sorted_words(self._key_codes)
        nodes, node_places = _sorted_words(self._node_codes)
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


def concat(tables: Sequence[Events]) -> Events:
    """All evaluations of ``tables``; equal times keep the order of the tables.

    The keys and nodes of the result are sorted.
    """
    keys = sorted({key for table in tables for key in table.keys})
    nodes = sorted({node for table in tables for node in table.nodes})
    if not tables:
        return Events.empty()
    node_places = {node: place for place, node in enumerate(nodes)}
    recoded = []
    for table in tables:
        columns = table.with_keys(keys)._columns()
        places = np.array([node_places[node] for node in table.nodes] or [-1], dtype=np.int32)
        columns["node"] = places[table.node]
        recoded.append(columns)
    joined = {name: np.concatenate([part[name] for part in recoded]) for name in recoded[0]}
    return Events.of(**joined, keys=keys, nodes=nodes)


def write_parquet(events: Events, path: Path) -> None:
    """Write the table, atomically.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    sink = pa.BufferOutputStream()
    pq.write_table(events.to_arrow(), sink, compression="zstd")
    write_atomic(path, sink.getvalue().to_pybytes())


def read_parquet(path: Path) -> Events:
    """Read what ``write_parquet`` wrote.

    Raises:
        InputError: the file cannot be read, is no Parquet, or has other columns.
    """
    try:
        table = pq.read_table(pa.BufferReader(path.read_bytes()))
        return Events.from_arrow(table)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error
    except (pa.ArrowException, ValueError) as error:
        raise InputError(f"not a file of events: {error}", path) from error
    except InputError as error:
        raise InputError(error.message, path) from error


def _frozen(values: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
    view = values.view()
    view.flags.writeable = False
    return view


def _sorted_words(codes: dict[str, int]) -> tuple[list[str], Int32s]:
    """The words in order, and for each old code its place in that order."""
    words = sorted(codes)
    places = np.empty(max(1, len(words)), dtype=np.int32)
    for place, word in enumerate(words):
        places[codes[word]] = place
    return words, places


def _codes(column: pa.ChunkedArray) -> tuple[Int32s, list[str]]:
    """Codes and words of a dictionary column, whatever dictionary each of its chunks has."""
    if column.num_chunks == 0:
        return np.empty(0, dtype=np.int32), []
    whole = column.unify_dictionaries().combine_chunks()
    if isinstance(whole, pa.ChunkedArray):
        whole = pa.concat_arrays(whole.chunks)
    words = whole.dictionary.to_pylist()
    return whole.indices.to_numpy(zero_copy_only=False), words
