"""What sinks take, their lines of text (docs/reference/formats.md#reports), and the sink ``file``.

The fastest way of a report to a file is in `pytpc.python_runtime.log_file`.
"""

from __future__ import annotations

import struct
from math import inf, isfinite, nan
from time import monotonic_ns
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime.log_layout import OUTCOME_BIT, RESULT_BIT, SUMMARY

if TYPE_CHECKING:
    from collections.abc import Callable

    from pytpc.python_runtime.log_file import LogFile
    from pytpc.python_runtime.sites import Reported

# A summary without its first word, up to its last.
_SUMMARY = struct.Struct("<IqddqIIQQQddddddQqqQ8x")
_COUNT_AT, _BEGUN_AT = 48, 160

# |cmp - thresh| above which an evaluation is far (docs/reference/scores.md#score-of-type-ii).
_FAR = 1e-4


class PeriodSummary:
    """A summary of all evaluations of one comparison in one thread and period. Times in ns."""

    __slots__ = (
        "absolute",
        "begin_ns",
        "begin_ros_ns",
        "cmp",
        "end_ns",
        "end_ros_ns",
        "evaluations",
        "far",
        "flops",
        "high",
        "largest",
        "least",
        "low",
        "odd",
        "one",
        "period",
        "res",
        "result",
        "slot",
        "thread",
        "thresh",
        "total",
    )

    def __init__(self, one: Reported, thread: int, slot: LiveSlot | None = None) -> None:
        """``slot``: where it is kept up to date in a file."""
        self.one = one
        self.thread = thread
        self.slot = slot
        self.result = self.res = False
        self.cmp = self.thresh = 0.0
        self.begin(0, 0, 0)

    @property
    def seen(self) -> int:
        """Under ``light``: how many of the evaluations were inspected."""
        return 0

    def begin(self, period: int, now_ns: int, ros_ns: int) -> None:
        """A new period, in which nothing was evaluated yet; the last values stay."""
        self.period = period
        self.evaluations = self.odd = self.far = self.flops = 0
        self.least = self.low = inf
        self.largest = self.high = -inf
        self.total = self.absolute = 0.0
        self.begin_ns = self.end_ns = now_ns
        self.begin_ros_ns = self.end_ros_ns = ros_ns

    def add(self, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """One evaluation."""
        self.evaluations += 1
        self.result, self.res, self.cmp, self.thresh = result, res, cmp, thresh
        diff = cmp - thresh
        if not isfinite(diff):
            self.odd += 1
            return
        size = abs(diff)
        self.far += size > _FAR
        self.total += diff
        self.absolute += size
        self.least = min(self.least, diff)
        self.largest = max(self.largest, diff)
        self.low = min(self.low, cmp, thresh)
        self.high = max(self.high, cmp, thresh)


def _nothing() -> None:
    """Flush nothing."""


class Sink:
    """A destination of reports. This one drops them; subclasses replace what they need."""

    # Whether the helper thread calls `poll`.
    is_polled = False
    # Whether the process ends.
    is_last = False
    poll_s = 0.02

    def __init__(self) -> None:
        """``flush`` makes the policy hand over what it keeps."""
        self.flush: Callable[[], None] = _nothing

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """One evaluation."""

    def edge(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """A flop, or the first evaluation, under the policy ``edges``."""
        self.take(one, result, cmp, thresh, res)

    def summary(self, summary: PeriodSummary) -> None:
        """A period that is over."""

    def dropped(self, one: Reported, count: int, flops: int, why: str) -> None:
        """Reports that were dropped since the last call."""

    def settle(self) -> None:
        """Send what was kept while the hook held a lock: now it may run code of the program."""

    def poll(self) -> None:
        """Called by the helper thread some fifty times a second."""

    def wants_to_send(self) -> bool:
        """Whether something waits for a subscriber, who may be there."""
        return False

    def status(self) -> str:
        """Information for people: words with ``=`` in them."""
        return ""

    def finish(self) -> None:
        """The process ends: send what waits, where that is sent over ROS 2."""

    def end(self) -> None:
        """The process ends."""


def number(value: float) -> str:
    """The shortest text that reads back as the same double, like C++ writes it."""
    text = repr(value)
    return text[:-2] if text.endswith(".0") else text


def report_line(one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> str:
    """``KEY,RESULT,cmp:C,thresh:T,res:R`` with the outcomes as Python writes them."""
    return f"{one.key},{bool(result)},cmp:{number(cmp)},thresh:{number(thresh)},res:{bool(res)}"


def seconds(ns: int, decimals: int) -> str:
    """A time in seconds with this many decimals, truncated."""
    sign = "-" if ns < 0 else ""
    whole, rest = divmod(abs(ns), 1_000_000_000)
    return f"{sign}{whole}.{rest:09d}"[: len(sign) + len(str(whole)) + 1 + decimals]


def summary_line(kept: PeriodSummary) -> str:
    """A line like `report_line`'s, with count, flops and statistics."""
    usable = kept.evaluations - kept.odd
    numbers = (kept.least, kept.largest, kept.total, kept.absolute, kept.low, kept.high)
    least, largest, total, absolute, low, high = numbers if usable else (nan,) * 6
    means = [number(x / max(usable, 1)) for x in (total, absolute)]
    return (
        f"{report_line(kept.one, kept.result, kept.cmp, kept.thresh, kept.res)}"
        f",count:{kept.evaluations},flops:{kept.flops}"
        f",diff:{number(least)};{number(largest)};{means[0]},abs:{means[1]}"
        f",range:{number(low)};{number(high)},far:{kept.far},odd:{kept.odd}"
        f",span:{seconds(kept.begin_ros_ns, 9)};{seconds(kept.end_ros_ns, 9)}"
    )


def dropped_line(one: Reported, count: int, flops: int, why: str) -> str:
    """``KEY,count:N,flops:F,why:W``."""
    return f"{one.key},count:{count},flops:{flops},why:{why}"


def _packed(kept: PeriodSummary, *, is_open: bool = False) -> bytes:
    """A summary as the file has it, without its first word."""
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
        kept.seen,
    )


def _what_of(kept: PeriodSummary) -> int:
    """The first word of a summary."""
    return SUMMARY | (RESULT_BIT if kept.result else 0) | (OUTCOME_BIT if kept.res else 0)


class FileSink(Sink):
    """Writes all but the reports of ``every``, which `LogFile.take` writes."""

    def __init__(self, file: LogFile) -> None:
        super().__init__()
        self.go_on_in(file)

    def go_on_in(self, file: LogFile) -> None:
        """Write another file from now on."""
        self.file = file
        self.take = file.take  # type: ignore[method-assign,assignment]
        self.edge = file.edge  # type: ignore[method-assign]

    def summary(self, summary: PeriodSummary) -> None:
        """Write it as a system record."""
        self.file.announce(summary.one)
        self.file.write(_what_of(summary), _packed(summary))

    def dropped(self, one: Reported, count: int, flops: int, why: str) -> None:
        """Write a record of it."""
        self.file.announce(one)
        self.file.write_dropped(one.number, count, flops, why)

    def status(self) -> str:
        """Its path, and whether it still takes reports."""
        return f"state={'stopped' if self.file.is_stopped else 'open'} file={self.file.path}"

    def end(self) -> None:
        """Record the clocks a last time, and close the file."""
        self.file.look(monotonic_ns())
        self.file.close()


class LiveSlot:
    """Keeps the summary of an open period up to date in the file: a killed process loses none.

    ``begun`` counts up before an evaluation is written, and ``count`` with it, in one piece. A
    reader ignores a summary whose two counts differ.
    """

    __slots__ = ("_at", "_bytes", "_words")

    def __init__(self, mapped: Any, words: Any, at: int) -> None:  # noqa: ANN401
        """The slot at the byte ``at`` of a part of the file, as its bytes and as its words."""
        self._bytes = mapped
        self._words = words
        self._at = at

    def begin(self) -> None:
        """Begin a period."""
        struct.pack_into("<Q", self._bytes, self._at + _COUNT_AT, 0)
        struct.pack_into("<Q", self._bytes, self._at + _BEGUN_AT, 0)

    def write(self, kept: PeriodSummary) -> None:
        """Write the summary, with one more evaluation; its end is open."""
        at = self._at
        struct.pack_into("<Q", self._bytes, at + _BEGUN_AT, kept.evaluations)
        self._words[at >> 2] = _what_of(kept)
        raw = _packed(kept, is_open=True)
        self._bytes[at + 4 : at + 4 + len(raw)] = raw
