"""The binary file that the file sink writes (``.tpc``): fixed-size records, read as columns.

The reader first reads all chunk headers and the system's records (keys of sites, clocks). Then it
reads the threads' chunks, several at once, and merges them in the order of the steady clock. The
process that wrote the file may have been killed, or may still be running.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO, cast

import numpy as np
import numpy.typing as npt

from pytpc.base.columns import Int32s, Int64s
from pytpc.base.errors import InputError
from pytpc.base.wording import many
from pytpc.ingest.binary_chunks import (
    CHUNK,
    GROUP,
    RECORD,
    Bytes,
    ChunkFile,
    Columns,
    FileHeader,
    RecordBlock,
    ThreadChunks,
)
from pytpc.ingest.binary_clock import Clock
from pytpc.ingest.binary_system import (
    SystemRecords,
    open_summaries,
    read_system,
    summary_rows,
    written_summaries,
)
from pytpc.ingest.condense import Condenser, Extent, hot_keys
from pytpc.ingest.gathering import Channel, Gathering, Progress
from pytpc.ingest.spool import Rows
from pytpc.python_runtime import log_layout as layout
from pytpc.recording.mission import Dropped

_IDENTITY = np.dtype([("thread", "<u4"), ("site", "<u4"), ("period", "<u4")])


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
        self._gathering = gathering
        self._on_progress = on_progress
        self.header = FileHeader.of(stream.read(layout.HEADER_BYTES))
        self._node = _node_of(self.header, path)
        self._node_code = gathering.nodes.code(self._node)
        self._channel: Channel = gathering.channel(str(path), "file")
        head = self.header
        self._channel.process = f"{head.host} {head.pid} {head.steady_ns} {head.real_ns}"
        self._file = ChunkFile(path, stream.fileno())
        self._done = 0
        self._system = SystemRecords()
        self._torn = 0
        self._torn_slots = 0
        self._last_ns = -(2**63)
        self._clock = Clock.of([(0, 0)])
        self._key_of_site: Int32s = np.full(1, -1, np.int32)
        self._condenser: Condenser | None = None

    def read(self) -> None:
        for block in self.blocks():
            self._hand_in(block)
        if self._condenser is not None:
            self._condenser.finish()
        self._summaries()
        self._complaints()
        self._progress(self._file.count)

    def blocks(self) -> Iterator[RecordBlock]:
        """All reports in the order of the steady clock; everything else is read first.

        Those that are condensed come thread by thread, where that makes no difference. The memory
        of a block is used again for a later one.
        """
        threads = self._file.find(self._skip)
        self._read_system()
        self._clock = Clock.of([(self.header.steady_ns, self.header.real_ns), *self._system.syncs])
        self._key_of_site = self._system.key_codes(self._gathering)
        if threads and not self._gathering.has_room(self._file.count * layout.RECORDS_OF_CHUNK):
            self._condenser = self._made_condenser(threads)
        if self._gathering.period_ns is not None and self._file.are_apart(
            threads, self._key_of_site
        ):
            yield from self._in_turn(threads)
        else:
            yield from self._merged(threads)

    def _read_system(self) -> None:
        system = self._system
        expected = 0
        for place in self._file.system:
            chunk = self._file.load_one(place)
            first = int(chunk[: CHUNK.itemsize].view(CHUNK)["first"][0])
            # A chunk that has no room for a long record counts as full.
            if first > expected:
                self._gathering.lost[self._node] += first - expected
            expected = max(expected, first) + layout.RECORDS_OF_CHUNK
            read_system(chunk, place, system, self._skip)
        self._torn += system.torn

    # --- reports

    def _in_turn(self, threads: list[ThreadChunks]) -> Iterator[RecordBlock]:
        """All reports of the first thread, then those of the next one."""
        for thread in sorted(threads, key=_begin):
            while self._next_block(thread):
                assert thread.block is not None
                yield thread.block

    def _merged(self, threads: list[ThreadChunks]) -> Iterator[RecordBlock]:
        """All reports in the order of the steady clock; equal times by thread."""
        waiting = sorted(threads, key=_begin)
        active: list[ThreadChunks] = []
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

    def _up_to(self, active: list[ThreadChunks], bound: int) -> RecordBlock:
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

    def _next_block(self, thread: ThreadChunks) -> bool:
        """Read on in a thread until there are reports; False at the end."""
        thread.block = None
        while thread.read < len(thread.chunks):
            # The last chunk mostly is not full, which makes a group slow.
            end = max(thread.read + 1, min(thread.read + GROUP, len(thread.chunks) - 1))
            places = thread.chunks[thread.read : end]
            loaded = self._file.load(places)
            records = loaded[:, layout.CHUNK_HEADER_BYTES :].view(RECORD)
            first = thread.firsts[thread.read]
            whole = self._whole(thread, loaded, places)
            if whole is not None:
                thread.expected = first + layout.RECORDS_OF_CHUNK * len(places)
                thread.block = whole
                thread.read += len(places)
            else:
                thread.block = self._one_by_one(thread, loaded, records, places)
            self._progress(len(places))
            if len(thread.block):
                return True
        thread.columns = None
        return False

    def _whole(
        self,
        thread: ThreadChunks,
        loaded: Bytes,
        places: list[int],
    ) -> RecordBlock | None:
        """The usual case: chunks full of reports of known sites, on wall time."""
        if thread.simulated_ns != -1:
            return None
        firsts = thread.firsts[thread.read : thread.read + len(places)]
        expected = range(
            thread.expected,
            thread.expected + layout.RECORDS_OF_CHUNK * len(places),
            layout.RECORDS_OF_CHUNK,
        )
        if firsts != list(expected):
            return None
        thread.columns = thread.columns or Columns()
        block = thread.columns.fill(loaded, self._key_of_site)
        if block is None or int(block.key.min()) < 0:
            return None
        block.steady = self._rising(thread, block.steady)
        self._clock.rising(block.steady, block.time_ns)
        return block

    def _one_by_one(
        self,
        thread: ThreadChunks,
        loaded: Bytes,
        records: npt.NDArray[np.void],
        places: list[int],
    ) -> RecordBlock:
        """Chunks, at least one of which is not full or holds other records than reports."""
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

    def _chunk(self, thread: ThreadChunks, chunk: npt.NDArray[np.void], place: int) -> RecordBlock:
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
            # cmp holds the simulated time, which is valid until the next such record.
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
    def _rising(thread: ThreadChunks, steady: Int64s) -> Int64s:
        """Within a thread the order is that of the file, whatever its clock says."""
        if not steady.size:
            return steady
        if steady[0] < thread.steady or bool((steady[1:] < steady[:-1]).any()):
            steady = np.maximum(np.maximum.accumulate(steady), thread.steady)
        thread.steady = int(steady[-1])
        return steady

    def _hand_in(self, block: RecordBlock) -> None:
        self._last_ns = max(self._last_ns, int(block.time_ns.max()))
        if self._condenser is None:
            self._gathering.add_events(self._channel, self._node_code, block)
        else:
            self._condenser.add(block)

    def _made_condenser(self, threads: list[ThreadChunks]) -> Condenser:
        """Condenses the comparisons that have most reports; all, if that is asked for."""
        blocks = self._file.count // GROUP + len(threads)
        asked = self._gathering.period_ns
        if asked is not None:
            every = np.ones(len(self._gathering.keys.codes), np.bool_)
            extent = Extent(0.0, blocks, asked)
            return Condenser(self._gathering, self._channel, self._node_code, every, extent)
        sites, times = self._file.some_sites(threads)
        keys = self._key_of_site.take(sites, mode="clip")
        # A thread whose first record was not written begins at 0.
        first = min((t.first_steady for t in threads if t.first_steady > 0), default=0)
        return Condenser(
            self._gathering,
            self._channel,
            self._node_code,
            hot_keys(keys[keys >= 0], len(self._gathering.keys.codes), times),
            Extent((max(thread.last_steady for thread in threads) - first) / 1e9, blocks),
        )

    # --- the rest

    def _summaries(self) -> None:
        """Hand in the written summaries, then those of open periods that were not written."""
        still_open = [open_summaries(self._file.load_one(place)) for place in self._file.live]
        unwritten = np.concatenate([kept for kept, _ in still_open]) if still_open else None
        self._torn_slots = sum(torn for _, torn in still_open)
        for place in self._file.system:
            kept = written_summaries(self._file.load_one(place))
            if unwritten is not None and kept.size:
                # Few are unwritten, and most that are written are of another time.
                near = kept[np.isin(kept["period"], unwritten["period"])]
                unwritten = unwritten[~np.isin(_identity(unwritten), _identity(near))]
            self._hand_in_summaries(kept)
        if unwritten is not None:
            self._hand_in_summaries(unwritten)

    def _hand_in_summaries(self, kept: Rows) -> None:
        self._note_samples(kept)
        rows = summary_rows(kept, self._key_of_site, self._clock, self._last_ns, self._skip)
        rows["node"] = self._node_code
        rows["channel"] = self._channel.code
        self._gathering.summaries.append(rows)

    def _note_samples(self, kept: Rows) -> None:
        """Note what the policy light has not inspected."""
        known = (kept["site"] < self._key_of_site.size) & (kept["seen"] <= kept["count"])
        told = known & (((kept["seen"] > 0) & (kept["seen"] < kept["count"])) | (kept["about"] > 0))
        for one in kept[told]:
            code, count, seen = int(self._key_of_site[one["site"]]), one["count"], one["seen"]
            self._gathering.note_sample(code, int(count), int(seen or count), bool(one["about"]))

    def _complaints(self) -> None:
        gathering, header, name = self._gathering, self.header, self._path.name
        for named in self._system.names:
            gathering.add_named(named, self._node)
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
            total = self._file.count * layout.CHUNK_BYTES
            self._on_progress(min(self._done * layout.CHUNK_BYTES, total), total)


def _begin(thread: ThreadChunks) -> tuple[int, int]:
    return thread.first_steady, thread.number


def _last(thread: ThreadChunks) -> int:
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
