"""Writes the binary file of reports (docs/reference/formats.md) from columns, as fast as a disk.

A file is `header`, then `system_chunks`, then `thread_chunks` in any order.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

from pytpc.ingest.binary_chunks import RECORD
from pytpc.python_runtime import log_layout as layout

Records = npt.NDArray[np.void]
"""Reports as ``RECORD``; `reports` makes them."""

_HEAD = np.dtype(
    {
        "names": ["kind", "thread", "first", "tid"],
        "formats": ["<u4", "<u4", "<u8", "<u8"],
        "itemsize": layout.CHUNK_HEADER_BYTES,
    }
)
_RECORDS_BYTES = layout.CHUNK_BYTES - layout.CHUNK_HEADER_BYTES
_SHORT_TEXT = 16
_OUTCOMES = layout.RESULT_BIT | layout.OUTCOME_BIT


def header(
    node: str,
    *,
    host: str = "",
    program: str = "",
    pid: int = 1,
    steady_ns: int = 0,
    real_ns: int = 0,
) -> bytes:
    """The header of the file of a process that ended as it should; times when it began."""
    return layout.HEADER.pack(
        layout.MAGIC,
        layout.HEADER_BYTES,
        layout.RECORD_BYTES,
        layout.CHUNK_BYTES,
        pid,
        steady_ns,
        real_ns,
        layout.CLOSED,
        0,
        0,
        0,
        0,
        node.encode(),
        host.encode(),
        program.encode(),
    ).ljust(layout.HEADER_BYTES, b"\0")


def site(number: int, key: str) -> bytes:
    """The record that gives a site its key; sites are numbered from 1."""
    return _text(layout.SITE, number, key)


def name(key: str, parameter: str) -> bytes:
    """The record of the full name of the parameter that the read ``key`` has read."""
    return _text(layout.NAME, 0, f"{key},{parameter}")


def sync(steady_ns: int, real_ns: int) -> bytes:
    """The record that says which time CLOCK_REALTIME had."""
    return struct.pack("<IIqqq", layout.SYNC, 0, steady_ns, real_ns, 0)


def _text(kind: int, number: int, text: str) -> bytes:
    raw = text.encode()
    blocks = -(-max(0, len(raw) - _SHORT_TEXT) // layout.RECORD_BYTES)
    first = struct.pack("<III4x16s", kind, number, len(raw), raw[:_SHORT_TEXT])
    return first + raw[_SHORT_TEXT:].ljust(layout.RECORD_BYTES * blocks, b"\0")


def system_chunks(records: Iterable[bytes]) -> bytes:
    """The chunks with these records, none of which lies in two of them."""
    chunks: list[list[bytes]] = [[]]
    room = _RECORDS_BYTES
    for record in records:
        if len(record) > room:
            chunks.append([])
            room = _RECORDS_BYTES
        chunks[-1].append(record)
        room -= len(record)
    made = b""
    for number, chunk in enumerate(chunks):
        # A chunk that has no room for a long record counts as full.
        first = number * layout.RECORDS_OF_CHUNK
        head = struct.pack("<IIQQ40x", layout.SYSTEM_CHUNK, 0, first, 0)
        made += (head + b"".join(chunk)).ljust(layout.CHUNK_BYTES, b"\0")
    return made


def reports(shape: int | tuple[int, ...], res: npt.ArrayLike) -> Records:
    """Reports of these outcomes; the caller fills in ``site``, ``steady``, ``cmp`` and ``thresh``.

    Args:
        shape: how many.
        res: bool, of this shape: the result of the comparison, and of its predicate.
    """
    made = np.empty(shape, RECORD)
    made["what"] = layout.REPORT + np.asarray(res, np.uint32) * np.uint32(_OUTCOMES)
    return made


def thread_chunks(thread: int, records: Records, first: int = 0) -> npt.NDArray[np.uint8]:
    """The chunks with the reports of a thread.

    Args:
        thread: its number, from 1.
        records: [n], in the order of time.
        first: how many reports of the thread are in chunks before these.

    Returns:
        uint8[ceil(n / 2046), 65536].
    """
    count = -(-records.size // layout.RECORDS_OF_CHUNK)
    made = np.zeros((count, layout.CHUNK_BYTES), np.uint8)
    heads = made[:, : layout.CHUNK_HEADER_BYTES].view(_HEAD)[:, 0]
    heads["kind"] = layout.THREAD_CHUNK
    heads["thread"] = heads["tid"] = thread
    heads["first"] = first + np.arange(count) * layout.RECORDS_OF_CHUNK
    raw = np.ascontiguousarray(records).view(np.uint8)
    full, rest = divmod(raw.size, _RECORDS_BYTES)
    space = made[:, layout.CHUNK_HEADER_BYTES :]
    space[:full] = raw[: full * _RECORDS_BYTES].reshape(full, _RECORDS_BYTES)
    if rest:
        space[full, :rest] = raw[full * _RECORDS_BYTES :]
    return made


def in_order(threads: Sequence[npt.NDArray[np.uint8]]) -> list[npt.NDArray[np.uint8]]:
    """The chunks of several threads by the time of their first reports, as a process takes them.

    Args:
        threads: results of `thread_chunks`.
    """
    at = layout.CHUNK_HEADER_BYTES + 8
    chunks = [chunk for one in threads for chunk in one]
    return sorted(chunks, key=lambda chunk: int(chunk[at : at + 8].view("<i8")[0]))
