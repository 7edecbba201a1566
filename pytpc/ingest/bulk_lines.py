"""Parses thousands of lines of text into columns at once, without a loop in Python.

It reads lines exactly as ``rosout_line`` does. A block with an unexpected line is halved until the
unexpected lines are alone; ``rosout_line`` reads those.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pacsv

from pytpc.base.columns import WORDS, Bools, Floats, Int32s, Int64s, words_and_codes
from pytpc.ingest.rosout_line import BOOLS, DOUBLE, KEY, TIME

LINES = 1 << 15
_ALONE = 16
_REPORT_TYPES = {
    "key": WORDS,
    "result": WORDS,
    "cmp": pa.string(),
    "thresh": pa.string(),
    "res": WORDS,
}


class _Odd(Exception):
    """The block has an unexpected line."""


@dataclass(frozen=True, slots=True)
class Columns:
    """Reports of the given lines ``begin`` to ``end``.

    ``key`` is codes into ``keys``; ``time_ns`` is None where the lines have no time.
    """

    begin: int
    end: int
    time_ns: Int64s | None
    key: Int32s
    keys: list[str]
    result: Bools
    cmp: Floats
    thresh: Floats
    res: Bools


def read_lines(lines: Sequence[bytes], *, stamped: bool) -> Iterator[Columns | int]:
    """Read ``[TIME,]KEY,RESULT,cmp:C,thresh:T,res:R`` in each of ``lines``.

    Yields:
        Columns of consecutive lines, and the number of each unexpected line, in order. Such a line
        may still be a report, for example one with white space at its end.
    """
    yield from _halved(lines, 0, len(lines), stamped)


def _halved(lines: Sequence[bytes], begin: int, end: int, stamped: bool) -> Iterator[Columns | int]:
    if begin == end:
        return
    try:
        yield _block(lines, begin, end, stamped)
    except _Odd:
        if end - begin <= _ALONE:
            yield from range(begin, end)
            return
        middle = (begin + end) // 2
        yield from _halved(lines, begin, middle, stamped)
        yield from _halved(lines, middle, end, stamped)


def _block(lines: Sequence[bytes], begin: int, end: int, stamped: bool) -> Columns:
    table = _table(lines, begin, end, stamped)
    keys, key = _key_codes(table.column("key"))
    return Columns(
        begin=begin,
        end=end,
        time_ns=_times(table.column("time")) if stamped else None,
        key=key,
        keys=keys,
        result=_bools(table.column("result")),
        cmp=_doubles(table.column("cmp"), "cmp:"),
        thresh=_doubles(table.column("thresh"), "thresh:"),
        res=_bools(table.column("res"), "res:"),
    )


def _table(lines: Sequence[bytes], begin: int, end: int, stamped: bool) -> pa.Table:
    block = b"\n".join(lines[begin:end])
    if block.count(b"\n") != end - begin - 1 or b"\r" in block or b"\0" in block:
        raise _Odd
    types = {"time": pa.string(), **_REPORT_TYPES} if stamped else _REPORT_TYPES
    try:
        table = pacsv.read_csv(
            io.BytesIO(block),
            pacsv.ReadOptions(
                use_threads=False, column_names=list(types), block_size=max(1 << 10, len(block) + 1)
            ),
            pacsv.ParseOptions(quote_char=False, ignore_empty_lines=False),
            pacsv.ConvertOptions(column_types=types, strings_can_be_null=False),
        )
    except pa.ArrowException as error:
        raise _Odd from error
    if table.num_rows != end - begin:
        raise _Odd
    return table


def _key_codes(column: pa.ChunkedArray) -> tuple[list[str], Int32s]:
    words, codes = words_and_codes(column)
    if not pc.all(pc.match_substring_regex(pa.array(words, pa.string()), f"^{KEY}$")).as_py():
        raise _Odd
    # The same key in small and capital letters is one key.
    keys = list(dict.fromkeys(word.lower() for word in words))
    if len(keys) == len(words):
        return keys, codes
    places = {word: place for place, word in enumerate(keys)}
    return keys, np.array([places[word.lower()] for word in words], np.int32)[codes]


def _bools(column: pa.ChunkedArray, prefix: str = "") -> Bools:
    words, codes = words_and_codes(column)
    values = [BOOLS.get(w[len(prefix) :]) if w.startswith(prefix) else None for w in words]
    if None in values:
        raise _Odd
    return np.array(values, np.bool_)[codes]


def _doubles(column: pa.ChunkedArray, prefix: str) -> Floats:
    if not pc.all(pc.match_substring_regex(column, f"^{prefix}{DOUBLE}$")).as_py():
        raise _Odd
    texts = pc.utf8_slice_codeunits(column, len(prefix))
    try:
        values: Floats = pc.cast(texts, pa.float64()).to_numpy()
    except pa.ArrowException as error:
        raise _Odd from error
    infinite = np.flatnonzero(np.isinf(values))
    if infinite.size and not pc.all(pc.match_substring(texts.take(infinite), "inf")).as_py():
        raise _Odd
    return values


def _times(column: pa.ChunkedArray) -> Int64s:
    if not pc.all(pc.match_substring_regex(column, f"^{TIME}$")).as_py():
        raise _Odd
    decimals = pc.cast(column, pa.decimal128(19, 9)).combine_chunks()
    if isinstance(decimals, pa.ChunkedArray):
        decimals = pa.concat_arrays(decimals.chunks)
    # A decimal of nine places is stored as a whole number of nanoseconds, in 128 bits.
    raw = np.frombuffer(decimals.buffers()[1], np.int64)
    raw = raw[2 * decimals.offset : 2 * (decimals.offset + len(decimals))]
    times: Int64s = raw[::2]
    if bool((times < 0).any()) or bool(raw[1::2].any()):
        raise _Odd
    return times
