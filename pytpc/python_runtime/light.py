"""The policy ``light``, the default: flops up to the caps, and a summary of a sample of the rest.

Between two samples an evaluation with the same outcome is only counted. The C++ runtime does the
same (runtime_log/Light.h); here no thread loses a count, and no flop is passed over.
"""

from __future__ import annotations

import threading
from math import inf, isfinite
from random import Random
from time import monotonic_ns
from typing import TYPE_CHECKING

from pytpc.python_runtime import ros_state
from pytpc.python_runtime.sinks import PeriodSummary, Sink, number

if TYPE_CHECKING:
    from collections.abc import Callable

    from pytpc.python_runtime.config import Config
    from pytpc.python_runtime.log_file import LogFile
    from pytpc.python_runtime.policies import Caps
    from pytpc.python_runtime.ring import Statements
    from pytpc.python_runtime.sites import Reported

# As in the C++ runtime: so many evaluations are inspected before sampling begins, and the stride
# doubles after so many more.
_SAMPLES = 128
_SAMPLES_OF_STRIDE = 32
_LONGEST_STRIDE = 1 << 24


class LightSummary(PeriodSummary):
    """A summary of a sample; ``evaluations`` counts the sample, ``passed`` all others."""

    __slots__ = ("before", "given", "highest", "left", "lowest", "moved", "passed", "told")

    def __init__(self, one: Reported) -> None:
        """``left`` evaluations are passed over from now on, of the ``given`` ones."""
        self.left = self.given = self.passed = self.before = 0
        self.told = -1
        super().__init__(one, 0)

    def begin(self, period: int, now_ns: int, ros_ns: int) -> None:
        """A new period."""
        super().begin(period, now_ns, ros_ns)
        self.passed = 0
        self.moved = False
        self.lowest, self.highest = inf, -inf

    def settle(self) -> None:
        """Count what was passed over since the last call."""
        self.passed += self.given - self.left
        self.given = self.left

    def add(self, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """One evaluation of the sample."""
        self.moved |= self.evaluations > 0 and thresh != self.thresh
        super().add(result, cmp, thresh, res)
        if isfinite(cmp - thresh):
            self.lowest, self.highest = min(self.lowest, cmp), max(self.highest, cmp)

    @property
    def seen(self) -> int:
        """Of a scaled summary: how many evaluations were inspected."""
        return self.evaluations - self.passed

    @property
    def count(self) -> int:
        """All evaluations."""
        return self.evaluations + self.passed

    def scaled(self) -> LightSummary:
        """The summary as of all evaluations: counts and sums are scaled from the sample."""
        whole = LightSummary(self.one)
        for name in PeriodSummary.__slots__:
            setattr(whole, name, getattr(self, name))
        whole.lowest, whole.highest, whole.moved = self.lowest, self.highest, self.moved
        whole.passed = self.passed
        if self.passed:
            share = self.count / max(1, self.evaluations)
            # Without a sample nothing is known of the differences.
            whole.odd = min(self.count, round(self.odd * share)) if self.evaluations else self.count
            whole.far = min(self.count - whole.odd, round(self.far * share))
            more = (self.count - whole.odd) / max(1, self.evaluations - self.odd)
            whole.total, whole.absolute = self.total * more, self.absolute * more
        whole.evaluations = self.count
        return whole


class Light:
    """The policy."""

    def __init__(
        self, config: Config, sink: Sink, caps: Caps, statements: Statements | None = None
    ) -> None:
        """``statements`` are those of a ring."""
        self._sink = sink
        self._caps = caps
        self._statements = statements
        self._period_ns = config.period_ns
        self._lock = threading.RLock()
        self._open: dict[Reported, LightSummary] = {}
        self._random = Random(1)
        self._next_ns = monotonic_ns() + config.period_ns
        self._begin = monotonic_ns(), ros_state.time_now_ns()

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """Count one evaluation, and inspect it if it is a flop or one of the sample."""
        kept = self._open.get(one)
        if kept is not None and kept.left and one.last == result:
            kept.left -= 1
            return
        with self._lock:
            if kept is None:
                kept = self._open[one] = LightSummary(one)
                kept.begin(0, *self._begin)
            kept.settle()
            kept.flops += self._edge(kept, result, cmp, thresh, res)
            kept.add(result, cmp, thresh, res)
            kept.left = kept.given = self._stride(kept)
        self._sink.settle()

    def _stride(self, kept: LightSummary) -> int:
        usual = kept.before // _SAMPLES
        more = kept.evaluations - _SAMPLES
        if more < 0 and usual < 2:
            return 0
        doubled = more // _SAMPLES_OF_STRIDE + 1 if more >= 0 else 0
        mean = min(max(usual, 1) << min(doubled, 24), _LONGEST_STRIDE)
        # Not always the same number: a loop may have a rhythm.
        return mean // 2 + self._random.randrange(mean + 1)

    def _edge(self, kept: LightSummary, result: bool, cmp: float, thresh: float, res: bool) -> int:
        """Report it if the outcome has changed and the caps allow it."""
        one = kept.one
        if self._statements is not None:
            self._statements.again(one, result, cmp, thresh, res)
        last, one.last = one.last, int(result)
        if last == result:
            return 0
        is_flop = last >= 0
        if is_flop and kept.told == result:
            # Nobody has heard of the flop before, so this one is no news either.
            self._caps.count_over(one)
        elif not (is_flop and self._caps.is_over(one, is_flop=True)):
            kept.told = int(result)
            self._tell(one, result, cmp, thresh, res)
        return int(is_flop)

    def _tell(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        self._sink.edge(one, result, cmp, thresh, res)
        if self._statements is not None:
            self._statements.told(one, result, cmp, thresh, res)

    def turn(self, _file: LogFile, turn: Callable[[], None]) -> None:
        """The sinks write another file from the call of ``turn`` on: look at each comparison."""
        with self._lock:
            turn()
            if self._statements is not None:
                self._statements.begin()
            for kept in self._open.values():
                kept.settle()
                kept.left = kept.given = 0

    def flush(self, *, all_of_them: bool) -> None:
        """Send the summaries of a period that is over, or what there is."""
        now = monotonic_ns()
        if now < self._next_ns and not all_of_them:
            return
        self._next_ns = now + self._period_ns
        ros = ros_state.time_now_ns()
        with self._lock:
            for kept in list(self._open.values()):
                self._close(kept, now, ros, all_of_them=all_of_them)
            self._begin = now, ros
            self._caps.account()
        self._sink.settle()

    def _close(self, kept: LightSummary, now_ns: int, ros_ns: int, *, all_of_them: bool) -> None:
        kept.settle()
        count = kept.count
        if kept.left * 2 > count:
            kept.left = kept.given = 0
        # Without a sample there is nothing to say yet.
        if count and not kept.evaluations and not all_of_them:
            return
        if count:
            kept.end_ns, kept.end_ros_ns = now_ns, ros_ns
            self._catch_up(kept)
            self._sink.summary(kept.scaled())
        kept.before = count
        kept.begin(0, now_ns, ros_ns)

    def _catch_up(self, kept: LightSummary) -> None:
        """Report the present outcome if the flops that led to it were beyond the caps."""
        if kept.told not in (-1, kept.one.last):
            kept.told = kept.one.last
            self._tell(kept.one, kept.result, kept.cmp, kept.thresh, kept.res)


def short_line(kept: LightSummary) -> str:
    """``KEY,OUTCOMES,CMP,THRESH,COUNT`` and what does not follow from it, of a scaled summary."""
    usable = kept.evaluations - kept.odd
    parts = [
        kept.one.key,
        str(int(bool(kept.result)) + 2 * int(bool(kept.res))),
        number(kept.cmp),
        number(kept.thresh),
        str(kept.evaluations),
    ]
    if kept.flops:
        parts.append(f"f:{kept.flops}")
    if usable and not (kept.lowest == kept.highest and not kept.moved and not kept.odd):
        if kept.moved:
            extremes = (kept.least, kept.largest, kept.low, kept.high)
            parts.append("d:" + ";".join(number(value) for value in extremes))
        else:
            parts.append(f"c:{number(kept.lowest)};{number(kept.highest)}")
        is_mixed = kept.least < 0 < kept.largest
        absolute = f";{number(kept.absolute / usable)}" if is_mixed else ""
        parts.append(f"m:{number(kept.total / usable)}{absolute}")
        if kept.far != usable:
            parts.append(f"w:{kept.far}")
    if kept.odd:
        parts.append(f"o:{kept.odd}")
    if kept.passed:
        parts.append(f"s:{kept.seen}")
    return ",".join(parts)
