"""What a sink takes, and its lines of text (docs/formats.md, "Reports")."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from pytpc.pyhook.sites import Reported


class Summary(NamedTuple):
    """All evaluations of one comparison in one thread and period. Times in ns."""

    one: Reported
    thread: int
    period: int
    result: bool
    res: bool
    cmp: float
    thresh: float
    evaluations: int
    odd: int
    far: int
    flops: int
    diff: tuple[float, float, float, float]
    span: tuple[float, float]
    begin_ns: int
    end_ns: int
    begin_ros_ns: int
    end_ros_ns: int


class Sink:
    """Where reports go. This one goes nowhere; the others replace what they need."""

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """One evaluation."""

    def edge(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """A flop, or a first evaluation, under the policy ``edges``."""
        self.take(one, result, cmp, thresh, res)

    def summary(self, summary: Summary) -> None:
        """A period that is over."""

    def dropped(self, one: Reported | None, count: int, flops: int, why: str) -> None:
        """What was not reported since the last account."""

    def turn(self) -> None:
        """The helper thread's, some fifty times a second."""

    def wants_turns(self) -> bool:
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


def summary_line(kept: Summary) -> str:
    """The same with count, flops, and so on."""
    usable = kept.evaluations - kept.odd
    least, largest, total, absolute = kept.diff if usable else (float("nan"),) * 4
    low, high = kept.span if usable else (float("nan"),) * 2
    means = [number(x / usable) if usable else "nan" for x in (total, absolute)]
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
