"""Reports that wait until they are sent over ROS, and the texts of batches.

docs/reference/formats.md#batches describes them.
"""

from __future__ import annotations

import os
import threading
from collections import deque
from time import monotonic_ns
from typing import TYPE_CHECKING, NamedTuple

from pytpc.python_runtime import ros_state
from pytpc.python_runtime.light import LightSummary, short_line
from pytpc.python_runtime.sinks import (
    PeriodSummary,
    Sink,
    dropped_line,
    report_line,
    seconds,
    summary_line,
)

if TYPE_CHECKING:
    from pytpc.python_runtime.sites import Reported

TOPIC = "/threshold_information"
BATCH_NS = 190_000_000
_MOST_WAITING = 65536
_MESSAGE_BYTES = 64 * 1024


class Waiting(NamedTuple):
    """A line to send: an unformatted report, or a finished line. ``at_ns`` is ROS time."""

    at_ns: int
    one: Reported | None
    report: tuple[bool, float, float, bool] | None
    line: str


class WaitingSink(Sink):
    """Keeps the newest lines; subclasses send them from the helper thread."""

    # Subscribers come and go.
    is_polled = True

    def __init__(self) -> None:
        super().__init__()
        self._waiting: deque[Waiting] = deque()
        self._lock = threading.RLock()
        self._oldest_at = 0
        self._sent = 0
        self._evicted: dict[Reported, list[int]] = {}
        self._last_evicted: dict[Reported, bool] = {}
        self._dropped_in_all = 0

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """Keep it until the next batch."""
        self._keep(Waiting(ros_state.time_now_ns(), one, (result, cmp, thresh, res), ""))

    def summary(self, summary: PeriodSummary) -> None:
        """Keep it until the next batch."""
        if isinstance(summary, LightSummary):
            self._short(summary)
            return
        line = f"threshold_summary:{summary_line(summary)}"
        self._keep(Waiting(summary.end_ros_ns, None, None, line))

    def _short(self, summary: LightSummary) -> None:
        begin, end = seconds(summary.begin_ros_ns, 7), seconds(summary.end_ros_ns, 7)
        line = f"{begin};{end}\n{short_line(summary)}"
        self._keep(Waiting(summary.end_ros_ns, None, None, line))

    def dropped(self, one: Reported, count: int, flops: int, why: str) -> None:
        """Keep it until the next batch."""
        line = f"threshold_dropped:{dropped_line(one, count, flops, why)}"
        self._dropped_in_all += count
        self._keep(Waiting(ros_state.time_now_ns(), None, None, line))

    def _keep(self, waiting: Waiting) -> None:
        with self._lock:
            if not self._waiting:
                self._oldest_at = monotonic_ns()
            self._waiting.append(waiting)
            if len(self._waiting) > _MOST_WAITING:
                self._evict(self._waiting.popleft())

    def _evict(self, oldest: Waiting) -> None:
        """Count, for its comparison, a report that was dropped to make space."""
        if oldest.one is None or oldest.report is None:
            return
        counts = self._evicted.setdefault(oldest.one, [0, 0])
        last = self._last_evicted.get(oldest.one)
        self._last_evicted[oldest.one] = oldest.report[0]
        counts[0] += 1
        counts[1] += last is not None and last != oldest.report[0]
        self._dropped_in_all += 1

    def _take_all(self) -> tuple[deque[Waiting], int]:
        """What waits, with what had to make room for it; and the number of dropped reports."""
        with self._lock:
            batch, self._waiting = self._waiting, deque()
            evicted, self._evicted = self._evicted, {}
            dropped = self._dropped_in_all
        at_ns = ros_state.time_now_ns()
        for one, (count, flops) in evicted.items():
            line = f"threshold_dropped:{dropped_line(one, count, flops, 'process')}"
            batch.append(Waiting(at_ns, None, None, line))
        return batch, dropped

    def _messages_of(
        self, batch: deque[Waiting], dropped: int, more: str = ""
    ) -> list[tuple[str, int]]:
        """The texts of a batch, numbered from the first report that was not sent yet.

        With each the number of reports in it. ``more`` ends their first lines.
        """
        texts = []
        for reports, text in _messages(batch):
            head = (
                f"#seq:{self._sent},count:{reports},dropped:{dropped},pid:{os.getpid()}"
                f",steady:{seconds(monotonic_ns(), 9)}{more}"
            )
            self._sent += reports
            texts.append((head + text, reports))
        return texts

    def drain(self) -> list[Waiting]:
        """What waits; nothing waits any more."""
        with self._lock:
            waiting, self._waiting = self._waiting, deque()
        return list(waiting)

    def take_over(self, former: WaitingSink) -> None:
        """What waits there waits here from now on."""
        with self._lock, former._lock:
            self._waiting.extendleft(reversed(former.drain()))
            self._evicted, former._evicted = former._evicted, {}
            self._last_evicted = former._last_evicted
            self._dropped_in_all += former._dropped_in_all
            self._oldest_at = former._oldest_at


def line_of(waiting: Waiting) -> str:
    """Its line, without the time."""
    if waiting.one is not None and waiting.report is not None:
        return report_line(waiting.one, *waiting.report)
    return waiting.line


def _messages(batch: deque[Waiting]) -> list[tuple[int, str]]:
    """The texts of messages of about 64 KiB, each with the number of its numbered reports."""
    messages: list[tuple[int, str]] = []
    lines: list[str] = []
    count = size = 0
    span = ""
    for waiting in batch:
        line = line_of(waiting)
        mine, _, short = line.partition("\n")
        if short:
            lines.append(f"\n~{short}" if mine == span else f"\n@{mine}\n~{short}")
            span = mine
        else:
            lines.append(f"\n{seconds(waiting.at_ns, 7)},{line}")
        count += waiting.one is not None
        size += len(lines[-1])
        if size >= _MESSAGE_BYTES:
            messages.append((count, "".join(lines)))
            lines, count, size, span = [], 0, 0, ""
    return [*messages, (count, "".join(lines))] if lines else messages
