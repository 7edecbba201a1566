"""Finds times in one recording that belong to two clocks: wall time and simulated time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pytpc.diagnosis.ranking.mark_ranking import APART_NS
from pytpc.recording.mission import Recording

_NAMED = 3


def two_clocks(recording: Recording) -> Iterator[str]:
    """A sentence for each part of a recording that is more than a day from its other reports.

    The clock of most reports is the one to compare with. Nothing is shifted: what is later than a
    mark on its clock does not count for it.
    """
    events = recording.events
    if not len(events):
        return
    times = events.time_ns
    cuts = np.flatnonzero(np.diff(times) > APART_NS) + 1
    begins = np.concatenate([[0], cuts])
    ends = np.concatenate([cuts, [times.size]])
    usual = int(np.argmax(ends - begins))
    first, last = int(times[begins[usual]]), int(times[ends[usual] - 1])
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        if begin == begins[usual]:
            continue
        nodes = [events.nodes[code] for code in np.unique(events.node[begin:end]).tolist()]
        named = ", ".join(nodes[:_NAMED]) + (" and others" if len(nodes) > _NAMED else "")
        yield (
            f"{end - begin:,} of {times.size:,} reports, of {named}, are on another clock than the"
            f" others ({_day(int(times[begin]))} and {_day(first)}; /use_sim_time?)"
        )
    marks = [mark.time_ns for mark in recording.marks]
    apart = [mark for mark in marks if mark > last + APART_NS or mark < first - APART_NS]
    if apart:
        yield (
            f"{len(apart)} of {len(marks)} marks are on another clock than the reports"
            f" ({_day(apart[0])} and {_day(first)}; /use_sim_time?)"
        )


def _day(time_ns: int) -> str:
    """The date, or the seconds where they cannot be of the wall's clock."""
    if abs(time_ns) < 365 * APART_NS:
        return f"{time_ns / 1e9:.1f} s"
    return str(np.datetime64(time_ns, "ns").astype("datetime64[D]"))
