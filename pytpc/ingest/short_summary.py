"""Reads the short lines of a batch that the policy ``light`` sends: spans and summaries.

Format: docs/reference/formats.md#batches-of-light. A span holds for the summaries after it.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import NamedTuple

from pytpc.ingest.rosout_line import DOUBLE, KEY, LATEST_NS, TIME, Malformed, nanoseconds
from pytpc.recording.summaries import Summary

SPAN, SHORT = "@", "~"
_FAR = 1e-4
_COUNT = r"[0-9]{1,18}"
_SPAN = re.compile(rf"@({TIME});({TIME})")
_SHORT = re.compile(
    rf"~(?P<key>{KEY}),(?P<outcomes>[0-3]),(?P<cmp>{DOUBLE}),(?P<thresh>{DOUBLE}),(?P<count>{_COUNT})"
    rf"(?:,f:(?P<flops>{_COUNT}))?"
    rf"(?:,c:(?P<least>{DOUBLE});(?P<most>{DOUBLE})"
    rf"|,d:(?P<diff_min>{DOUBLE});(?P<diff_max>{DOUBLE});(?P<low>{DOUBLE});(?P<high>{DOUBLE}))?"
    rf"(?:,m:(?P<mean>{DOUBLE})(?:;(?P<abs>{DOUBLE}))?)?(?:,w:(?P<far>{_COUNT}))?"
    rf"(?:,o:(?P<odd>{_COUNT}))?(?:,s:(?P<seen>{_COUNT}))?(?P<about>,e)?"
)


class Span(NamedTuple):
    """The time that the summaries after it describe."""

    begin_ns: int
    end_ns: int


@dataclass(frozen=True, slots=True)
class ShortSummary:
    """A summary of which ``seen`` evaluations were inspected, the others only counted.

    ``about``: its number of evaluations or flops is an estimate.
    """

    summary: Summary
    seen: int
    about: bool


def is_short(line: str | bytes) -> bool:
    """Whether a line of a batch is one of these, and no report."""
    return line[:1] in ("@", "~", b"@", b"~")


def parse_span(text: str) -> Span | Malformed:
    """Read ``@BEGIN;END``."""
    found = _SPAN.fullmatch(text.rstrip())
    if found is None:
        return Malformed("@BEGIN;END is expected", 1)
    span = Span(nanoseconds(found[1]), nanoseconds(found[2]))
    if max(span) > LATEST_NS:
        return Malformed("a time beyond the year 2262", 1)
    # A clock that was set back.
    return span if span.begin_ns <= span.end_ns else Span(span.end_ns, span.end_ns)


def parse_short(text: str, span: Span | None, node: str) -> ShortSummary | Malformed:
    """Read ``~KEY,OUTCOMES,CMP,THRESH,COUNT`` and what may follow."""
    found = _SHORT.fullmatch(text.rstrip())
    if found is None:
        return Malformed("~KEY,OUTCOMES,CMP,THRESH,COUNT is expected", 1)
    if span is None:
        return Malformed("a line @BEGIN;END is expected before it", 1)
    count, flops, odd = (int(found[name] or 0) for name in ("count", "flops", "odd"))
    usable = count - odd
    numbers = _numbers(found, usable)
    far = usable if found["far"] is None else int(found["far"])
    if found["mean"] is None and not abs(numbers["diff_mean"]) > _FAR:
        far = 0
    seen = count if found["seen"] is None else int(found["seen"])
    if usable < 0 or max(flops, far, seen) > count or not count:
        return Malformed("the counts of a summary contradict one another", 1)
    outcomes = int(found["outcomes"])
    summary = Summary(
        key=found["key"].lower(),
        node=node,
        begin_ns=span.begin_ns,
        end_ns=span.end_ns,
        result=bool(outcomes & 1),
        res=bool(outcomes & 2),
        cmp=float(found["cmp"]),
        thresh=float(found["thresh"]),
        count=count,
        flops=flops,
        far=far,
        odd=odd,
        **numbers,
    )
    return ShortSummary(summary, seen, found["about"] is not None)


def _numbers(found: re.Match[str], usable: int) -> dict[str, float]:
    """The differences and ranges; what a line leaves out follows from what it has."""
    cmp, thresh = float(found["cmp"]), float(found["thresh"])
    if usable <= 0:
        names = ("diff_min", "diff_max", "diff_mean", "abs_mean", "low", "high")
        return dict.fromkeys(names, math.nan)
    if found["diff_min"] is not None:
        diff_min, diff_max = float(found["diff_min"]), float(found["diff_max"])
        low, high = float(found["low"]), float(found["high"])
    else:
        least = cmp if found["least"] is None else float(found["least"])
        most = cmp if found["most"] is None else float(found["most"])
        diff_min, diff_max = least - thresh, most - thresh
        low, high = min(least, thresh), max(most, thresh)
    mean = cmp - thresh if found["mean"] is None else float(found["mean"])
    abs_mean = abs(mean) if found["abs"] is None else float(found["abs"])
    return {
        "diff_min": diff_min,
        "diff_max": diff_max,
        "diff_mean": mean,
        "abs_mean": abs_mean,
        "low": low,
        "high": high,
    }
