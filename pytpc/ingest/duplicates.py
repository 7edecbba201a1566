"""Reports that arrived by more than one way are counted once.

There are two rules. First, reports that were only passed on are left out. If a node reports on
/rosout, nothing is taken from it on /rosout_agg. If a key is in the log messages of a file, nothing
is taken of it from /threshold_information, unless the publisher there reports on /rosout itself or
numbers its messages (a sink of TPC, not a converter). Second, all other possible duplicates are
compared one by one. Two reports are the same if node, key, values and results are equal and their
times are within the tolerance. Each report has at most one partner, never one from the file of
another process. The node is not compared where a channel does not tell it (converters, console
text).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pytpc.base.columns import Bools, Int64s
from pytpc.base.wording import many
from pytpc.ingest.gathering import Channel, Gathering, Way
from pytpc.ingest.spool import Rows

TOLERANCE_NS = 10**6
APART_NS = 60 * 10**9
_MOST_HELD = 1 << 22
# Reports are kept from the way that comes first.
_ORDER: tuple[Way, ...] = ("log", "file", "batch", "events", "aggregate", "text", "topic")
_SAME = ("key", "node", "count", "flops", "odd", "result", "res")
_NAMELESS: frozenset[Way] = frozenset({"topic", "text"})


@dataclass(frozen=True, slots=True)
class _Step:
    """Reports of channel ``later`` are compared with those of the channels ``earlier``."""

    later: int
    earlier: Bools
    with_node: bool


class Once:
    """Filters the blocks of a gathering's events; ``notes`` says afterwards what was left out."""

    def __init__(self, gathering: Gathering, tolerance_ns: int = TOLERANCE_NS) -> None:
        """Everything must have been read before."""
        self._gathering = gathering
        self._tolerance_ns = tolerance_ns
        self._passed_on = [_left_out(gathering.channels, channel) for channel in gathering.channels]
        self._steps = self._plan()
        self._counted: dict[int, int] = {}
        self._matched: dict[int, int] = {}

    def blocks(self, blocks: Iterable[Rows]) -> Iterator[Rows]:
        """The reports of ``blocks``, which are in order of time, without duplicates."""
        blocks = self._not_passed_on(blocks)
        return self._compared(blocks) if self._steps else iter(blocks)

    def notes(self) -> list[str]:
        """A sentence for each channel from which something was left out."""
        channels = self._gathering.channels
        notes = []
        passed_on: Counter[tuple[Way, str]] = Counter()
        for code, count in sorted(self._counted.items()):
            passed_on[channels[code].way, channels[code].topic] += count
        for (way, topic), count in passed_on.items():
            if way == "aggregate":
                why = "that the node rosout copied from /rosout"
            else:
                why = "with keys that are in the log messages too"
            notes.append(f"{many(count, 'report')} on {topic} {why}: counted once")
        for code, count in sorted(self._matched.items()):
            what = f"{many(count, 'report')} in {channels[code].name}"
            notes.append(f"{what} that also came another way: counted once")
        return notes

    def _not_passed_on(self, blocks: Iterable[Rows]) -> Iterator[Rows]:
        if not any(self._passed_on):
            yield from blocks
            return
        width = len(self._gathering.nodes.codes)
        for rows in blocks:
            kept = np.ones(rows.size, np.bool_)
            for code, pairs in enumerate(self._passed_on):
                if not pairs:
                    continue
                words = np.array([key * width + node for key, node in pairs], np.int64)
                here = rows["channel"] == code
                both = rows["key"][here].astype(np.int64) * width + rows["node"][here]
                twice = np.isin(both, words)
                kept[np.flatnonzero(here)[twice]] = False
                self._counted[code] = self._counted.get(code, 0) + int(np.count_nonzero(twice))
            yield rows[kept]

    def _plan(self) -> list[_Step]:
        """Which channels share a key (and node), so that their reports must be compared."""
        channels = sorted(self._gathering.channels, key=lambda c: (_ORDER.index(c.way), c.code))
        pairs = {c.code: c.pairs - self._passed_on[c.code] for c in channels}
        keys = {code: {key for key, _ in of} for code, of in pairs.items()}
        steps = []
        for place, later in enumerate(channels):
            for with_node in (True, False):
                earlier = np.zeros(len(channels), np.bool_)
                for other in channels[:place]:
                    if _may_share(other, later, self._tolerance_ns):
                        earlier[other.code] = (
                            bool(pairs[other.code] & pairs[later.code])
                            if with_node
                            else _nameless(other, later)
                            and bool(keys[other.code] & keys[later.code])
                        )
                if earlier.any():
                    steps.append(_Step(later.code, earlier, with_node))
        return steps

    def _compared(self, blocks: Iterable[Rows]) -> Iterator[Rows]:
        held: Rows | None = None
        twice = np.zeros(0, np.bool_)
        used = np.zeros((0, len(self._steps)), np.bool_)
        for block in blocks:
            rows = block if held is None else np.concatenate([held, block])
            if not rows.size:
                continue
            twice = np.concatenate([twice, np.zeros(block.size, np.bool_)])
            used = np.concatenate([used, np.zeros((block.size, len(self._steps)), np.bool_)])
            for number, step in enumerate(self._steps):
                self._match(rows, twice, used[:, number], step)
            times = rows["time_ns"]
            cut = int(np.searchsorted(times, times[-1] - self._tolerance_ns, "left"))
            cut = max(cut, rows.size - _MOST_HELD)
            yield rows[:cut][~twice[:cut]]
            held, twice, used = rows[cut:], twice[cut:], used[cut:]
        if held is not None:
            yield held[~twice]

    def _match(self, rows: Rows, twice: Bools, used: Bools, step: _Step) -> None:
        """Note in ``twice`` the reports of ``step.later`` with a partner, in ``used`` both."""
        channel = rows["channel"]
        is_later = channel == step.later
        among = np.flatnonzero((is_later | step.earlier[channel]) & ~twice & ~used)
        signature = _signature(rows[among], with_node=step.with_node)
        times = rows["time_ns"][among]
        order = np.lexsort((is_later[among], times, signature))
        among, signature, times = among[order], signature[order], times[order]
        while among.size > 1:
            # Neighbours from both sides; in a chain of such pairs every second pair is taken.
            near = times[1:] - times[:-1] <= self._tolerance_ns
            pairs = np.flatnonzero(
                near
                & (signature[1:] == signature[:-1])
                & (is_later[among[1:]] != is_later[among[:-1]])
            )
            if not pairs.size:
                return
            pairs = _every_second(pairs)
            both = np.concatenate([among[pairs], among[pairs + 1]])
            used[both] = True
            found = both[is_later[both]]
            twice[found] = True
            self._matched[step.later] = self._matched.get(step.later, 0) + found.size
            left = np.ones(among.size, np.bool_)
            left[pairs] = left[pairs + 1] = False
            among, signature, times = among[left], signature[left], times[left]


