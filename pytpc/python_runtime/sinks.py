"""What a sink takes, and its lines of text (docs/reference/formats.md#reports)."""

from __future__ import annotations

from math import inf, isfinite, nan
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pytpc.python_runtime.sites import Reported


# |cmp - thresh| above which an evaluation is far (docs/reference/scores.md#score-of-type-ii).
_FAR = 1e-4


class PeriodSummary:
    """All evaluations of one comparison in one thread and period, as they come. Times in ns."""

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
        "thread",
        "thresh",
        "total",
    )

    def __init__(self, one: Reported, thread: int) -> None:
        self.one = one
        self.thread = thread
        self.begin(0, 0, 0)

    def begin(self, period: int, now_ns: int, ros_ns: int) -> None:
        """A new period, in which nothing was evaluated yet."""
        self.period = period
        self.result = self.res = False
        self.cmp = self.thresh = 0.0
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


class Sink:
    """Where reports go. This one goes nowhere; the others replace what they need."""

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """One evaluation."""

    def edge(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """A flop, or a first evaluation, under the policy ``edges``."""
        self.take(one, result, cmp, thresh, res)

    def summary(self, summary: PeriodSummary) -> None:
        """A period that is over."""

    def dropped(self, one: Reported | None, count: int, flops: int, why: str) -> None:
        """What was not reported since the last account."""

    def settle(self) -> None:
        """Send what was handed over while a lock of ours was held: no program's code runs then."""

    def poll(self) -> None:
        """The helper thread's, some fifty times a second."""

    def is_polled(self) -> bool:
        """Whether there is something to do in `turn`."""
        return False

    def status(self) -> str:
        """What a person may want to know of it; words with ``=`` in them."""
        return ""

    def end(self) -> None:
        """The last moment."""


def number(value: float) -> str:
    """The shortest text that reads back as the same double, as C++ writes it."""
    text = repr(value)
    return text[:-2] if text.endswith(".0") else text


def report_line(one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> str:
    """``KEY,RESULT,cmp:C,thresh:T,res:R`` with the outcomes as Python writes them."""
    return f"{one.key},{bool(result)},cmp:{number(cmp)},thresh:{number(thresh)},res:{bool(res)}"


def seconds(ns: int, decimals: int) -> str:
    """A time in seconds with so many decimals, cut and not rounded."""
    sign = "-" if ns < 0 else ""
    whole, rest = divmod(abs(ns), 1_000_000_000)
    return f"{sign}{whole}.{rest:09d}"[: len(sign) + len(str(whole)) + 1 + decimals]


def summary_line(kept: PeriodSummary) -> str:
    """The same with count, flops, and so on."""
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


def dropped_line(one: Reported | None, count: int, flops: int, why: str) -> str:
    """``KEY,count:N,flops:F,why:W``."""
    return f"{one.key if one is not None else ''},count:{count},flops:{flops},why:{why}"
