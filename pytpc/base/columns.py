"""The base of the tables of events and summaries: numpy columns, with words as codes.

A word column (keys, nodes) is int32 codes into a tuple of words; in Arrow it is a dictionary.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from pytpc.base.atomic import replacing
from pytpc.base.errors import InputError
from pytpc.base.regular_files import check_file, open_file

if TYPE_CHECKING:
    from typing_extensions import Self

Int64s = npt.NDArray[np.int64]
Int32s = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Scalar = TypeVar("Scalar", bound=np.generic)
Read = TypeVar("Read")
Columns = dict[str, npt.NDArray[np.generic]]

_ANY_ROWS = 1 << 22
_MOST_WORD_BYTES = 1 << 24
_BYTES_OF_ROW = 16
_MOST_WORDS = 1 << 20
WORDS = pa.dictionary(pa.int32(), pa.string())
_KINDS: dict[str, tuple[pa.DataType, type[np.generic]]] = {
    "Int32s": (WORDS, np.int32),
    "Int64s": (pa.int64(), np.int64),
    "Bools": (pa.bool_(), np.bool_),
    "Floats": (pa.float64(), np.float64),
}


def frozen(values: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
    """A view of ``values`` that cannot be written through."""
    view = values.view()
    view.flags.writeable = False
    return view


def sorted_words(codes: Mapping[str, int]) -> tuple[list[str], Int32s]:
    """The words in order, and for each old code its place in that order."""
    words = sorted(codes)
    places = np.empty(max(1, len(words)), dtype=np.int32)
    for place, word in enumerate(words):
        places[codes[word]] = place
    return words, places


def recode(codes: Int32s, words: Sequence[str], among: Sequence[str]) -> Int32s:
    """``codes`` into ``words`` as codes into ``among``; -1 for a word that is not there."""
    places = {word: place for place, word in enumerate(among)}
    table = np.array([places.get(word, -1) for word in words] or [-1], dtype=np.int32)
    return table[codes]


@dataclass(frozen=True)
class KeyIndex:
    """The rows of every key together.

    ``order`` int64[n] lists rows by key, then by place in the table; the rows of key code ``k``
    are ``order[offsets[k]:offsets[k + 1]]``.
    """

    order: Int64s
    offsets: Int64s

    def rows(self, code: int) -> Int64s:
        """The rows of one key, in the order of the table."""
        return self.order[self.offsets[code] : self.offsets[code + 1]]


def order_of(codes: Int32s | Int64s) -> Int64s:
    """int64[n]: the places of ``codes``, which are not negative, in ascending order; stable."""
    # For 16 bits numpy counts instead of comparing (radix sort).
    short = int(codes.max(initial=0)) < 1 << 16
    return np.argsort(codes.astype(np.uint16) if short else codes, kind="stable")


class WordTable:
    """A table whose columns ``key`` and ``node`` are codes into the words ``keys`` and ``nodes``.

    A subclass is a frozen dataclass with a field for each column, an array that cannot be written,
    and for the two tuples of words. ``of`` makes one, sorted by the column ``order``. ``what`` is
    what its file is called in messages. ``kinds`` and ``schema`` are the columns for numpy and for
    Arrow, in the order of the fields; a Parquet file with other columns or types is refused.
    """

    order: ClassVar[str]
    what: ClassVar[str]
    kinds: ClassVar[dict[str, type[np.generic]]]
    schema: ClassVar[pa.Schema]
    keys: tuple[str, ...]
    nodes: tuple[str, ...]

    def __init_subclass__(cls) -> None:
        """Take the columns from the types of the fields."""
        columns = {
            name: _KINDS[kind] for name, kind in cls.__annotations__.items() if kind in _KINDS
        }
        cls.kinds = {name: kind for name, (_, kind) in columns.items()}
        cls.schema = pa.schema(
            [pa.field(name, kind, nullable=False) for name, (kind, _) in columns.items()]
        )

    @classmethod
    def of(cls, *, keys: Iterable[str], nodes: Iterable[str], **columns: npt.ArrayLike) -> Self:
        """Sort the columns (stably) and check that they fit together.

        Raises:
            ValueError: columns of different lengths, a code without a word, or a word twice.
            TypeError: a column is missing or has another name.
        """
        kinds = cls.kinds
        typed = {name: np.asarray(values, kinds.get(name)) for name, values in columns.items()}
        if len(typed) == len(kinds):
            times = typed[cls.order]
            if any(column.shape != times.shape for column in typed.values()):
                raise ValueError("columns of different lengths")
            if bool(np.any(times[1:] < times[:-1])):
                order = np.argsort(times, kind="stable")
                typed = {name: column[order] for name, column in typed.items()}
        words = {"keys": tuple(keys), "nodes": tuple(nodes)}
        table = cls(**{name: frozen(column) for name, column in typed.items()}, **words)
        _check_words(typed["key"], table.keys)
        _check_words(typed["node"], table.nodes)
        return table

    @classmethod
    def of_rows(cls, rows: Iterable[object]) -> Self:
        """A table of objects that have an attribute for each column, key and node as text."""
        columns: dict[str, list[Any]] = {name: [] for name in cls.kinds}
        for row in rows:
            for name, column in columns.items():
                column.append(getattr(row, name))
        keys, nodes = sorted(set(columns["key"])), sorted(set(columns["node"]))
        for name, words in (("key", keys), ("node", nodes)):
            places = {word: place for place, word in enumerate(words)}
            columns[name] = [places[word] for word in columns[name]]
        return cls.of(**columns, keys=keys, nodes=nodes)

    @classmethod
    def empty(cls, keys: Iterable[str] = ()) -> Self:
        """No rows, with the given keys."""
        return cls.of(keys=keys, nodes=(), **{name: [] for name in cls.kinds})

    def __len__(self) -> int:
        return int(getattr(self, self.order).size)

    @cached_property
    def by_key(self) -> KeyIndex:
        """The rows of every key; worked out once."""
        codes: Int32s = getattr(self, "key")  # noqa: B009 - a field of the subclasses
        counts = np.bincount(codes, minlength=len(self.keys))
        offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        return KeyIndex(frozen(order_of(codes)), frozen(offsets))

    @cached_property
    def _codes(self) -> dict[str, int]:
        return {key: code for code, key in enumerate(self.keys)}

    def rows_of(self, key: str) -> Int64s:
        """The rows of a key, in the order of the table; none where the table does not know it."""
        code = self._codes.get(key)
        return np.empty(0, dtype=np.int64) if code is None else self.by_key.rows(code)

    def rows_in(self, key: str, node: str) -> Int64s:
        """Those of ``rows_of`` that are of one node."""
        rows = self.rows_of(key)
        if node not in self.nodes:
            return rows[:0]
        codes: Int32s = getattr(self, "node")  # noqa: B009 - a field of the subclasses
        return np.asarray(rows[codes[rows] == self.nodes.index(node)])

    def columns(self) -> Columns:
        """The columns by name, in the order of ``schema``."""
        return {name: getattr(self, name) for name in self.kinds}

    def take(self, rows: slice | Int64s | Bools) -> Self:
        """The rows at ``rows`` (a slice, row numbers or a mask), with the same words."""
        columns = {name: column[rows] for name, column in self.columns().items()}
        return self.of(**columns, keys=self.keys, nodes=self.nodes)

    def to_arrow(self) -> pa.Table:
        """The table in the schema ``schema``."""
        return to_arrow(self.columns(), {"key": self.keys, "node": self.nodes}, self.schema)

    @classmethod
    def from_arrow(cls, table: pa.Table) -> Self:
        """The reverse of ``to_arrow``; the rows may be in any order and the columns in chunks.

        Raises:
            InputError: a column is missing, is of another type or has missing values.
        """
        check_schema(table.schema, cls.schema)
        columns: dict[str, npt.ArrayLike] = {}
        words: dict[str, list[str]] = {}
        for field in cls.schema:
            column = table.column(field.name)
            if column.null_count:
                raise InputError(f"column {field.name} has {column.null_count} missing values")
            if field.type == WORDS:
                words[field.name], columns[field.name] = words_and_codes(column)
            else:
                columns[field.name] = column.to_numpy()
        return cls.of(**columns, keys=words["key"], nodes=words["node"])

    def write(self, path: Path) -> None:
        """Write Parquet, atomically.

        Raises:
            TpcError: the file cannot be written; what stood there before is untouched.
        """
        write_table(self.to_arrow(), path)

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a file of ``write``.

        Raises:
            InputError: the file cannot be read, is no Parquet, or has other columns.
        """
        return read_table(path, cls.what, cls.from_arrow)