def summaries_twice(rows: Rows, channels: list[Channel], tolerance_ns: int) -> Bools:
    """Which summaries are those of another channel, whose text has rounded their numbers.

    A node with a ring beside its sink tells each summary twice. The two have the same comparison,
    node, counts and last outcome, and begin and end within the tolerance. Each has at most one
    partner, never one of its own channel or from the file of another process. What a file has is
    kept: it is not rounded.

    Args:
        rows: of type ``SUMMARY_ROW``.
        channels: those of the rows.
        tolerance_ns: of the times.

    Returns:
        bool[n]
    """
    twice = np.zeros(rows.size, np.bool_)
    if np.unique(rows["channel"]).size < 2:
        return twice
    is_file = np.array([one.way == "file" for one in channels])[rows["channel"]]
    codes = {name: code for code, name in enumerate(dict.fromkeys(c.process for c in channels))}
    process = np.array([codes[one.process] for one in channels])[rows["channel"]]
    nobody = codes.get("", -1)
    order = np.lexsort((rows["channel"], rows["begin_ns"], *(rows[name] for name in _SAME)))
    while order.size > 1:
        before, after = order[:-1], order[1:]
        near = rows["channel"][before] != rows["channel"][after]
        for name in _SAME:
            near &= rows[name][before] == rows[name][after]
        for name in ("begin_ns", "end_ns"):
            near &= np.abs(rows[name][before] - rows[name][after]) <= tolerance_ns
        own, other = process[before], process[after]
        near &= (own == other) | (own == nobody) | (other == nobody)
        pairs = _every_second(np.flatnonzero(near))
        if not pairs.size:
            break
        first, second = order[pairs], order[pairs + 1]
        twice[np.where(is_file[second] & ~is_file[first], first, second)] = True
        left = np.ones(order.size, np.bool_)
        left[pairs] = left[pairs + 1] = False
        order = order[left]
    return twice


