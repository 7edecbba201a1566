"""Reads the text of one report strictly: pure functions from a line to a record.

Format: docs/reference/formats.md#reports.

``parse_report`` reads the ``msg`` of a /rosout message, ``parse_stamped`` and ``parse_batch`` read
a line of the ``data`` of a /threshold_information message, and ``parse_other`` reads either. A
number is what the sinks write: decimal or scientific notation of a finite double, ``nan``, ``inf``
or ``-inf`` (and ``-nan``, which is how the C library writes the NaN of 0.0/0.0).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import NamedTuple

from pytpc.recording.events import Report
from pytpc.recording.summaries import Summary

PREFIX = "threshold_information:"
SUMMARY_PREFIX = "threshold_summary:"
DROPPED_PREFIX = "threshold_dropped:"
NAME_PREFIX = "threshold_name:"
BATCH_PREFIX = "threshold_batch:"
LATEST_NS = 2**63 - 1

TIME = r"[0-9]{1,10}\.[0-9]{1,9}"
_UUID = r"[0-9a-fA-F]{8}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{12}"
# With the number of an instance behind it.
KEY = rf"{_UUID}(?:#[0-9]{{1,9}})?"
_BOOL = r"0|1|True|False"
DOUBLE = r"[-+]?(?:[0-9]+(?:\.[0-9]*)?(?:[eE][-+]?[0-9]+)?|\.[0-9]+(?:[eE][-+]?[0-9]+)?|inf|nan)"
_END = r"[ \t\r\n]*"

_REPORT = re.compile(rf"({KEY}),({_BOOL}),cmp:({DOUBLE}),thresh:({DOUBLE}),res:({_BOOL}){_END}")
_COUNT = r"[0-9]{1,18}"
_NODE = "/[A-Za-z0-9_/]{1,1000}"
_SUMMARY = re.compile(
    rf"({KEY}),({_BOOL}),cmp:({DOUBLE}),thresh:({DOUBLE}),res:({_BOOL}),count:({_COUNT}),"
    rf"flops:({_COUNT}),diff:({DOUBLE});({DOUBLE});({DOUBLE}),abs:({DOUBLE}),"
    rf"range:({DOUBLE});({DOUBLE}),far:({_COUNT}),odd:({_COUNT}),span:({TIME});({TIME})"
    rf"(?:,seen:{_COUNT})?(?:,about)?{_END}"
)
_DROPPED = re.compile(
    rf"({KEY})?,count:({_COUNT}),flops:({_COUNT}),why:(site|process|nested|stopped){_END}"
)
_BATCH = re.compile(
    rf"#seq:({_COUNT}),count:({_COUNT}),dropped:({_COUNT}),pid:({_COUNT}),steady:({TIME})"
    rf"(?:,node:(?P<node>{_NODE}))?{_END}"
)
_NAME = re.compile(
    rf"({KEY})(?:,node:(?P<node>{_NODE})|(?:,(?P<name>/[A-Za-z0-9_/~.]{{1,1000}}))?"
    rf"(?:,of:(?P<object>[1-9][0-9]{{0,8}}))?){_END}"
)
_STAMPED = re.compile(rf"({TIME}),")
BOOLS = {"0": False, "1": True, "False": False, "True": True}

_SUMMARY_NUMBERS = {"cmp": 3, "thresh": 4, "diff_min": 8, "diff_max": 9, "diff_mean": 10}
_SUMMARY_NUMBERS |= {"abs_mean": 11, "low": 12, "high": 13}

_FIELDS = (
    ("a key (a UUID)", re.compile(KEY), ","),
    ("a result (0, 1, True or False)", re.compile(_BOOL), ",cmp:"),
    ("cmp as a number", re.compile(DOUBLE), ",thresh:"),
    ("thresh as a number", re.compile(DOUBLE), ",res:"),
    ("res (0, 1, True or False)", re.compile(_BOOL), ""),
)


@dataclass(frozen=True, slots=True)
class Drop:
    """Reports that the process dropped; ``key`` is empty if the site is not known."""

    key: str
    count: int
    flops: int
    why: str


@dataclass(frozen=True, slots=True)
class Named:
    """The full name of the parameter that the read with this key has read.

    ``object`` is the number of the object in which it was read, 0 if the line does not say. Without
    a name it is the object that evaluates the comparison with this key. With ``node`` it is
    neither: the reports with this key are of that node, and not of the one that the process is
    named after.
    """

    key: str
    name: str
    object: int = 0
    node: str = ""


@dataclass(frozen=True, slots=True)
class BatchHead:
    """The first line of a message of several lines.

    ``seq`` is the number, in its process, of the first of the ``count`` reports that follow;
    ``dropped`` is how many the process had left out when it was sent. ``node`` is the sender, where
    the line says it: on ROS 2 nothing else does.
    """

    seq: int
    count: int
    dropped: int
    pid: int
    node: str = ""


def as_text(raw: bytes) -> str:
    """The text of a line; bytes that are not UTF-8 are replaced."""
    return raw.decode("utf-8", "replace")


class Malformed(NamedTuple):
    """A line that only begins like a report: what is wrong, and at which column (from 1)."""

    what: str
    column: int


def parse_report(text: str) -> Report | Malformed | None:
    """Read ``threshold_information:KEY,RESULT,cmp:C,thresh:T,res:R``.

    Returns:
        The report; ``Malformed`` where the text only begins like one; None where it is something
        else (any other log message).
    """
    if not text.startswith(PREFIX):
        return None
    return _read(text, len(PREFIX))


def parse_stamped(text: str) -> tuple[int, Report] | Malformed:
    """Read ``TIME,KEY,RESULT,cmp:C,thresh:T,res:R``, TIME in seconds and returned in nanoseconds.

    Nothing else belongs on that topic, so any other text is ``Malformed``.
    """
    stamp = _STAMPED.match(text)
    if stamp is None:
        return Malformed("a time in seconds is expected", 1)
    if nanoseconds(stamp[1]) > LATEST_NS:
        return Malformed("a time beyond the year 2262", 1)
    report = _read(text, stamp.end())
    return report if isinstance(report, Malformed) else (nanoseconds(stamp[1]), report)


def parse_other(
    text: str, node: str, *, stamped: bool = False
) -> Summary | Drop | Named | Malformed | None:
    """Read a line about a summary, dropped reports or a name, behind a time if ``stamped``.

    Returns:
        What it says; ``Malformed`` where the text only begins like one; None for anything else.
    """
    stamp = _STAMPED.match(text) if stamped else None
    if stamped and stamp is None:
        return None
    start = 0 if stamp is None else stamp.end()
    if text.startswith(SUMMARY_PREFIX, start):
        return _parse_summary(text, start + len(SUMMARY_PREFIX), node)
    if text.startswith(DROPPED_PREFIX, start):
        return _parse_drop(text, start + len(DROPPED_PREFIX))
    if text.startswith(NAME_PREFIX, start):
        return parse_name(text, start + len(NAME_PREFIX))
    return None


def _parse_summary(text: str, place: int, node: str) -> Summary | Malformed:
    found = _SUMMARY.fullmatch(text, place)
    if found is None:
        return Malformed("a summary's fields are expected", place + 1)
    return _summary(found, node)


def _parse_drop(text: str, place: int) -> Drop | Malformed:
    found = _DROPPED.fullmatch(text, place)
    if found is None:
        return Malformed("KEY,count:N,flops:F,why:W is expected", place + 1)
    key, count, flops, why = found.groups()
    return Drop((key or "").lower(), int(count), int(flops), why)


def parse_name(text: str, place: int = 0) -> Named | Malformed:
    """Read ``KEY,/full/name[,of:N]``, ``KEY,of:N`` or ``KEY,node:/name`` from this place on."""
    found = _NAME.fullmatch(text, place)
    if found is None or not (found["name"] or found["object"] or found["node"]):
        return Malformed("KEY,/full/name is expected", place + 1)
    name, number, node = found["name"], found["object"], found["node"]
    return Named(found[1].lower(), name or "", int(number or 0), node or "")


def parse_batch(text: str) -> BatchHead | Malformed:
    """Read ``#seq:N,count:N,dropped:N,pid:P,steady:S[,node:/NAME]``."""
    found = _BATCH.fullmatch(text)
    if found is None:
        return Malformed("a line that begins with # is #seq:N,count:N,dropped:N,pid:P,steady:S", 1)
    seq, count, dropped, pid = (int(number) for number in found.groups()[:4])
    return BatchHead(seq, count, dropped, pid, found["node"] or "")