def to_arrow(
    columns: Mapping[str, npt.NDArray[np.generic]],
    words: Mapping[str, Iterable[str]],
    schema: pa.Schema,
) -> pa.Table:
    """The columns as a table of ``schema``; ``words`` has those of each word column."""
    arrays: dict[str, object] = dict(columns)
    for name, own in words.items():
        arrays[name] = pa.DictionaryArray.from_arrays(arrays[name], pa.array(own, pa.string()))
    return pa.Table.from_arrays(
        [pa.array(arrays[field.name], type=field.type) for field in schema], schema=schema
    )


def check_schema(found: pa.Schema, expected: pa.Schema) -> None:
    """Check that ``found`` has all columns of ``expected``; others are ignored.

    Raises:
        InputError: a column is missing or is of another type.
    """
    for field in expected:
        places = found.get_all_field_indices(field.name)
        if len(places) != 1:
            raise InputError(f"column {field.name} occurs {len(places)} times, not once")
        kind = found.field(places[0]).type
        if kind != field.type:
            raise InputError(f"column {field.name} is {kind}, not {field.type}")


def write_table(table: pa.Table, path: Path) -> None:
    """Write Parquet, atomically.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    with table_writer(path, table.schema) as write:
        write(table)


def read_table(path: Path, what: str, of: Callable[[pa.Table], Read]) -> Read:
    """Read a Parquet file of ``what`` ("events") and convert it by ``of``.

    Raises:
        InputError: the file cannot be read, is no Parquet, or ``of`` finds fault with it.
    """
    with _as_input_errors(path, what):
        # This error has the words of the system.
        open_file(path).close()
        # Arrow's threads release their source after the table is complete. If the source is a
        # Python object, a process that ends just then is aborted (apache/arrow#34314, #33975).
        with pa.OSFile(str(path)) as file:
            parquet = pq.ParquetFile(file)
            _check_sizes(parquet.metadata, path.stat().st_size)
            table = parquet.read()
        table.validate(full=True)
        return of(table)


@contextlib.contextmanager
def table_writer(path: Path, schema: pa.Schema) -> Iterator[Callable[[pa.Table], None]]:
    """Write Parquet in parts, atomically: each call of the given function writes one part.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    with replacing(path) as staged, pq.ParquetWriter(staged, schema, compression="zstd") as writer:
        yield writer.write_table


