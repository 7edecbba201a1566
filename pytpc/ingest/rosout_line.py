"""The text of one report (SPEC 5), read strictly: pure functions from a line to a record.

``parse_report`` reads what is in the ``msg`` of a /rosout message, ``parse_stamped`` what is in the
``data`` of a /threshold_information message. A number is what the sinks write: decimal or
scientific notation of a finite double, ``nan``, ``inf`` or ``-inf`` (and ``-nan``, the text that
the C library gives the NaN of 0.0/0.0).
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from pytpc.events import Report

PREFIX = "threshold_information:"

_TIME = r"[0-9]{1,10}\.[0-9]{1,9}"
_KEY = r"[0-9a-fA-F]{8}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{12}"
_BOOL = r"0|1|True|False"
_DOUBLE = r"[-+]?(?:[0-9]+(?:\.[0-9]*)?(?:[eE][-+]?[0-9]+)?|\.[0-9]+(?:[eE][-+]?[0-9]+)?|inf|nan)"
_END = r"[ \t\r\n]*"

_REPORT = re.compile(rf"({_KEY}),({_BOOL}),cmp:({_DOUBLE}),thresh:({_DOUBLE}),res:({_BOOL}){_END}")
_STAMPED = re.compile(rf"({_TIME}),")
_BOOLS = {"0": False, "1": True, "False": False, "True": True}

_FIELDS = (
    ("a key (a UUID)", re.compile(_KEY), ","),
    ("a result (0, 1, True or False)", re.compile(_BOOL), ",cmp:"),
    ("cmp as a number", re.compile(_DOUBLE), ",thresh:"),
    ("thresh as a number", re.compile(_DOUBLE), ",res:"),
    ("res (0, 1, True or False)", re.compile(_BOOL), ""),
)


class StampedReport(NamedTuple):
    """A report that brings its own time, in nanoseconds."""

    time_ns: int
    report: Report


class Malformed(NamedTuple):
    """A line that begins like a report and is none: what is wrong, and at which column (from 1)."""

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


def parse_stamped(text: str) -> StampedReport | Malformed:
    """Read ``TIME,KEY,RESULT,cmp:C,thresh:T,res:R``, TIME in seconds.

    Nothing else belongs on that topic, so any other text is ``Malformed``.
    """
    stamp = _STAMPED.match(text)
    if stamp is None:
        return Malformed("a time in seconds is expected", 1)
    report = _read(text, stamp.end())
    if isinstance(report, Malformed):
        return report
    seconds, _, fraction = stamp[1].partition(".")
    return StampedReport(int(seconds) * 10**9 + int(fraction.ljust(9, "0")), report)


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
    return Report(key.lower(), _BOOLS[result], cmp, thresh, _BOOLS[res])


def _fault(text: str, start: int) -> Malformed:
    """Where ``_REPORT`` gave up: the slow way, for the few lines that are broken."""
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
