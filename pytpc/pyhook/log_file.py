"""The binary file of reports (docs/formats.md), written straight into mapped memory.

The kernel keeps what was written whatever happens to the process. Space is allocated on the disk
before it is mapped, so that a full disk is an error and no signal. Each thread has chunks of its
own; a place in one is claimed by one call of C, so that a signal's handler, or a finaliser, that
reports in the middle of a report gets another place. ``what`` of a record is written last.
"""

from __future__ import annotations

import _thread
import contextlib
import mmap
import os
import socket
import struct
import threading
from collections.abc import Callable
from itertools import count
from time import monotonic_ns, time_ns
from typing import TYPE_CHECKING, Any

from pytpc.pyhook import ros_state
from pytpc.pyhook.config import Config
from pytpc.pyhook.log_layout import (
    CHUNK,
    CHUNK_BYTES,
    CHUNK_HEADER_BYTES,
    CLOSED,
    DROPPED,
    EDGE_BIT,
    HEADER,
    HEADER_BYTES,
    LIVE_CHUNK,
    LONGEST_KEY,
    LOST_AT,
    MAGIC,
    NODE_AT,
    NODE_BYTES,
    OPEN,
    POLICY,
    REASONS,
    RECORD_BYTES,
    RECORDS_OF_CHUNK,
    SECOND,
    SIMULATED,
    SITE,
    SLOT_BYTES,
    SLOTS_OF_CHUNK,
    STATE_AT,
    STOPPED,
    SYNC,
    SYSTEM_CHUNK,
    THREAD_CHUNK,
    WHATS,
    bounded,
    created,
    pack_integers,
    pack_report,
    program,
)
from pytpc.pyhook.words import warn

if TYPE_CHECKING:
    from pytpc.pyhook.sites import Reported, Take

_EXTENT_BYTES = 1 << 20
# Mappings are never given back, because other threads may write to them, and each takes a
# descriptor: they grow, so that 4 GiB are some 70 of them.
_LARGEST_EXTENT = 64 << 20


class _Extent:
    """A mapped part of the file, as bytes and as words of 32 bits."""

    __slots__ = ("base", "bytes", "chunks", "words")

    def __init__(self, mapped: mmap.mmap, size: int) -> None:
        self.bytes = mapped
        self.words = memoryview(mapped).cast("I")
        self.chunks = size // CHUNK_BYTES


class _Place:
    """Where a thread writes. ``claim()`` gives the byte of a record; it may be behind ``end``."""

    __slots__ = ("bytes", "claim", "end", "number", "sim_ns", "words", "written")

    def __init__(self, number: int) -> None:
        self.number = number
        self.written = 0
        self.sim_ns = -1
        self.end = 0
        self.claim: Callable[[], int] = count().__next__
        self.bytes: Any = None
        self.words: Any = None


class _SystemChunk:
    """Where records of the system are written: in ``extent`` from byte ``at`` to ``end``."""

    __slots__ = ("at", "end", "extent", "first")

    def __init__(self, extent: _Extent, begin: int, first: int) -> None:
        self.extent = extent
        self.at = begin + CHUNK_HEADER_BYTES
        self.end = begin + CHUNK_BYTES
        self.first = first


class _Owner:
    """A thread's hold on its place: when the thread ends, the next one takes it over."""

    __slots__ = ("_free", "_place")

    def __init__(self, place: _Place, free: list[_Place]) -> None:
        self._place = place
        self._free = free

    def __del__(self) -> None:
        self._free.append(self._place)


