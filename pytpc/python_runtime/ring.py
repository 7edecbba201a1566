"""A ring: the last minutes in several files of one process (docs/reference/runtime.md#the-ring).

Each file is a whole file of reports. A thread of its own begins a new one when the present one has
its share of the minutes or of the budget, and removes the oldest; runtime_log/Ring.h does the same.
"""

from __future__ import annotations

import _thread
import contextlib
import os
from time import monotonic_ns, time_ns
from typing import TYPE_CHECKING, NamedTuple

from pytpc.python_runtime.errors import warn
from pytpc.python_runtime.log_file import LogFile
from pytpc.python_runtime.log_layout import SECOND
from pytpc.python_runtime.mapped_file import SegmentName
from pytpc.python_runtime.sinks import FileSink, PeriodSummary, Sink

if TYPE_CHECKING:
    from collections.abc import Callable

    from pytpc.python_runtime.config import Config
    from pytpc.python_runtime.sites import Reported

SEGMENTS = 8
# When a thread that took the old file just before has certainly left it.
_LEFT_NS = SECOND
_AGAIN_NS = 10 * SECOND
_LONGEST_WAIT_S = 1.0
# A file asks for the next one when half of its last mebibyte is used.
_HALF_BYTES = 1 << 19


class _Former(NamedTuple):
    """A file that was closed; its name may be anybody's by now. ``end_ns`` is in steady time."""

    path: str
    identity: tuple[int, int]
    size: int
    end_ns: int


