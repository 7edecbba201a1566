"""Times in one recording that cannot be of one clock: the wall's, and a simulation's."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pytpc.ingest.recording import Recording
from pytpc.scoring.ranking import APART_NS


def two_clocks(recording: Recording) -> Iterator[str]:
    """A sentence for each part of a recording that is more than a day from its other reports.

    Nothing is shifted: what lies after a mark on its clock does not count for it.
    """
    events = recording.events
    spans = {}
    for code, node in enumerate(events.nodes):
        times = events.time_ns[events.node == code]
        if times.size:
            spans[node] = int(times[0]), int(times[-1])
    if not spans:
        return
    # The clock of most reports is the one to compare with.
    counts = np.bincount(events.node, minlength=len(events.nodes))
    usual = events.nodes[int(np.argmax(counts))]
    first, last = spans[usual]
    for node, (begin, end) in spans.items():
        if _apart(begin, end, first, last):
            yield (
                f"the reports of {node} and of {usual} are on different clocks"
                f" ({_day(begin)} and {_day(first)}; /use_sim_time?)"
            )
    times = [mark.time_ns for mark in recording.marks]
    other = [time for time in times if _apart(time, time, first, last)]
    if other:
        yield (
            f"{len(other)} of {len(times)} marks are on another clock than the reports"
            f" ({_day(other[0])} and {_day(first)}; /use_sim_time?)"
        )


def _apart(begin: int, end: int, first: int, last: int) -> bool:
    return begin > last + APART_NS or end < first - APART_NS


def _day(time_ns: int) -> str:
    """The date, or the seconds where they cannot be of the wall's clock."""
    if abs(time_ns) < 365 * APART_NS:
        return f"{time_ns / 1e9:.1f} s"
    return str(np.datetime64(time_ns, "ns").astype("datetime64[D]"))
