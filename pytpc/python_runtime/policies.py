"""The policies between a report and its sink: caps, and ``edges``."""

from __future__ import annotations

import threading
from time import monotonic_ns
from typing import TYPE_CHECKING

from pytpc.python_runtime import ros_state
from pytpc.python_runtime.sinks import PeriodSummary, Sink

if TYPE_CHECKING:
    from collections.abc import Callable

    from pytpc.python_runtime.config import Config
    from pytpc.python_runtime.log_file import LogFile
    from pytpc.python_runtime.ring import Statements
    from pytpc.python_runtime.sites import Reported

_SECOND = 1_000_000_000


class Caps:
    """Limits reports per second, of a comparison and of the process, and counts the rest."""

    def __init__(self, config: Config, sink: Sink) -> None:
        """0 is no cap."""
        self._site, self._process = config.site_cap, config.process_cap
        self._sink = sink
        self._lock = threading.RLock()
        self._second = 0
        self._used = 0
        self._over: dict[Reported, list[int]] = {}
        self.dropped_in_all = 0

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """The policy ``every`` under caps."""
        with self._lock:
            is_flop = one.last >= 0 and one.last != result
            one.last = int(result)
        if not self.is_over(one, is_flop):
            self._sink.take(one, result, cmp, thresh, res)
        self._sink.settle()

    def is_over(self, one: Reported, is_flop: bool) -> bool:
        """Whether a report exceeds a cap; if so, it is counted."""
        if not (self._site or self._process):
            return False
        second = monotonic_ns() // _SECOND
        with self._lock:
            if second != self._second:
                self._second, self._used = second, 0
                self.account()
            if one.meter[0] != second:
                one.meter[:] = [second, 0]
            if self._site and one.meter[1] >= self._site:
                why = 0
            elif self._process and self._used >= self._process:
                why = 2
            else:
                one.meter[1] += 1
                self._used += 1
                return False
            over = self._over.setdefault(one, [0, 0, 0, 0])
            over[why] += 1
            over[why + 1] += is_flop
            self.dropped_in_all += 1
            return True

    def count_over(self, one: Reported) -> None:
        """Count a flop that is not reported, as if it exceeded the cap of its comparison."""
        with self._lock:
            over = self._over.setdefault(one, [0, 0, 0, 0])
            over[0] += 1
            over[1] += 1
            self.dropped_in_all += 1

    def account(self) -> None:
        """Report what was dropped since the last call."""
        with self._lock:
            over, self._over = self._over, {}
        for one, counts in over.items():
            for why, at in (("site", 0), ("process", 2)):
                if counts[at]:
                    self._sink.dropped(one, counts[at], counts[at + 1], why)


class Edges:
    """Each flop is reported; all evaluations are summarised by thread and period."""

    def __init__(
        self,
        config: Config,
        sink: Sink,
        caps: Caps,
        file: LogFile | None = None,
        statements: Statements | None = None,
    ) -> None:
        """``file`` has the open periods; ``statements`` are those of a ring."""
        self._sink = sink
        self._caps = caps
        self._statements = statements
        self._period_ns = config.period_ns
        self._start = monotonic_ns()
        self._lock = threading.RLock()
        self._open: dict[tuple[int, Reported], PeriodSummary] = {}
        self._file = file

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """Add one evaluation."""
        now = monotonic_ns()
        ros = ros_state.time_now_ns()
        period = (now - self._start) // self._period_ns + 1 & 0xFFFFFFFF
        thread = self._file.thread_number() if self._file is not None else threading.get_ident()
        with self._lock:
            key = (thread, one)
            kept = self._open.get(key)
            if kept is None:
                kept = self._open[key] = self._new(thread & 0xFFFFFFFF, one)
            if kept.evaluations and kept.period != period:
                self._close(kept)
            if not kept.evaluations:
                kept.begin(period, now, ros)
            kept.flops += self._edge(one, result, cmp, thresh, res)
            kept.add(result, cmp, thresh, res)
            kept.end_ns, kept.end_ros_ns = now, ros
            if kept.slot is not None:
                kept.slot.write(kept)
        self._sink.settle()

    def _new(self, thread: int, one: Reported) -> PeriodSummary:
        """The summary of a comparison that is new to its thread."""
        if self._file is None:
            return PeriodSummary(one, thread)
        self._file.announce(one)
        return PeriodSummary(one, thread, self._file.new_slot())

    def _edge(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> int:
        """Report it if the result of the predicate has changed."""
        statements = self._statements
        if statements is not None:
            statements.again(one, result, cmp, thresh, res)
        last, one.last = one.last, int(result)
        if last == result:
            return 0
        is_flop = last >= 0
        if not self._caps.is_over(one, is_flop):
            self._sink.edge(one, result, cmp, thresh, res)
            if statements is not None:
                statements.told(one, result, cmp, thresh, res)
        return int(is_flop)

    def turn(self, file: LogFile, turn: Callable[[], None]) -> None:
        """Go on in ``file``, which the sinks do from the call of ``turn`` on."""
        with self._lock:
            for kept in self._open.values():
                if kept.evaluations:
                    self._close(kept)
            self._open = {}
            turn()
            self._file = file
            if self._statements is not None:
                self._statements.begin()
        self._sink.settle()

    def _close(self, kept: PeriodSummary) -> None:
        self._sink.summary(kept)
        kept.evaluations = 0
        if kept.slot is not None:
            kept.slot.begin()

    def flush(self, *, all_of_them: bool) -> None:
        """Send the summaries of periods that are over, and on request those of open ones."""
        period = (monotonic_ns() - self._start) // self._period_ns + 1 & 0xFFFFFFFF
        with self._lock:
            for kept in self._open.values():
                if kept.evaluations and (all_of_them or kept.period != period):
                    self._close(kept)
        self._sink.settle()
