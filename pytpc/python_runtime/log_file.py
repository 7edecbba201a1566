"""The binary file of reports (docs/reference/formats.md), written straight into mapped memory.

The kernel keeps what was written, whatever happens to the process. Space is allocated on disk
before it is mapped, so that a full disk is an error and not a signal. Each thread has chunks of its
own, and claims a place by one call into C: a signal handler or finaliser that reports in the middle
of a report gets another place. ``what``, the first word of a record, is written last. Ctrl-C, or
another exception of a handler, may end a report anywhere; the place that it left empty is filled.
"""

from __future__ import annotations

import struct
import threading
from collections.abc import Callable
from itertools import count
from time import monotonic_ns, time_ns
from typing import TYPE_CHECKING

from pytpc.python_runtime import ros_state
from pytpc.python_runtime.config import Config
from pytpc.python_runtime.log_layout import (
    CHUNK_BYTES,
    CHUNK_HEADER_BYTES,
    DROPPED,
    EDGE_BIT,
    LIVE_CHUNK,
    LONGEST_KEY,
    NAME,
    NODE_AT,
    NODE_BYTES,
    POLICY,
    REASONS,
    RECORD_BYTES,
    RECORDS_OF_CHUNK,
    SECOND,
    SIMULATED,
    SITE,
    SLOT_BYTES,
    SLOTS_OF_CHUNK,
    SYNC,
    SYSTEM_CHUNK,
    THREAD_CHUNK,
    WHATS,
    pack_integers,
    pack_report,
)
from pytpc.python_runtime.mapped_file import Extent, MappedFile, SegmentName, bounded
from pytpc.python_runtime.sinks import LiveSlot

if TYPE_CHECKING:
    from pytpc.python_runtime.sites import Reported, Take

_INTEGERS = struct.Struct("<Iqqq")


def _both_clocks() -> tuple[int, int, int]:
    """How long the reading took, and the steady and the real time in its middle."""
    before, real, after = monotonic_ns(), time_ns(), monotonic_ns()
    return after - before, before + (after - before) // 2, real


class _Chunk:
    """Records of one thread. ``claim()`` gives the place of one, which may be behind ``end``."""

    __slots__ = ("begin", "bytes", "claim", "end", "words")

    def __init__(self, extent: Extent, begin: int) -> None:
        self.bytes = extent.bytes
        self.words = extent.words
        self.begin = begin + CHUNK_HEADER_BYTES
        self.claim = count(self.begin, RECORD_BYTES).__next__
        self.end = begin + CHUNK_BYTES

    def fill(self, now: int, sim_ns: int) -> None:
        """Write a record without content where one was claimed and not written.

        A reader stops at an empty record.
        """
        end = min(self.claim() + RECORD_BYTES, self.end)
        for at in range(self.begin, end, RECORD_BYTES):
            if not self.words[at >> 2]:
                pack_integers(self.bytes, at + 4, 0, now, sim_ns, 0)
                self.words[at >> 2] = SIMULATED


class _NoChunk(_Chunk):
    """Before the first chunk, and where there is no more space."""

    __slots__ = ()

    def __init__(self) -> None:
        self.claim = count().__next__
        self.begin = self.end = 0


class _ThreadPlace:
    """Where a thread writes: its chunk, and the number of records in its earlier chunks."""

    __slots__ = ("chunk", "former", "is_changing", "number", "sim_ns", "written")

    def __init__(self, number: int) -> None:
        self.number = number
        self.written = 0
        self.sim_ns = -1
        self.is_changing = False
        self.former: _Chunk = _NoChunk()
        self.chunk: _Chunk = self.former

    def fill(self) -> None:
        """A report was interrupted: its place may be in this chunk or in the previous one."""
        now = monotonic_ns()
        for chunk in (self.former, self.chunk):
            chunk.fill(now, self.sim_ns)


class _SystemChunk:
    """Where system records are written: in ``extent`` from byte ``at`` to ``end``."""

    __slots__ = ("at", "end", "extent", "first", "is_busy")

    def __init__(self, extent: Extent, begin: int, first: int) -> None:
        self.extent = extent
        self.at = begin + CHUNK_HEADER_BYTES
        self.end = begin + CHUNK_BYTES
        self.first = first
        self.is_busy = False


class _Owner:
    """Keeps a place for its thread; when the thread ends, another thread can take the place."""

    __slots__ = ("_free", "_place")

    def __init__(self, place: _ThreadPlace, free: list[_ThreadPlace]) -> None:
        self._place = place
        self._free = free

    def __del__(self) -> None:
        self._free.append(self._place)