class Ring:
    """The files of this process. ``poke`` makes the thread look at once."""

    def __init__(self, config: Config) -> None:
        """No file is made yet."""
        self._config = config
        self._name = SegmentName(time_ns() // SECOND)
        self._began_ns = 0
        self._not_before_ns = 0
        self._has_told = False
        self._left: list[tuple[LogFile, int]] = []
        self._closed: list[_Former] = []
        self._is_asked = _thread.allocate_lock()
        self._is_asked.acquire()

    def next(self, now: LogFile | None, make: Callable[[SegmentName], LogFile]) -> LogFile:
        """The next file, by ``make``; removes files until the budget and the disk have room.

        Raises:
            OSError: it cannot be made.
        """
        needed = self._config.segment_bytes + (now.size if now is not None else 0)
        while self._bytes() + needed > self._config.ring_budget << 20 and self._remove_oldest():
            pass
        while True:
            try:
                file = make(self._name)
            except OSError:
                if self._remove_oldest():
                    continue
                raise
            file.on_half = self.poke
            self._began_ns = monotonic_ns()
            return file

    def is_due(self, now: LogFile | None) -> bool:
        """Whether the present file has its share, or has stopped."""
        at = monotonic_ns()
        if at < self._not_before_ns:
            return False
        if now is None or now.is_stopped or at >= self._due_ns():
            return True
        return now.used + _HALF_BYTES >= self._config.segment_bytes

    def rest(self) -> None:
        """Nothing is written: there is nothing to do for a while."""
        self._not_before_ns = monotonic_ns() + SECOND

    def failed(self, error: OSError) -> None:
        """A file could not be begun; says so once."""
        self._not_before_ns = monotonic_ns() + _AGAIN_NS
        if not self._has_told:
            place = error.filename or self._config.folder
            why = error.strerror or error
            warn(f"{place}: {why}; the ring stops until a file can be written")
        self._has_told = True

    def turned(self, old: LogFile | None) -> None:
        """Another file is written from now on."""
        self._has_told = False
        if old is not None:
            self._left.append((old, monotonic_ns()))

    def settle(self) -> None:
        """Close what nobody writes any more, and remove what is older than the minutes."""
        now = monotonic_ns()
        while self._left and now >= self._left[0][1] + _LEFT_NS:
            self._close(*self._left.pop(0))
        while self._closed and self._closed[0].end_ns + self._config.ring_ns < now:
            self._remove_oldest()

    def end(self) -> None:
        """The process ends."""
        while self._left:
            self._close(*self._left.pop(0))

    def wait(self) -> None:
        """Wait until there may be something to do."""
        until = max(self._due_ns(), self._not_before_ns)
        left_s = max(0.01, (until - monotonic_ns()) / SECOND)
        self._is_asked.acquire(timeout=min(left_s, _LONGEST_WAIT_S))

    def poke(self) -> None:
        """End the waiting."""
        with contextlib.suppress(RuntimeError):
            self._is_asked.release()

    def status(self, now: LogFile | None) -> str:
        """Its minutes, files, bytes and folder, for people."""
        config = self._config
        size = self._bytes() + (now.size if now is not None else 0)
        mib = -(-size >> 20)
        files = len(self._closed) + len(self._left) + (now is not None)
        is_open = now is not None and not now.is_stopped
        folder = os.path.dirname(now.path) if now is not None else config.folder
        return (
            f"ring={config.ring_ns / 60e9:g} ring_files={files} ring_mib={mib}/{config.ring_budget}"
            f" ring_state={'open' if is_open else 'stopped'} ring_folder={folder}"
        )

    def _due_ns(self) -> int:
        return self._began_ns + self._config.ring_ns // SEGMENTS

    def _bytes(self) -> int:
        return sum(one.size for one in self._closed) + sum(file.size for file, _ in self._left)

    def _close(self, file: LogFile, end_ns: int) -> None:
        file.close()
        with contextlib.suppress(OSError):
            its = os.lstat(file.path)
            if (its.st_dev, its.st_ino) == file.identity:
                self._closed.append(_Former(file.path, file.identity, its.st_size, end_ns))
        # Its function refers to it: without this, its memory would stay until a collection.
        file.take = _nothing

    def _remove_oldest(self) -> bool:
        """Remove a file's name if it is still that file's."""
        if not self._closed and self._left:
            self._close(*self._left.pop(0))
        if not self._closed:
            return False
        oldest = self._closed.pop(0)
        with contextlib.suppress(OSError):
            its = os.lstat(oldest.path)
            # The number of a file that somebody removed may be another's by now.
            if (its.st_dev, its.st_ino, its.st_size) == (*oldest.identity, oldest.size):
                os.unlink(oldest.path)
        return True


def _nothing(_one: Reported, _result: bool, _cmp: float, _thresh: float, _res: bool) -> None:
    """Takes no report: the file is closed."""


class Statements:
    """What each file of a ring says first of a comparison: the outcome that readers know.

    The files before it may be gone. If the first evaluation in a file is a flop, what was last
    reported before it is written again.
    """

    def __init__(self, ring: FileSink) -> None:
        """``ring`` writes the present file."""
        self._ring = ring
        self._stated: set[Reported] = set()
        self._told: dict[Reported, tuple[bool, float, float, bool]] = {}

    def begin(self) -> None:
        """A new file is written."""
        self._stated = set()

    def told(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """This was reported, also to the file."""
        self._told[one] = (result, cmp, thresh, res)
        self._stated.add(one)

    def again(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """An evaluation, before it is reported, if it is."""
        if one in self._stated or one.last < 0:
            return
        told = self._told.get(one)
        if one.last == result and (told is None or told[0] == result):
            told = result, cmp, thresh, res
        if told is not None:
            self._ring.edge(one, *told)
            self._told[one] = told
        self._stated.add(one)


class BesideSink(Sink):
    """A sink, and the ring beside it: both take everything."""

    def __init__(self, chosen: Sink, ring: FileSink) -> None:
        super().__init__()
        self._chosen = chosen
        self.ring = ring

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """One evaluation."""
        self.ring.take(one, result, cmp, thresh, res)
        self._chosen.take(one, result, cmp, thresh, res)

    def edge(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """A flop, or the first evaluation."""
        self.ring.edge(one, result, cmp, thresh, res)
        self._chosen.edge(one, result, cmp, thresh, res)

    def summary(self, summary: PeriodSummary) -> None:
        """A period that is over."""
        self.ring.summary(summary)
        self._chosen.summary(summary)

    def dropped(self, one: Reported, count: int, flops: int, why: str) -> None:
        """Reports that were dropped since the last call."""
        self.ring.dropped(one, count, flops, why)
        self._chosen.dropped(one, count, flops, why)

    def settle(self) -> None:
        """Send what was kept while the hook held a lock."""
        self._chosen.settle()