def read_parts(path: Path, what: str, schema: pa.Schema, rows: int) -> Iterator[pa.Table]:
    """Read a Parquet file of ``what`` ("events") in parts of at most ``rows``.

    Raises:
        InputError: the file cannot be read, is no Parquet, or has other columns.
    """
    check_file(path)
    with _as_input_errors(path, what), pq.ParquetFile(path) as file:
        check_schema(file.schema_arrow, schema)
        _check_sizes(file.metadata, path.stat().st_size)
        for batch in file.iter_batches(rows):
            table = pa.Table.from_batches([batch])
            table.validate(full=True)
            yield table


@contextlib.contextmanager
def _as_input_errors(path: Path, what: str) -> Iterator[None]:
    try:
        yield
    except InputError as error:
        raise InputError(error.message, path) from error
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error
    except (pa.ArrowException, ValueError) as error:
        raise InputError(f"not a file of {what}: {error}", path) from error


def _check_sizes(metadata: pq.FileMetaData, size: int) -> None:
    """Check that what a file says of itself fits into memory.

    A robot's times differ from row to row, so that each row needs more than a bit of the file. A
    word is a key or the name of a node.

    Raises:
        ValueError: it does not fit.
    """
    if metadata.num_rows > max(_ANY_ROWS, 8 * size):
        raise ValueError(f"{metadata.num_rows:,} rows in {size:,} bytes: not those of a robot")
    for number in range(metadata.num_row_groups):
        group = metadata.row_group(number)
        for place in range(group.num_columns):
            column = group.column(place)
            most = _MOST_WORD_BYTES + _BYTES_OF_ROW * group.num_rows
            if column.total_uncompressed_size > most:
                name = column.path_in_schema
                raise ValueError(
                    f"column {name} has {column.total_uncompressed_size:,} bytes in"
                    f" {group.num_rows:,} rows; at most {most:,} are read"
                )


def _check_words(codes: npt.NDArray[Any], words: Sequence[str]) -> None:
    """Check that ``words`` are distinct and every code has one.

    Raises:
        ValueError: a word occurs twice, or a code has none.
    """
    if len(set(words)) != len(words):
        raise ValueError("a key or node is named twice")
    if codes.size and (int(codes.min()) < 0 or int(codes.max()) >= len(words)):
        raise ValueError("a code has no key or node")


def words_and_codes(column: pa.ChunkedArray) -> tuple[list[str], Int32s]:
    """Words and codes of a dictionary column, whatever dictionary each of its chunks has."""
    if column.num_chunks == 0:
        return [], np.empty(0, dtype=np.int32)
    whole = column.unify_dictionaries().combine_chunks()
    if isinstance(whole, pa.ChunkedArray):
        whole = pa.concat_arrays(whole.chunks)
    if whole.dictionary.null_count:
        raise InputError("a key or node without a name")
    if len(whole.dictionary) > _MOST_WORDS:
        raise InputError(f"{len(whole.dictionary):,} different words; at most {_MOST_WORDS:,}")
    return whole.dictionary.to_pylist(), whole.indices.to_numpy(zero_copy_only=False)
