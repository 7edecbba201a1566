"""The sink ``file``, except for the shortest way of a report, which is in `LogFile`."""

from __future__ import annotations

import struct
from time import monotonic_ns
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime.log_layout import OUTCOME_BIT, RESULT_BIT, SUMMARY
from pytpc.python_runtime.sinks import PeriodSummary, Sink

if TYPE_CHECKING:
    from pytpc.python_runtime.log_file import LogFile
    from pytpc.python_runtime.sites import Reported

# A summary without its first word, up to its two spare words.
_SUMMARY = struct.Struct("<IqddqIIQQQddddddQqq16x")
_COUNT_AT, _BEGUN_AT = 48, 160


def packed(kept: PeriodSummary, *, is_open: bool = False) -> bytes:
    """A summary as it is in the file, except its first word."""
    return _SUMMARY.pack(
        kept.one.number,
        kept.begin_ns,
        kept.cmp,
        kept.thresh,
        0 if is_open else kept.end_ns,
        kept.period,
        kept.thread,
        kept.evaluations,
        kept.odd,
        kept.far,
        kept.least,
        kept.largest,
        kept.total,
        kept.absolute,
        kept.low,
        kept.high,
        kept.flops,
        kept.begin_ros_ns,
        0 if is_open else kept.end_ros_ns,
    )


def what_of(kept: PeriodSummary) -> int:
    """The first word."""
    return SUMMARY | (RESULT_BIT if kept.result else 0) | (OUTCOME_BIT if kept.res else 0)


class FileSink(Sink):
    """Writes all but reports under ``every``, which go to the file's own `LogFile.take`."""

    def __init__(self, file: LogFile) -> None:
        self.file = file
        self.take = file.take  # type: ignore[method-assign,assignment]
        self.edge = file.edge  # type: ignore[method-assign]

    def summary(self, summary: PeriodSummary) -> None:
        """Write it among the system's records."""
        self.file.announce(summary.one)
        self.file.write_summary(packed(summary), what_of(summary))

    def dropped(self, one: Reported | None, count: int, flops: int, why: str) -> None:
        """Write the account."""
        if one is not None:
            self.file.announce(one)
        self.file.write_dropped(0 if one is None else one.number, count, flops, why)

    def status(self) -> str:
        """Its path, and whether it still takes reports."""
        return f"state={'stopped' if self.file.is_stopped else 'open'} file={self.file.path}"

    def end(self) -> None:
        """A last look at the clocks, and the end of the file."""
        self.file.look(monotonic_ns())
        self.file.close()


class LiveSlot:
    """Where the summary of an open period is kept up to date, so that a killed process loses none.

    ``begun`` counts up before an evaluation is taken in, ``count`` with it, in one piece: a reader
    leaves out a summary whose counts contradict one another.
    """

    __slots__ = ("_at", "_bytes", "_file", "_words")

    def __init__(self, file: LogFile) -> None:
        """Take a slot; without room in the file nothing is kept up to date."""
        found = file.new_slot()
        self._file = file
        self._bytes: Any = None
        self._words: Any = None
        self._at = 0
        if found is not None:
            self._bytes, self._words, self._at = found

    def begin(self) -> None:
        """Begin a period."""
        if self._bytes is not None:
            struct.pack_into("<Q", self._bytes, self._at + _COUNT_AT, 0)
            struct.pack_into("<Q", self._bytes, self._at + _BEGUN_AT, 0)

    def write(self, kept: PeriodSummary) -> None:
        """The summary with one more evaluation; its end is open."""
        if self._bytes is None:
            return
        at = self._at
        struct.pack_into("<Q", self._bytes, at + _BEGUN_AT, kept.evaluations)
        self._words[at >> 2] = what_of(kept)
        raw = packed(kept, is_open=True)
        self._bytes[at + 4 : at + 4 + len(raw)] = raw