class LogFile(MappedFile):
    """One file, and the records that are written to it."""

    def __init__(
        self,
        config: Config,
        parent: int,
        each_second: Callable[[], None],
        of: SegmentName | None = None,
    ) -> None:
        """Make the file in its folder; ``of``: the next one of a ring.

        Raises:
            OSError: it cannot be made.
        """
        node = ros_state.now().node
        super().__init__(config, parent, node, of)
        # What a key holds that this file has: a key does not keep the memory of a former file.
        self._announced = object()
        self._each_second = each_second
        self._local = threading.local()
        self._numbers = count(1).__next__
        self._free: list[_ThreadPlace] = []
        self._system: _SystemChunk | None = None
        self._live: tuple[tuple[Extent, int], int] | None = None
        self._sync_at = 0
        # When a report must call `look`: at the next second, or at once in simulated time.
        self._look_at = 0
        self._is_node_known = bool(node)
        self._nested = 0
        self.is_simulated = False
        self.look(monotonic_ns())
        self.take: Take = self._taker()

    # --- reports

    def _taker(self) -> Take:
        """The function that takes a report, with all that it needs in local variables."""
        local, whats, pack, steady = self._local, WHATS, pack_report, monotonic_ns
        announced = self._announced

        def take(one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
            try:
                place = local.place
            except AttributeError:
                place = self._new_place()
            try:
                # Read it once: a signal handler may change it at any time.
                chunk = place.chunk
                at = chunk.claim()
                now = steady()
                if at >= chunk.end or one.file is not announced or now >= self._look_at:
                    found = self._prepared(place, one, chunk, at, now)
                    if found is None:
                        return
                    chunk, at = found
                pack(chunk.bytes, at + 4, one.number, now, cmp, thresh)
                chunk.words[at >> 2] = whats[result * 2 + res]
            except BaseException:
                place.fill()
                raise

        return take

    def _prepared(
        self, place: _ThreadPlace, one: Reported, chunk: _Chunk, at: int, now: int
    ) -> tuple[_Chunk, int] | None:
        """Where to write in all but the ordinary case; None where there is no space."""
        if now >= self._sync_at:
            self.look(now)
            self._each_second()
        if one.file is not self._announced:
            self.announce(one)
        found = (chunk, at) if at < chunk.end else self._claimed(place)
        if found is not None and (self.is_simulated or place.sim_ns != -1):
            return self._simulated(place, found, now)
        return found

    def _claimed(self, place: _ThreadPlace) -> tuple[_Chunk, int] | None:
        """The next record of the calling thread, in a new chunk if its own is full."""
        while True:
            chunk = place.chunk
            at = chunk.claim()
            if at < chunk.end:
                return chunk, at
            if place.is_changing:
                # A signal handler reports while the chunk changes.
                self._nested += 1
                return None
            if not self._next_chunk(place, chunk):
                return None

    def _simulated(
        self, place: _ThreadPlace, found: tuple[_Chunk, int], now: int
    ) -> tuple[_Chunk, int] | None:
        """Write the simulated time if it has changed; return the record after it."""
        chunk, at = found
        sim_ns = ros_state.now().ros_ns if self.is_simulated else -1
        if sim_ns == place.sim_ns:
            return found
        pack_integers(chunk.bytes, at + 4, 0, now, sim_ns, 0)
        chunk.words[at >> 2] = SIMULATED
        place.sim_ns = sim_ns
        return self._claimed(place)

    def edge(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """A report of the policy ``edges``."""
        place = self._place()
        now = monotonic_ns()
        try:
            chunk = place.chunk
            found = self._prepared(place, one, chunk, chunk.claim(), now)
            if found is not None:
                chunk, at = found
                pack_report(chunk.bytes, at + 4, one.number, now, cmp, thresh)
                chunk.words[at >> 2] = WHATS[result * 2 + res] | EDGE_BIT
        except BaseException:
            place.fill()
            raise

    # --- threads and chunks

    def _new_place(self) -> _ThreadPlace:
        """The calling thread's place: a new one, or that of a thread that has ended."""
        try:
            place = self._free.pop()
        except IndexError:
            place = _ThreadPlace(self._numbers())
        self._local.owner = _Owner(place, self._free)
        self._local.place = place
        return place

    def _place(self) -> _ThreadPlace:
        try:
            return self._local.place  # type: ignore[no-any-return]
        except AttributeError:
            return self._new_place()

    def thread_number(self) -> int:
        """The number of the calling thread in this file, from 1."""
        return self._place().number

    def _next_chunk(self, place: _ThreadPlace, full: _Chunk) -> bool:
        place.is_changing = True
        try:
            if place.chunk is not full:
                # A signal handler has changed it just before.
                return True
            written = place.written + (RECORDS_OF_CHUNK if place.chunk.end else 0)
            found = self.new_chunk(THREAD_CHUNK, place.number, written)
            chunk = _NoChunk() if found is None else _Chunk(*found)
            place.former, place.chunk, place.written = place.chunk, chunk, written
        finally:
            place.is_changing = False
        if found is None:
            self._count_lost()
        return found is not None

    # --- the header

    def _set_node(self, name: str) -> None:
        raw = bounded(name, NODE_BYTES)
        self._header[NODE_AT + 1 : NODE_AT + len(raw)] = raw[1:]
        self._header[NODE_AT : NODE_AT + 1] = raw[:1]
        self._is_node_known = True

    # --- system records

    def write(self, what: int, raw: bytes) -> bool:
        """Write a system record; ``raw`` is all of it but ``what``. False where there is no space.

        Its place is taken only when it is written, so that an interrupted record leaves no gap. A
        report in the middle of this, from a signal handler, begins another chunk.
        """
        with self._lock:
            size = -(-(len(raw) + 4) // RECORD_BYTES) * RECORD_BYTES
            chunk = self._system
            # The rest of the old chunk counts as used.
            if chunk is None or chunk.is_busy or chunk.at + size > chunk.end:
                first = 0 if chunk is None else chunk.first + RECORDS_OF_CHUNK
                found = self.new_chunk(SYSTEM_CHUNK, 0, first)
                if found is None:
                    return False
                chunk = self._system = _SystemChunk(*found, first)
            chunk.is_busy = True
            try:
                at = chunk.at
                chunk.extent.bytes[at + 4 : at + 4 + len(raw)] = raw
                chunk.extent.words[at >> 2] = what
                chunk.at += size
            finally:
                chunk.is_busy = False
        return True

    def _integers(self, what: int, site: int, now: int, first: int, second: int) -> None:
        self.write(what, _INTEGERS.pack(site, now, first, second))

    def new_slot(self) -> LiveSlot | None:
        """A place for a live summary; None where there is no space."""
        with self._lock:
            if self._live is None or self._live[1] == SLOTS_OF_CHUNK:
                found = self.new_chunk(LIVE_CHUNK, self.thread_number(), 0)
                if found is None:
                    return None
                self._live = (found, 0)
            (extent, begin), used = self._live
            self._live = ((extent, begin), used + 1)
            at = begin + CHUNK_HEADER_BYTES + used * SLOT_BYTES
            return LiveSlot(extent.bytes, extent.words, at)

    def announce(self, one: Reported) -> None:
        """Record once which key a number stands for."""
        with self._lock:
            if one.file is self._announced:
                return
            raw = one.key.encode("utf-8")[:LONGEST_KEY]
            if self.write(SITE, struct.pack("<Iq", one.number, len(raw)) + raw):
                one.file = self._announced
            if one.node:
                raw = f"{one.key},node:{one.node}".encode()[:LONGEST_KEY]
                self.write(NAME, struct.pack("<Iq", one.number, len(raw)) + raw)

    def look(self, now: int) -> None:
        """Once a second, record how the clocks relate, and the node's state in ROS."""
        with self._lock:
            if now < self._sync_at:
                return
            self._sync_at = now + SECOND
            known = ros_state.now()
            self.is_simulated = known.is_simulated
            self._look_at = 0 if self.is_simulated else self._sync_at
            if known.node and not self._is_node_known:
                self._set_node(known.node)
            self._write_nested()
            # Of four readings the one that was interrupted least.
            _, steady, real = min(_both_clocks() for _ in range(4))
            self._integers(SYNC, 0, steady, real, known.ros_ns)

    def look_again(self) -> None:
        """Look at once: the program has just made its node."""
        with self._lock:
            self._sync_at = 0
            self.look(monotonic_ns())

    def _write_nested(self) -> None:
        nested, self._nested = self._nested, 0
        if nested:
            self.write_dropped(0, nested, 0, "nested")

    def close(self) -> None:
        """Write what is left, and give back unused space."""
        self._write_nested()
        super().close()

    def write_policy(self, config: Config) -> None:
        """Record that this policy applies from now on."""
        code = ("every", "edges", "light").index(config.policy)
        self._integers(POLICY, code, monotonic_ns(), config.period_ns, 0)

    def write_dropped(self, one: int, number: int, flops: int, why: str) -> None:
        """Record that reports of a comparison (0: unknown) were dropped."""
        self._integers(DROPPED | REASONS[why] << 16, one, monotonic_ns(), number, flops)