def _every_second(pairs: Int64s) -> Int64s:
    """Of pairs of neighbours, by the place of the first: every second one in a chain of them."""
    begins = np.concatenate([[True], pairs[1:] != pairs[:-1] + 1])[: pairs.size]
    begin = np.maximum.accumulate(np.where(begins, np.arange(pairs.size), 0))
    return np.asarray(pairs[(np.arange(pairs.size) - begin) % 2 == 0])


def clock_notes(channels: list[Channel]) -> Iterator[str]:
    """Notes on sources that are far apart in time, which may be due to their clocks."""
    spans: dict[str, tuple[int, int]] = {}
    for channel in channels:
        if channel.count:
            first, last = spans.get(channel.source, (channel.first_ns, channel.last_ns))
            spans[channel.source] = (min(first, channel.first_ns), max(last, channel.last_ns))
    ordered = sorted(spans.items(), key=lambda item: (item[1], item[0]))
    end, before = 0, ""
    for source, (first, last) in ordered:
        if before and first - end > APART_NS:
            yield (
                f"{source} begins {(first - end) / 1e9:,.0f} s after {before} ends: on different"
                " clocks, or one after the other? Their times are used as they are"
            )
        if not before or last > end:
            end, before = last, source


def _left_out(channels: list[Channel], channel: Channel) -> set[tuple[int, int]]:
    """The pairs of key and node on ``channel`` that are passed on from another of its source."""
    own = [other for other in channels if other.source == channel.source]
    logged = {pair for other in own if other.way == "log" for pair in other.pairs}
    nodes = {node for _, node in logged}
    if channel.way == "aggregate":
        return {pair for pair in channel.pairs if pair[1] in nodes}
    if channel.way == "topic":
        aggregated = {pair for other in own if other.way == "aggregate" for pair in other.pairs}
        keys = {key for key, _ in logged | aggregated}
        return {pair for pair in channel.pairs if pair[0] in keys and pair[1] not in nodes}
    return set()


def _may_share(one: Channel, other: Channel, tolerance_ns: int) -> bool:
    """Whether a report can be on both: they overlap, and are not of two processes."""
    if one.process and other.process and one.process != other.process:
        return False
    return (
        one.first_ns <= other.last_ns + tolerance_ns
        and other.first_ns <= one.last_ns + tolerance_ns
    )


def _nameless(one: Channel, other: Channel) -> bool:
    ways = {one.way, other.way}
    return one.source != other.source and bool(ways & _NAMELESS)


def _signature(rows: Rows, *, with_node: bool) -> npt.NDArray[np.uint64]:
    """uint64[n]: a hash of all that makes two reports the same but the time (Fibonacci hashing)."""
    mixed = np.zeros(rows.size, np.uint64)
    parts = [rows["key"].astype(np.uint64), rows["result"] + 2 * rows["res"].astype(np.uint64)]
    if with_node:
        parts.append(rows["node"].astype(np.uint64))
    for name in ("cmp", "thresh"):
        values = rows[name].copy()
        values[np.isnan(values)] = np.nan
        parts.append(values.view(np.uint64))
    for part in parts:
        mixed = (mixed ^ part) * np.uint64(0x9E3779B97F4A7C15)
        mixed ^= mixed >> np.uint64(29)
    return mixed