class LogFile:
    """One file. Errors while it is written stop the recording, and never the program."""

    def __init__(self, config: Config, parent: int, each_second: Callable[[], None]) -> None:
        """Make the file in its folder.

        Raises:
            OSError: it cannot be made.
        """
        self._limit = config.file_limit << 20
        self._reserve = config.file_reserve << 20
        self._each_second = each_second
        self._lock = threading.RLock()
        self._local = threading.local()
        self._extents: list[_Extent] = []
        self._size = HEADER_BYTES
        self._used = 0
        self._threads = 0
        self._free: list[_Place] = []
        self._system: _SystemChunk | None = None
        self._live: tuple[tuple[_Extent, int], int] | None = None
        self._sync_at = 0
        # When a report has to look about: at the next second, or at once in simulated time.
        self._look_at = 0
        self._is_stopped = False
        self._is_closed = False
        self._is_node_known = False
        self.is_simulated = False
        self.path, self._descriptor = created(config, ros_state.now().node)
        its = os.fstat(self._descriptor)
        self._identity = (its.st_dev, its.st_ino)
        try:
            self._begin(parent)
            os.rename(f"{self.path}.new", self.path)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(f"{self.path}.new")
            os.close(self._descriptor)
            raise
        self.take: Take = self._taker()

    # --- reports

    def _taker(self) -> Take:
        """What takes a report, with all that it needs at hand."""
        local, whats, pack, steady = self._local, WHATS, pack_report, monotonic_ns

        def take(one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
            try:
                place = local.place
            except AttributeError:
                place = self._new_place()
            at = place.claim()
            now = steady()
            try:
                if at >= place.end or one.file is not self or now >= self._look_at:
                    at = self._prepared(place, one, at, now)
                    if at < 0:
                        return
                pack(place.bytes, at + 4, one.number, now, cmp, thresh)
                place.words[at >> 2] = whats[result * 2 + res]
            except BaseException:
                # A place that stays empty would hide all that follow: Ctrl-C may come at any time.
                if CHUNK_HEADER_BYTES <= at < place.end and one.file is self:
                    pack(place.bytes, at + 4, one.number, now, cmp, thresh)
                    place.words[at >> 2] = whats[result * 2 + res]
                raise

        return take

    def _prepared(self, place: _Place, one: Reported, at: int, now: int) -> int:
        """A place for a report where something stands in the way; -1 where there is none."""
        if now >= self._sync_at:
            self.look(now)
            self._each_second()
        if one.file is not self:
            self._announce(one)
        while at >= place.end:
            if not self._next_chunk(place):
                return -1
            at = place.claim()
        if self.is_simulated or place.sim_ns != -1:
            return self._simulated(place, at, now)
        return at

    def _simulated(self, place: _Place, at: int, now: int) -> int:
        """Write the simulated time where it has changed; the place behind it."""
        sim_ns = ros_state.now().ros_ns if self.is_simulated else -1
        if sim_ns == place.sim_ns:
            return at
        place.sim_ns = sim_ns
        pack_integers(place.bytes, at + 4, 0, now, sim_ns, 0)
        place.words[at >> 2] = SIMULATED
        at = place.claim()
        while at >= place.end:
            if not self._next_chunk(place):
                return -1
            at = place.claim()
        return at

    def edge(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """A report of the policy ``edges``."""
        place = self._place()
        now = monotonic_ns()
        at = self._prepared(place, one, place.claim(), now)
        if at >= 0:
            pack_report(place.bytes, at + 4, one.number, now, cmp, thresh)
            place.words[at >> 2] = WHATS[result * 2 + res] | EDGE_BIT

    # --- threads and chunks

    def _new_place(self) -> _Place:
        """The calling thread's place: a new one, or that of a thread that has ended."""
        try:
            place = self._free.pop()
        except IndexError:
            with self._lock:
                self._threads += 1
                place = _Place(self._threads)
        self._local.owner = _Owner(place, self._free)
        self._local.place = place
        return place

    def _place(self) -> _Place:
        try:
            return self._local.place  # type: ignore[no-any-return]
        except AttributeError:
            return self._new_place()

    def thread_number(self) -> int:
        """The number of the calling thread in this file, from 1."""
        return self._place().number

    def _next_chunk(self, place: _Place) -> bool:
        if place.end:
            place.written += RECORDS_OF_CHUNK
        found = self.new_chunk(THREAD_CHUNK, place.number, place.written)
        if found is None:
            place.end = 0
            self._count_lost()
            return False
        extent, begin = found
        place.bytes, place.words = extent.bytes, extent.words
        place.claim = count(begin + CHUNK_HEADER_BYTES, RECORD_BYTES).__next__
        place.end = begin + CHUNK_BYTES
        return True

    def new_chunk(self, kind: int, thread: int, first: int) -> tuple[_Extent, int] | None:
        """A chunk, and its first byte in its extent; None where there is no room."""
        with self._lock:
            if self._is_stopped or self._is_closed:
                return None
            before = sum(extent.chunks for extent in self._extents)
            if self._used == before:
                try:
                    self._grow()
                except OSError as error:
                    self._stop(error.strerror or str(error))
                    return None
                before = sum(extent.chunks for extent in self._extents[:-1])
            else:
                before -= self._extents[-1].chunks
            extent = self._extents[-1]
            begin = (self._used - before) * CHUNK_BYTES
            self._used += 1
            CHUNK.pack_into(extent.bytes, begin + 4, thread, first, _thread.get_native_id())
            extent.words[begin >> 2] = kind
            return extent, begin

    def _grow(self) -> None:
        if not self._is_mine():
            raise OSError(0, "the program has closed its descriptor")
        size = min(_LARGEST_EXTENT, max(_EXTENT_BYTES, self._size - HEADER_BYTES))
        end = self._size + size
        if self._limit and end > self._limit:
            size = _EXTENT_BYTES
            end = self._size + size
            if end > self._limit:
                what = f"its limit of {self._limit >> 20} MiB (TPC_FILE_LIMIT) is reached"
                raise OSError(0, what)
        disk = os.fstatvfs(self._descriptor)
        if self._reserve and disk.f_bavail * disk.f_frsize < self._reserve + size:
            what = f"the disk has less than {self._reserve >> 20} MiB left (TPC_FILE_RESERVE)"
            raise OSError(0, what)
        os.posix_fallocate(self._descriptor, self._size, size)
        self._extents.append(_Extent(mmap.mmap(self._descriptor, size, offset=self._size), size))
        self._size = end

    def _is_mine(self) -> bool:
        """A program that closes all descriptors may have opened a file of its own in its place."""
        try:
            its = os.fstat(self._descriptor)
        except OSError:
            return False
        return (its.st_dev, its.st_ino) == self._identity

    def _stop(self, why: str) -> None:
        if not self._is_stopped:
            self._is_stopped = True
            self._put_state(STOPPED)
            warn(f"{self.path}: {why}; nothing more is recorded, the program goes on as if it were")

    @property
    def is_stopped(self) -> bool:
        """Whether the disk is full, or a limit reached."""
        return self._is_stopped

    def close(self) -> None:
        """Give back what was not used. Threads may write on in the chunks that they have."""
        with self._lock:
            if self._is_closed:
                return
            self._is_closed = True
            if self._is_mine():
                with contextlib.suppress(OSError):
                    os.ftruncate(self._descriptor, HEADER_BYTES + self._used * CHUNK_BYTES)
                os.close(self._descriptor)
            if not self._is_stopped:
                self._put_state(CLOSED)

    # --- the header

    def _begin(self, parent: int) -> None:
        os.posix_fallocate(self._descriptor, 0, HEADER_BYTES)
        self._header = mmap.mmap(self._descriptor, HEADER_BYTES)
        node = ros_state.now().node
        HEADER.pack_into(
            self._header,
            0,
            b"",
            HEADER_BYTES,
            RECORD_BYTES,
            CHUNK_BYTES,
            os.getpid(),
            monotonic_ns(),
            time_ns(),
            OPEN,
            0,
            0,
            parent,
            0,
            bounded(node, NODE_BYTES),
            bounded(socket.gethostname(), 256),
            bounded(program(), 1024),
        )
        self._header[:8] = MAGIC
        self._is_node_known = bool(node)
        self._grow()
        self.look(monotonic_ns())

    def _put_state(self, state: int) -> None:
        struct.pack_into("<I", self._header, STATE_AT, state)

    def _count_lost(self) -> None:
        with self._lock:
            (lost,) = struct.unpack_from("<Q", self._header, LOST_AT)
            struct.pack_into("<Q", self._header, LOST_AT, lost + 1)

    def _set_node(self, name: str) -> None:
        raw = bounded(name, NODE_BYTES)
        self._header[NODE_AT + 1 : NODE_AT + len(raw)] = raw[1:]
        self._header[NODE_AT : NODE_AT + 1] = raw[:1]
        self._is_node_known = True

    # --- what is of the system

    def _records(self, number: int) -> tuple[_Extent, int] | None:
        """Room for so many records in a row; the lock is held.

        What is left over at the end of a chunk counts as used.
        """
        chunk = self._system
        if chunk is None or chunk.at + number * RECORD_BYTES > chunk.end:
            first = 0 if chunk is None else chunk.first + RECORDS_OF_CHUNK
            found = self.new_chunk(SYSTEM_CHUNK, 0, first)
            if found is None:
                return None
            chunk = self._system = _SystemChunk(*found, first)
        at = chunk.at
        chunk.at += number * RECORD_BYTES
        return chunk.extent, at

    def _integers(self, what: int, site: int, now: int, first: int, second: int) -> None:
        with self._lock:
            found = self._records(1)
            if found is not None:
                extent, at = found
                pack_integers(extent.bytes, at + 4, site, now, first, second)
                extent.words[at >> 2] = what

    def new_slot(self) -> tuple[Any, Any, int] | None:
        """Room for a live summary: the bytes and words of its part of the file, and its place."""
        with self._lock:
            if self._live is None or self._live[1] == SLOTS_OF_CHUNK:
                found = self.new_chunk(LIVE_CHUNK, self.thread_number(), 0)
                if found is None:
                    return None
                self._live = (found, 0)
            (extent, begin), used = self._live
            self._live = ((extent, begin), used + 1)
            at = begin + CHUNK_HEADER_BYTES + used * SLOT_BYTES
            return extent.bytes, extent.words, at

    def _announce(self, one: Reported) -> None:
        with self._lock:
            if one.file is self:
                return
            raw = one.key.encode("utf-8")[:LONGEST_KEY]
            blocks = -(-max(0, len(raw) - 16) // RECORD_BYTES)
            found = self._records(1 + blocks)
            if found is None:
                return
            extent, at = found
            extent.bytes[at + 16 : at + 16 + len(raw)] = raw
            struct.pack_into("<Iq", extent.bytes, at + 4, one.number, len(raw))
            extent.words[at >> 2] = SITE
            one.file = self

    def announce(self, one: Reported) -> None:
        """Say what the number of a key is."""
        if one.file is not self:
            self._announce(one)

    def look(self, now: int) -> None:
        """What is done once a second: the clocks against one another, and what ROS says."""
        with self._lock:
            if now < self._sync_at:
                return
            self._sync_at = now + SECOND
            known = ros_state.now()
            self.is_simulated = known.is_simulated
            self._look_at = 0 if self.is_simulated else self._sync_at
            if known.node and not self._is_node_known:
                self._set_node(known.node)
            before, real, after = monotonic_ns(), time_ns(), monotonic_ns()
            self._integers(SYNC, 0, before + (after - before) // 2, real, known.ros_ns)

    def write_policy(self, config: Config) -> None:
        """From here on this policy holds."""
        self._integers(POLICY, config.policy == "edges", monotonic_ns(), config.period_ns, 0)

    def write_dropped(self, one: int, number: int, flops: int, why: str) -> None:
        """So many reports of a comparison (0: not known which) were dropped."""
        self._integers(DROPPED | REASONS[why] << 16, one, monotonic_ns(), number, flops)

    def write_summary(self, raw: bytes, what: int) -> None:
        """A summary without its first word."""
        with self._lock:
            found = self._records(5)
            if found is not None:
                extent, at = found
                extent.bytes[at + 4 : at + 4 + len(raw)] = raw
                extent.words[at >> 2] = what
