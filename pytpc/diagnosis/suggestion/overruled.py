"""Finds what decided in place of a flag, in one condition with it.

In ``if (use_window && count > least)`` the flag lets the comparison behind it decide. While that is
false the condition is false, with the flag and without it. Each operand of ``&&`` and ``||``
reports by itself, and only if it is evaluated. So the log shows that the flag was passed, and
what the operand behind it said. Which operator it is stands in the line of source; a line with both
operators, a negation or a choice is not judged.
"""

from __future__ import annotations

import re

import numpy as np

from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Comparison
from pytpc.static.static_info import StaticInfo

_AND, _OR = re.compile(r"&&|\band\b"), re.compile(r"\|\||\bor\b")
_OTHERWISE = re.compile(r"!(?!=)|\bnot\b|\?|\belse\b.*:|\bin\b|\bis\b")


def overruling(
    recording: Recording,
    static_info: StaticInfo,
    flag: Comparison,
    is_on: bool,
    span_ns: tuple[int, int],
) -> Comparison | None:
    """The comparison that decided a flag's condition the same way whatever the flag was.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        flag: one of its comparisons, with the relation ``flag``.
        is_on: the flag's value in the span.
        span_ns: from when to when.

    Returns:
        One further on in the line; None if there is none, or if it is not known.
    """
    # What was passed is an `&&` if the flag is on, and an `||` if it is off.
    if _operator(flag.source_code or "") is not is_on:
        return None
    for one in static_info.unit_of(flag.key).comparisons:
        same = (one.file, one.function, one.lineno) == (flag.file, flag.function, flag.lineno)
        if same and one.column > flag.column:
            said = _outcomes(recording, one.key, *span_ns)
            # An operand of `&&` that is always false, or of `||` that is always true.
            if said == {not is_on}:
                return one
    return None


def _operator(line: str) -> bool | None:
    """Whether a condition is joined by ``&&`` alone (True), or by ``||`` alone (False)."""
    has_and, has_or = bool(_AND.search(line)), bool(_OR.search(line))
    if has_and == has_or or _OTHERWISE.search(line):
        return None
    return has_and


def _outcomes(recording: Recording, key: str, begin_ns: int, end_ns: int) -> set[bool]:
    """The outcomes of a comparison in a span; of a summary that reaches into it, all it has."""
    events, summaries = recording.events, recording.summaries
    rows = events.rows_of(key)
    rows = rows[(events.time_ns[rows] >= begin_ns) & (events.time_ns[rows] <= end_ns)]
    found = {bool(one) for one in np.unique(events.res[rows])}
    own = summaries.take(summaries.rows_of(key))
    own = own.take((own.end_ns >= begin_ns) & (own.begin_ns <= end_ns))
    if np.any(own.flops > 0):
        return {True, False}
    return found | {bool(one) for one in np.unique(own.res)}
