"""The faults of a recording, in sentences; everything that was left out is named."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from pytpc.base.wording import many
from pytpc.recording.events import Events
from pytpc.recording.mission import Recording
from pytpc.static.parameters import base_key
from pytpc.static.static_info import StaticInfo

_NAMED = 3
"""How many unknown keys, or nodes on another clock, are named."""

# Simulated time and wall time are decades apart, two missions hours.
CLOCKS_APART_NS = 24 * 3600 * 10**9


def faults_of(recording: Recording, static_info: StaticInfo | None = None) -> Iterator[str]:
    """Name each fault in a sentence without a final full stop, the most harmful first.

    Args:
        recording: the mission.
        static_info: if given, reports that it does not know and mixed clocks are faults, too.
    """
    unknown = unknown_keys(recording.events, static_info) if static_info is not None else {}
    if unknown:
        often = sorted(unknown, key=lambda key: (-unknown[key], key))[:_NAMED]
        named = ", ".join(f"{key} ({unknown[key]:,})" for key in often)
        more = f" and {len(unknown) - _NAMED:,} more" if len(unknown) > _NAMED else ""
        yield (
            f"{many(sum(unknown.values()), 'report')} of {many(len(unknown), 'key')} left out:"
            f" not in the static information (built at another time?): {named}{more}"
        )
    if recording.lost:
        worst = max(recording.lost, key=lambda node: (recording.lost[node], node))
        yield (
            f"{many(sum(recording.lost.values()), 'log message')} lost on the way to the"
            f" recorder, most of {worst} ({recording.lost[worst]:,})"
        )
    if recording.malformed and not recording.malformed_first:
        yield f"{many(recording.malformed, 'broken report')} left out"
    elif recording.malformed:
        first = recording.malformed_first[0]
        # Records of files say at which byte or line they stand.
        at = f" at {(first.time_ns - recording.start_ns) / 1e9:.3f} s" if first.time_ns else ""
        text = f": {first.text!r}" if first.text else ""
        yield (
            f"{many(recording.malformed, 'broken report')} left out, the first on"
            f" {first.topic}{at}: {first.what}{text}"
        )
    if recording.dropped:
        count = sum(dropped.count for dropped in recording.dropped)
        reasons = ", ".join(sorted({dropped.why for dropped in recording.dropped}))
        yield f"{many(count, 'report')} left out by the nodes themselves ({reasons})"
    yield from static_info.troubles if static_info is not None else ()
    yield from recording.notes
    if static_info is not None:
        yield from two_clocks(recording)


def unknown_keys(events: Events, static_info: StaticInfo) -> dict[str, int]:
    """Keys in the log that the static information does not know, with their number of reports.

    They come from a program that was built at another time than the static information.
    """
    counts = Counter(events.key.tolist())
    known = static_info.comparisons.keys() | static_info.set_aside
    return {
        key: counts[code]
        for code, key in enumerate(events.keys)
        if counts[code] and known.isdisjoint({key, base_key(key)})
    }


def two_clocks(recording: Recording) -> Iterator[str]:
    """A sentence for each part of a recording that is more than a day from its other reports.

    It is compared with the clock of most reports. Nothing is shifted: reports later than a mark on
    its clock do not count for it.
    """
    events = recording.events
    if not len(events):
        return
    times = events.time_ns
    cuts = np.flatnonzero(np.diff(times) > CLOCKS_APART_NS) + 1
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
    begin, end = first - CLOCKS_APART_NS, last + CLOCKS_APART_NS
    apart = [mark for mark in marks if not begin <= mark <= end]
    if apart:
        yield (
            f"{len(apart)} of {len(marks)} marks are on another clock than the reports"
            f" ({_day(apart[0])} and {_day(first)}; /use_sim_time?)"
        )


def _day(time_ns: int) -> str:
    """The date, or the seconds if they cannot be wall time."""
    if abs(time_ns) < 365 * CLOCKS_APART_NS:
        return f"{time_ns / 1e9:.1f} s"
    return str(np.datetime64(time_ns, "ns").astype("datetime64[D]"))
