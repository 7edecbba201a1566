"""The binary file that the file sink writes (``.tpc``): fixed-size records, read as columns.

First all chunk headers and the system's records are read (what the sites are called, how the clocks
go), then the threads' chunks, several at once, and brought together in the order of the steady
clock. The file may be of a process that was killed, or that still runs.

It is read, not mapped: into memory that is used again and again, and so stays in the processor's
cache, that was measured to be quicker; and a mapped file that is shortened meanwhile, or lies on a
broken disk, ends the reader with SIGBUS.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, BinaryIO, cast

import numpy as np
import numpy.typing as npt

from pytpc.base.columns import Bools, Int32s, Int64s
from pytpc.base.errors import InputError
from pytpc.base.wording import many
from pytpc.ingest.binary_clock import Clock
from pytpc.ingest.binary_layout import CHUNK, RECORD, FileHeader, whole_bytes
from pytpc.ingest.binary_system import (
    SummaryOrigin,
    SystemRecords,
    open_summaries,
    read_system,
    summary_rows,
    written_summaries,
)
from pytpc.ingest.gathering import Channel, Gathering, Progress, ReportColumns
from pytpc.ingest.spool import Rows
from pytpc.python_runtime import log_layout as layout
from pytpc.recording.mission import Dropped

Bytes = npt.NDArray[np.uint8]

_GROUP = 32
# Kind, thread and first record of a chunk, and the time of that record.
_HEAD = struct.Struct("<IIQ48x8xq")
_IDENTITY = np.dtype([("thread", "<u4"), ("site", "<u4"), ("period", "<u4")])


@dataclass
class RecordBlock(ReportColumns):
    """Reports of one thread, or of several in order; ``steady`` does not fall."""

    steady: Int64s

    def __len__(self) -> int:
        """How many reports."""
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


@dataclass
class _Thread:
    """The chunks of one thread, in the order of the file, and how far they were read."""

    number: int
    chunks: list[int] = field(default_factory=list)
    firsts: list[int] = field(default_factory=list)
    first_steady: int = 0
    read: int = 0
    expected: int = 0
    simulated_ns: int = -1
    steady: int = -(2**63)
    block: RecordBlock | None = None


def read_binary(path: Path, gathering: Gathering, on_progress: Progress | None = None) -> None:
    """Read a .tpc file.

    Raises:
        InputError: it is not such a file, or of another version.
    """
    try:
        with path.open("rb", buffering=0) as stream:
            reader = _TpcReader(path, cast(BinaryIO, stream), gathering, on_progress)
            reader.read()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error
    except ValueError as error:
        raise InputError(f"not a file of reports: {error}", path) from error


class _TpcReader:
    def __init__(
        self, path: Path, stream: BinaryIO, gathering: Gathering, on_progress: Progress | None
    ) -> None:
        self._path = path
        self._stream = stream
        self._gathering = gathering
        self._on_progress = on_progress
        self.header = FileHeader.of(stream.read(layout.HEADER_BYTES))
        self._node = _node_of(self.header, path)
        self._node_code = gathering.nodes.code(self._node)
        self._channel: Channel = gathering.channel(str(path), "file")
        head = self.header
        self._channel.process = f"{head.host} {head.pid} {head.steady_ns} {head.real_ns}"
        self._size = os.fstat(stream.fileno()).st_size
        self._buffer = np.empty((_GROUP, layout.CHUNK_BYTES), np.uint8)
        self._done = 0
        self._system = SystemRecords()
        self._system_chunks: list[int] = []
        self._live_chunks: list[int] = []
        self._torn = 0
        self._torn_slots = 0
        self._chunk_count = 0
        self._last_ns = -(2**63)
        self._clock = Clock.of([(0, 0)])
        self._key_of_site: Int32s = np.full(1, -1, np.int32)

    def read(self) -> None:
        for block in self.blocks():
            self._hand_in(block)
        self._summaries()
        self._complaints()
        self._progress(self._chunk_count)

    def blocks(self) -> Iterator[RecordBlock]:
        """All reports in the order of the steady clock; everything else is read first."""
        threads = self._chunks()
        self._read_system()
        self._clock = Clock.of([(self.header.steady_ns, self.header.real_ns), *self._system.syncs])
        self._key_of_site = self._system.key_codes(self._gathering)
        yield from self._merged(threads)

    # --- the file

    def _chunks(self) -> list[_Thread]:
        """The headers of all chunks; holes in the file are skipped."""
        threads: dict[int, _Thread] = {}
        descriptor = self._stream.fileno()
        place = layout.HEADER_BYTES
        while place + layout.CHUNK_HEADER_BYTES <= self._size:
            head = os.pread(descriptor, _HEAD.size, place)
            if len(head) < _HEAD.size:
                break
            kind, number, first, first_steady = _HEAD.unpack(head)
            if kind == 0 and (next_data := _data_after(descriptor, place)) != place:
                if next_data is None:
                    break
                behind = (next_data - layout.HEADER_BYTES) // layout.CHUNK_BYTES
                place = max(
                    place + layout.CHUNK_BYTES, layout.HEADER_BYTES + behind * layout.CHUNK_BYTES
                )
                continue
            if kind == layout.THREAD_CHUNK:
                thread = threads.setdefault(number, _Thread(number))
                if not thread.chunks:
                    thread.first_steady = first_steady
                thread.chunks.append(place)
                thread.firsts.append(first)
            elif kind == layout.SYSTEM_CHUNK:
                self._system_chunks.append(place)
            elif kind == layout.LIVE_CHUNK:
                self._live_chunks.append(place)
            elif head.startswith(layout.MAGIC):
                what = f"another file begins at byte {place}: give each by itself, not joined"
                raise InputError(what, self._path)
            elif kind:
                self._skip(f"a chunk of the unknown kind {kind} at byte {place}")
            place += layout.CHUNK_BYTES
        self._chunk_count = sum(len(thread.chunks) for thread in threads.values())
        return list(threads.values())

    def _load(self, places: list[int]) -> Bytes:
        """uint8[n, 65536]: some chunks; what the file does not have of them is zero."""
        buffer = self._buffer[: len(places)]
        for row, place in enumerate(places):
            if row and place == places[row - 1] + layout.CHUNK_BYTES:
                continue
            last = row
            while last + 1 < len(places) and places[last + 1] == places[last] + layout.CHUNK_BYTES:
                last += 1
            flat = buffer[row : last + 1].reshape(-1)
            count = os.preadv(self._stream.fileno(), [flat.data], place)
            flat[count:] = 0
            whole = whole_bytes(count % layout.CHUNK_BYTES)
            if count < flat.size and whole < count % layout.CHUNK_BYTES:
                # The record at which the file ends is not whole, whatever its first word says.
                begin = count - count % layout.CHUNK_BYTES + whole
                flat[begin : begin + 4] = 0
        return buffer

    def _load_one(self, place: int) -> Bytes:
        """uint8[n], n at most 65536: what there is of one chunk, in whole records."""
        there = min(layout.CHUNK_BYTES, self._size - place)
        chunk: Bytes = self._load([place])[0][: whole_bytes(there)]
        return chunk

    def _read_system(self) -> None:
        system = self._system
        expected = 0
        for place in self._system_chunks:
            chunk = self._load_one(place)
            first = int(chunk[: CHUNK.itemsize].view(CHUNK)["first"][0])
            # A chunk that has no room for a long record counts as full.
            if first > expected:
                self._gathering.lost[self._node] += first - expected
            expected = max(expected, first) + layout.RECORDS_OF_CHUNK
            read_system(chunk, place, system, self._skip)
        self._torn += system.torn

    # --- reports

    def _merged(self, threads: list[_Thread]) -> Iterator[RecordBlock]:
        """All reports in the order of the steady clock; equal times by thread."""
        waiting = sorted(threads, key=lambda thread: (thread.first_steady, thread.number))
        active: list[_Thread] = []
        while waiting or active:
            if not active or (
                waiting and waiting[0].first_steady <= min(_last(thread) for thread in active)
            ):
                thread = waiting.pop(0)
                if self._next_block(thread):
                    active.append(thread)
                continue
            if len(active) == 1 and not waiting:
                assert active[0].block is not None
                yield active[0].block
            else:
                yield self._up_to(active, min(_last(thread) for thread in active))
                active = [t for t in active if (t.block and len(t.block)) or self._next_block(t)]
                continue
            active = [thread for thread in active if self._next_block(thread)]

    def _up_to(self, active: list[_Thread], bound: int) -> RecordBlock:
        parts = []
        for thread in active:
            assert thread.block is not None
            cut = int(np.searchsorted(thread.block.steady, bound, "right"))
            if cut:
                parts.append(thread.block.part(slice(0, cut)))
                thread.block = thread.block.part(slice(cut, None))
        if len(parts) == 1:
            return parts[0]
        block = RecordBlock.joined(parts)
        return block.part(np.argsort(block.steady, kind="stable"))

    def _next_block(self, thread: _Thread) -> bool:
        """Read on in a thread until there are reports; False at the end."""
        thread.block = None
        while thread.read < len(thread.chunks):
            places = thread.chunks[thread.read : thread.read + _GROUP]
            loaded = self._load(places)
            records = loaded[:, layout.CHUNK_HEADER_BYTES :].view(RECORD)
            first = thread.firsts[thread.read]
            is_last = thread.read + len(places) == len(thread.chunks)
            whole = self._whole(thread, loaded, records, places)
            if whole is not None:
                thread.expected = first + layout.RECORDS_OF_CHUNK * len(places)
                thread.block = whole
                thread.read += len(places)
            else:
                thread.block = self._one_by_one(thread, loaded, records, places, is_last)
            self._progress(len(places))
            if len(thread.block):
                return True
        return False

    def _whole(
        self,
        thread: _Thread,
        loaded: Bytes,
        records: npt.NDArray[np.void],
        places: list[int],
    ) -> RecordBlock | None:
        """The usual case: chunks full of reports of known sites, on the wall's clock."""
        if thread.simulated_ns != -1:
            return None
        firsts = thread.firsts[thread.read : thread.read + len(places)]
        expected = range(
            thread.expected,
            thread.expected + layout.RECORDS_OF_CHUNK * len(places),
            layout.RECORDS_OF_CHUNK,
        )
        # Kind and flags of all records.
        what = loaded[:, layout.CHUNK_HEADER_BYTES :].view("<u2")[:, :: layout.RECORD_BYTES // 2]
        what = np.ascontiguousarray(what).reshape(-1)
        if firsts != list(expected) or bool(((what & 0xFF) != layout.REPORT).any()):
            return None
        # The last entry stands for all sites beyond.
        sites = np.ascontiguousarray(records["site"]).reshape(-1)
        keys = self._key_of_site.take(sites, mode="clip")
        if int(keys.min()) < 0:
            return None
        steady = self._rising(thread, np.ascontiguousarray(records["steady"]).reshape(-1))
        return RecordBlock(
            steady=steady,
            time_ns=self._clock.rising(steady),
            key=keys,
            result=(what & 0x100) != 0,
            cmp=records["cmp"].reshape(-1),
            thresh=records["thresh"].reshape(-1),
            res=(what & 0x200) != 0,
        )

    def _one_by_one(
        self,
        thread: _Thread,
        loaded: Bytes,
        records: npt.NDArray[np.void],
        places: list[int],
        is_last: bool,
    ) -> RecordBlock:
        """Chunks of which at least one is not full or holds other records than reports."""
        blocks = []
        for row, place in enumerate(places):
            first = thread.firsts[thread.read]
            thread.read += 1
            if first > thread.expected:
                self._gathering.lost[self._node] += min(first - thread.expected, 2**62)
            elif first < thread.expected:
                self._skip(
                    f"the chunk at byte {place} begins with record {first} of thread"
                    f" {thread.number}, where {thread.expected} is expected"
                )
            chunk = records[row]
            ends = np.flatnonzero(chunk["what"] == 0)
            used = int(ends[0]) if ends.size else layout.RECORDS_OF_CHUNK
            if used < layout.RECORDS_OF_CHUNK:
                begin = layout.CHUNK_HEADER_BYTES + used * layout.RECORD_BYTES
                self._torn += bool(loaded[row, begin : begin + layout.RECORD_BYTES].any())
            thread.expected = first + used
            blocks.append(self._chunk(thread, chunk[:used].copy(), place))
        return RecordBlock.joined(blocks)

    def _chunk(self, thread: _Thread, chunk: npt.NDArray[np.void], place: int) -> RecordBlock:
        what = chunk["what"]
        kinds = what & 0xFF
        reports = kinds == layout.REPORT
        simulated = kinds == layout.SIMULATED
        for at in np.flatnonzero(~(reports | simulated)).tolist():
            self._skip(f"a record of the unknown kind {kinds[at]} at byte {_byte(place, at)}")
        keys = np.full(chunk.size, -1, np.int32)
        sites = chunk["site"]
        known = sites < self._key_of_site.size
        keys[known] = self._key_of_site[sites[known]]
        for at in np.flatnonzero(reports & (keys < 0)).tolist():
            self._skip(f"a report of the unknown site {sites[at]} at byte {_byte(place, at)}")
        steady = self._rising(thread, np.ascontiguousarray(chunk["steady"]))
        times = self._clock.real(steady)
        if thread.simulated_ns != -1 or bool(simulated.any()):
            # cmp's place holds the simulated time, which stands until the next such record.
            given = np.ascontiguousarray(chunk["cmp"]).view(np.int64)
            since = np.maximum.accumulate(np.where(simulated, np.arange(chunk.size), -1))
            sim_ns = np.where(since < 0, thread.simulated_ns, given[since])
            times = np.where(sim_ns == -1, times, sim_ns)
            if chunk.size:
                thread.simulated_ns = int(sim_ns[-1])
        kept = reports & (keys >= 0)
        flags = what >> 8
        return RecordBlock(
            steady=steady,
            time_ns=times,
            key=keys,
            result=(flags & 1).astype(np.bool_),
            cmp=chunk["cmp"],
            thresh=chunk["thresh"],
            res=((flags >> 1) & 1).astype(np.bool_),
        ).part(kept)

    @staticmethod
    def _rising(thread: _Thread, steady: Int64s) -> Int64s:
        """Within a thread the order is that of the file, whatever its clock says."""
        if not steady.size:
            return steady
        if steady[0] < thread.steady or bool((steady[1:] < steady[:-1]).any()):
            steady = np.maximum(np.maximum.accumulate(steady), thread.steady)
        thread.steady = int(steady[-1])
        return steady

    def _hand_in(self, block: RecordBlock) -> None:
        self._last_ns = max(self._last_ns, int(block.time_ns.max()))
        self._gathering.add_events(self._channel, self._node_code, block)

    # --- the rest

    def _summaries(self) -> None:
        """Those that were written, then those whose period is open, unless they were written."""
        still_open = [open_summaries(self._load_one(place)) for place in self._live_chunks]
        unwritten = np.concatenate([kept for kept, _ in still_open]) if still_open else None
        self._torn_slots = sum(torn for _, torn in still_open)
        for place in self._system_chunks:
            kept = written_summaries(self._load_one(place))
            if unwritten is not None and kept.size:
                unwritten = unwritten[~np.isin(_identity(unwritten), _identity(kept))]
            self._hand_in_summaries(kept)
        if unwritten is not None:
            self._hand_in_summaries(unwritten)

    def _hand_in_summaries(self, kept: Rows) -> None:
        origin = SummaryOrigin(self._clock, self._last_ns, self._node_code, self._channel.code)
        rows = summary_rows(kept, origin, self._key_of_site, self._skip)
        self._gathering.add_summary_rows(rows)

    def _complaints(self) -> None:
        gathering, header, name = self._gathering, self.header, self._path.name
        stopped = 0
        for dropped in self._system.dropped(self._node):
            gathering.add_dropped(dropped)
            stopped += dropped.count if dropped.why == "stopped" else 0
        if header.not_recorded > stopped:
            gathering.add_dropped(
                Dropped("", self._node, header.not_recorded - stopped, 0, "stopped")
            )
        if self._torn:
            gathering.notes.append(
                f"{name}: {many(self._torn, 'record')} half written when the process ended"
            )
        if self._torn_slots:
            gathering.notes.append(
                f"{name}: {many(self._torn_slots, 'open period')} may lack an evaluation"
            )
        if header.state == layout.STOPPED:
            gathering.notes.append(
                f"{name}: recording stopped before the process ended (disk full, or file_limit)"
            )

    def _skip(self, what: str) -> None:
        self._gathering.skip(self._path.name, 0, what, "")

    def _progress(self, chunks: int) -> None:
        self._done += chunks
        if self._on_progress is not None:
            total = self._chunk_count * layout.CHUNK_BYTES
            self._on_progress(min(self._done * layout.CHUNK_BYTES, total), total)


def _last(thread: _Thread) -> int:
    assert thread.block is not None
    return int(thread.block.steady[-1])


def _identity(kept: Rows) -> Rows:
    """Thread, site and period of each summary, to be compared as one."""
    named = np.empty(kept.size, _IDENTITY)
    for name in _IDENTITY.names or ():
        named[name] = kept[name]
    return named


def _byte(place: int, record: int) -> int:
    return place + layout.CHUNK_HEADER_BYTES + record * layout.RECORD_BYTES


def _node_of(header: FileHeader, path: Path) -> str:
    """The name of the process: that of its node or, if it never was one, of its program.

    A forked child has its parent's name. What one of them evaluates says nothing about the other.
    """
    if header.node:
        return f"{header.node} ({header.pid})" if header.parent else header.node
    name = header.program.rpartition("/")[2]
    return f"{name} ({header.pid})" if name else path.stem


def _data_after(descriptor: int, place: int) -> int | None:
    """The next byte of a sparse file that is not in a hole; None where there is none."""
    try:
        return os.lseek(descriptor, place, os.SEEK_DATA)
    except OSError:
        return None
