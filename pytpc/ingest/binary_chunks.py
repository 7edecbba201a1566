"""The binary file of reports (docs/reference/formats.md): its header, its chunks and their bytes.

``pytpc.python_runtime.log_layout`` has the constants of the writer. Chunks are read, not mapped:
reading into the same memory again and again is faster, because it stays in the processor's cache.
A mapped file that is shortened meanwhile, or that lies on a broken disk, ends the reader by SIGBUS.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pytpc.base.columns import Bools, Int32s, Int64s
from pytpc.base.errors import InputError
from pytpc.ingest.gathering import ReportColumns
from pytpc.python_runtime import log_layout as layout

Bytes = npt.NDArray[np.uint8]
Sites = npt.NDArray[np.uint32]
Skip = Callable[[str], None]

# The most chunks that are read at once.
GROUP = 16
_SAMPLES = 128
# A file of so many bytes is in the system's cache when it is read the second time.
_READ_TWICE = 1 << 30
# Kind, thread and first record of a chunk, and the time of that record.
_HEAD = struct.Struct("<IIQ48x8xq")
_HEADS = np.dtype(
    {
        "names": ["kind", "thread", "first", "steady"],
        "formats": ["<u4", "<u4", "<u8", "<i8"],
        "offsets": [0, 4, 8, 72],
        "itemsize": _HEAD.size,
    }
)
_MOST_HEADS = 1024

RECORD = np.dtype(
    [("what", "<u4"), ("site", "<u4"), ("steady", "<i8"), ("cmp", "<f8"), ("thresh", "<f8")]
)
CHUNK = np.dtype([("kind", "<u4"), ("thread", "<u4"), ("first", "<u8"), ("tid", "<u8")])
KEPT = np.dtype(
    [
        ("what", "<u4"),
        ("site", "<u4"),
        ("begin_steady", "<i8"),
        ("cmp", "<f8"),
        ("thresh", "<f8"),
        ("end_steady", "<i8"),
        ("period", "<u4"),
        ("thread", "<u4"),
        *((name, "<u8") for name in ("count", "odd", "far")),
        *((name, "<f8") for name in ("diff_min", "diff_max", "diff_sum", "abs_sum")),
        *((name, "<f8") for name in ("low", "high")),
        ("flops", "<u8"),
        ("begin_ros", "<i8"),
        ("end_ros", "<i8"),
        ("seen", "<u8"),
        ("about", "<u8"),
    ]
)
SLOT = np.dtype([("kept", KEPT), ("begun", "<u8"), ("spare", "<u8", 3)])


def _whole_bytes(count: int) -> int:
    """How many of the first ``count`` bytes of a chunk are its header and whole records."""
    return max(0, count - (count - layout.CHUNK_HEADER_BYTES) % layout.RECORD_BYTES)


@dataclass(frozen=True, slots=True)
class FileHeader:
    """The header of the file; times in ns of the clocks of its machine.

    ``segment`` is its number in a ring, from 1; 0: it is no ring's.
    """

    pid: int
    steady_ns: int
    real_ns: int
    state: int
    not_recorded: int
    parent: int
    segment: int
    node: str
    host: str
    program: str

    @classmethod
    def of(cls, data: bytes) -> FileHeader:
        """Read it.

        Raises:
            ValueError: the bytes are too few, or no such header.
        """
        if len(data) < layout.HEADER_BYTES:
            raise ValueError(f"the file ends at byte {len(data)}, within its header")
        magic, size, record, chunk, pid, steady, real, state, _, lost, parent, segment, *texts = (
            layout.HEADER.unpack_from(data)
        )
        if magic != layout.MAGIC:
            raise ValueError("its first bytes are not those of a .tpc file")
        if (size, record, chunk) != (layout.HEADER_BYTES, layout.RECORD_BYTES, layout.CHUNK_BYTES):
            raise ValueError(
                f"header, record and chunk of {size}, {record} and {chunk} bytes are not of this"
                " version"
            )
        node, host, program = (
            text.partition(b"\0")[0].decode("utf-8", "replace") for text in texts
        )
        return cls(pid, steady, real, state, lost, parent, segment, node, host, program)


@dataclass
class RecordBlock(ReportColumns):
    """Reports of one thread, or of several in order; ``steady`` does not fall."""

    steady: Int64s

    def __len__(self) -> int:
        return int(self.steady.size)

    def part(self, rows: slice | Int64s | Bools) -> RecordBlock:
        """Some of them."""
        return RecordBlock(
            **{field.name: getattr(self, field.name)[rows] for field in fields(self)}
        )

    @classmethod
    def joined(cls, blocks: list[RecordBlock]) -> RecordBlock:
        """All of ``blocks`` joined."""
        names = [field.name for field in fields(cls)]
        columns: dict[str, Any] = {
            name: np.concatenate([getattr(block, name) for block in blocks]) for name in names
        }
        return cls(**columns)


class Columns:
    """Memory for the reports of a group of chunks, which is filled again and again.

    The system gives new memory page by page, which takes longer than all that is done with it.
    """

    def __init__(self) -> None:
        rows = GROUP * layout.RECORDS_OF_CHUNK
        self._words = np.empty((4, rows), np.int64)
        self._places = np.empty(rows, np.int64)
        self._time_ns = np.empty(rows, np.int64)
        self._key = np.empty(rows, np.int32)
        self._what = np.empty((2, rows), np.uint16)
        self._outcomes = np.empty((2, rows), np.bool_)

    def fill(self, loaded: Bytes, key_of_site: Int32s) -> RecordBlock | None:
        """The reports of full chunks without their times; None where there is another record.

        The block is valid until the next call. ``key`` is -1 for unknown sites.

        Args:
            loaded: uint8[n, 65536].
            key_of_site: int32[m]; the last entry stands for all sites beyond.
        """
        count = loaded.shape[0] * layout.RECORDS_OF_CHUNK
        words = self._words[:, :count]
        records = loaded[:, layout.CHUNK_HEADER_BYTES :].view(np.int64)
        shape = (loaded.shape[0], layout.RECORDS_OF_CHUNK, 4)
        np.copyto(words.reshape(4, *shape[:2]), records.reshape(shape).transpose(2, 0, 1))
        # The first word: kind, flags, two bytes, and the site in its upper half.
        what, part = self._what[:, :count]
        np.copyto(what, words[0], casting="unsafe")
        if bool((np.bitwise_and(what, 0xFF, out=part) != layout.REPORT).any()):
            return None
        outcomes = self._outcomes[:, :count]
        np.not_equal(np.bitwise_and(what, 0x100, out=part), 0, out=outcomes[0])
        np.not_equal(np.bitwise_and(what, 0x200, out=part), 0, out=outcomes[1])
        places = np.right_shift(words[0].view(np.uint64), 32, out=self._places[:count].view("u8"))
        key = self._key[:count]
        key_of_site.take(places.view(np.int64), mode="clip", out=key)
        return RecordBlock(
            steady=words[1],
            time_ns=self._time_ns[:count],
            key=key,
            result=outcomes[0],
            cmp=words[2].view(np.float64),
            thresh=words[3].view(np.float64),
            res=outcomes[1],
        )


@dataclass
class ThreadChunks:
    """The chunks of one thread, in the order of the file, and how far they were read.

    ``first_steady`` is the time of the first record in its first chunk, ``last_steady`` the latest
    of those in all of them.
    """

    number: int
    chunks: list[int] = field(default_factory=list)
    firsts: list[int] = field(default_factory=list)
    first_steady: int = 0
    last_steady: int = 0
    read: int = 0
    expected: int = 0
    simulated_ns: int = -1
    steady: int = -(2**63)
    block: RecordBlock | None = None
    columns: Columns | None = None


class ChunkFile:
    """The chunks of one file.

    ``system`` and ``live`` are the first bytes of those chunks, ``count`` is the number of chunks
    of threads; all are known after ``find``.
    """

    def __init__(self, path: Path, descriptor: int) -> None:
        self._path = path
        self._descriptor = descriptor
        self._buffer = np.empty((GROUP, layout.CHUNK_BYTES), np.uint8)
        self.size = os.fstat(descriptor).st_size
        self.system: list[int] = []
        self.live: list[int] = []
        self.count = 0

    def find(self, skip: Skip) -> list[ThreadChunks]:
        """Read the headers of all chunks; holes in the file are skipped."""
        threads: dict[int, ThreadChunks] = {}
        descriptor = self._descriptor
        place = layout.HEADER_BYTES
        ahead = 1
        while place + layout.CHUNK_HEADER_BYTES <= self.size:
            # Nearly all chunks are of threads, and stand together.
            ahead = min(2 * ahead, _MOST_HEADS)
            found = self._thread_heads(place, ahead)
            if found.size:
                _add_chunks(threads, found, place)
                place += found.size * layout.CHUNK_BYTES
                continue
            ahead = 1
            head = os.pread(descriptor, _HEAD.size, place)
            if len(head) < _HEAD.size:
                break
            kind = int.from_bytes(head[:4], "little")
            if kind == 0 and (next_data := _data_after(descriptor, place)) != place:
                if next_data is None:
                    break
                behind = (next_data - layout.HEADER_BYTES) // layout.CHUNK_BYTES
                place = max(
                    place + layout.CHUNK_BYTES, layout.HEADER_BYTES + behind * layout.CHUNK_BYTES
                )
                continue
            if kind == layout.SYSTEM_CHUNK:
                self.system.append(place)
            elif kind == layout.LIVE_CHUNK:
                self.live.append(place)
            elif head.startswith(layout.MAGIC):
                what = f"another file begins at byte {place}: give each by itself, not joined"
                raise InputError(what, self._path)
            elif kind:
                skip(f"a chunk of the unknown kind {kind} at byte {place}")
            place += layout.CHUNK_BYTES
        self.count = sum(len(thread.chunks) for thread in threads.values())
        return list(threads.values())

    def _thread_heads(self, place: int, most: int) -> npt.NDArray[np.void]:
        """The heads of chunks of threads that stand at ``place``, one behind the other."""
        end = min(self.size - _HEAD.size + 1, place + most * layout.CHUNK_BYTES)
        places = range(place, end, layout.CHUNK_BYTES)
        heads = [os.pread(self._descriptor, _HEAD.size, each) for each in places]
        while heads and len(heads[-1]) < _HEAD.size:
            heads.pop()
        found = np.frombuffer(b"".join(heads), _HEADS)
        others = np.flatnonzero(found["kind"] != layout.THREAD_CHUNK)
        return found[: int(others[0])] if others.size else found

    def some_sites(self, threads: list[ThreadChunks]) -> tuple[Sites, float]:
        """uint32[n]: the sites of the reports in chunks all over the file.

        Also how many times as many reports the file has.
        """
        places = sorted(place for thread in threads for place in thread.chunks)
        some = min(_SAMPLES, len(places))
        found = [np.empty(0, np.uint32)]
        for number in range(some):
            chunk = self.load_one(places[number * len(places) // some])
            records = chunk[layout.CHUNK_HEADER_BYTES :].view(RECORD)
            found.append(records["site"][(records["what"] & 0xFF) == layout.REPORT])
        return np.concatenate(found), len(places) / max(1, some)

    def are_apart(self, threads: list[ThreadChunks], key_of_site: Int32s) -> bool:
        """Whether no key has reports of two threads; False for a file that is too large to tell.

        Args:
            threads: all of them.
            key_of_site: int32[m]; the last entry stands for all sites beyond.
        """
        if len(threads) < 2:
            return True
        if self.count * layout.CHUNK_BYTES > _READ_TWICE:
            return False
        seen = np.zeros(int(key_of_site.max(initial=0)) + 1, np.bool_)
        for thread in threads:
            own = np.zeros_like(seen)
            for at in range(0, len(thread.chunks), GROUP):
                loaded = self.load(thread.chunks[at : at + GROUP])
                records = loaded[:, layout.CHUNK_HEADER_BYTES :].view(RECORD)
                # Other records than reports count, too; most have no site.
                keys = key_of_site.take(records["site"].reshape(-1), mode="clip")
                own[keys[keys >= 0]] = True
            if bool((seen & own).any()):
                return False
            seen |= own
        return True

    def load(self, places: list[int]) -> Bytes:
        """uint8[n, 65536]: some chunks; what the file does not have of them is zero."""
        buffer = self._buffer[: len(places)]
        for row, place in enumerate(places):
            if row and place == places[row - 1] + layout.CHUNK_BYTES:
                continue
            last = row
            while last + 1 < len(places) and places[last + 1] == places[last] + layout.CHUNK_BYTES:
                last += 1
            flat = buffer[row : last + 1].reshape(-1)
            count = os.preadv(self._descriptor, [flat.data], place)
            flat[count:] = 0
            whole = _whole_bytes(count % layout.CHUNK_BYTES)
            if count < flat.size and whole < count % layout.CHUNK_BYTES:
                # The record at which the file ends is not whole, whatever its first word says.
                begin = count - count % layout.CHUNK_BYTES + whole
                flat[begin : begin + 4] = 0
        return buffer

    def load_one(self, place: int) -> Bytes:
        """uint8[n], n at most 65536: what there is of one chunk, in whole records."""
        there = min(layout.CHUNK_BYTES, self.size - place)
        chunk: Bytes = self.load([place])[0][: _whole_bytes(there)]
        return chunk


def _add_chunks(threads: dict[int, ThreadChunks], heads: npt.NDArray[np.void], place: int) -> None:
    """Add chunks that stand one behind the other from ``place`` on."""
    numbers, first_rows = np.unique(heads["thread"], return_index=True)
    for number in numbers[np.argsort(first_rows)].tolist():
        rows = np.flatnonzero(heads["thread"] == number)
        own = heads[rows]
        thread = threads.get(number)
        if thread is None:
            thread = ThreadChunks(number, first_steady=int(own["steady"][0]))
            threads[number] = thread
        thread.chunks += (place + rows * layout.CHUNK_BYTES).tolist()
        thread.firsts += own["first"].tolist()
        # The last chunk of a process that was killed may have no record yet.
        thread.last_steady = max(thread.last_steady, int(own["steady"].max()))


def _data_after(descriptor: int, place: int) -> int | None:
    """The next byte of a sparse file that is not in a hole; None where there is none."""
    try:
        return os.lseek(descriptor, place, os.SEEK_DATA)
    except OSError:
        return None