def nanoseconds(text: str) -> int:
    """The time of a text that matches ``TIME``."""
    seconds, _, fraction = text.partition(".")
    return int(seconds) * 10**9 + int(fraction.ljust(9, "0"))


def _summary(found: re.Match[str], node: str) -> Summary | Malformed:
    numbers = {name: float(found[group]) for name, group in _SUMMARY_NUMBERS.items()}
    for name, value in numbers.items():
        if math.isinf(value) and "inf" not in found[_SUMMARY_NUMBERS[name]]:
            place = found.start(_SUMMARY_NUMBERS[name]) + 1
            return Malformed("a number is beyond the range of a double", place)
    count, flops, far, odd = (int(found[group]) for group in (6, 7, 14, 15))
    begin_ns, end_ns = nanoseconds(found[16]), nanoseconds(found[17])
    if not begin_ns <= end_ns <= LATEST_NS or max(flops, far, odd) > count or count == 0:
        return Malformed("the counts or times of a summary contradict one another", found.start())
    return Summary(
        key=found[1].lower(),
        node=node,
        begin_ns=begin_ns,
        end_ns=end_ns,
        count=count,
        flops=flops,
        far=far,
        odd=odd,
        result=BOOLS[found[2]],
        res=BOOLS[found[5]],
        **numbers,
    )


def _read(text: str, start: int) -> Report | Malformed:
    found = _REPORT.fullmatch(text, start)
    if found is None:
        return _fault(text, start)
    key, result, cmp_text, thresh_text, res = found.groups()
    cmp = float(cmp_text)
    thresh = float(thresh_text)
    for value, group in ((cmp, 3), (thresh, 4)):
        if math.isinf(value) and "inf" not in found[group]:
            return Malformed("a number is beyond the range of a double", found.start(group) + 1)
    return Report(key.lower(), BOOLS[result], cmp, thresh, BOOLS[res])


def _fault(text: str, start: int) -> Malformed:
    """The slow way for the few lines that ``_REPORT`` does not match."""
    place = start
    for what, pattern, separator in _FIELDS:
        found = pattern.match(text, place)
        if found is None:
            return Malformed(f"{what} is expected", place + 1)
        place = found.end()
        if not text.startswith(separator, place):
            return Malformed(f'"{separator}" is expected after {what}', place + 1)
        place += len(separator)
    return Malformed("the line goes on after res", place + 1)
