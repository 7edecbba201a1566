"""Collects what the readers of one or many sources hand in.

Events go into a spool, which may be on disk; marks, complaints and counters stay in memory. A
``Channel`` is one way by which reports came: a topic of one file, or a file that has only one.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from pytpc.base.columns import Bools, Floats, Int32s, Int64s, WordTable
from pytpc.base.wording import many
from pytpc.ingest.nodes_of_keys import NodesOfKeys
from pytpc.ingest.parameter_events import ParameterEvent
from pytpc.ingest.rosout_line import Named
from pytpc.ingest.short_summary import ShortSummary
from pytpc.ingest.spool import RUN_ROWS, Spool
from pytpc.recording.events import Events
from pytpc.recording.marks import Mark, MarkMessages, joined
from pytpc.recording.mission import Dropped, MalformedRecord, ReadName
from pytpc.recording.parameter_values import SetValue
from pytpc.recording.summaries import Summaries, Summary

Progress = Callable[[int, int], None]
Way = Literal["log", "aggregate", "topic", "batch", "file", "text", "events"]


def _row(table: type[WordTable]) -> np.dtype[np.void]:
    """A row of a table with its channel; the wide columns come first, which aligns them."""
    columns: list[tuple[str, type[np.generic]]] = [*table.kinds.items(), ("channel", np.uint16)]
    return np.dtype(sorted(columns, key=lambda column: -np.dtype(column[1]).itemsize))


EVENT_ROW = _row(Events)
SUMMARY_ROW = _row(Summaries)
_SHOWN = 20
_SHOWN_TEXT = 200
_HELD_SUMMARIES = 4096
_LARGEST_TABLE = 1 << 20
MOST_CHANNELS = 1 << 16
MOST_NAMES = 1 << 20


class WordCodes:
    """Words and their codes, in the order of their first use."""

    def __init__(self) -> None:
        self.codes: dict[str, int] = {}

    def code(self, word: str) -> int:
        """The code of ``word``, a new one if needed."""
        return self.codes.setdefault(word, len(self.codes))

    def all(self, words: Sequence[str]) -> Int32s:
        """The codes of ``words``."""
        return np.array([self.code(word) for word in words], np.int32)


@dataclass
class ReportColumns:
    """Reports as columns of one length; ``key`` is codes of a gathering's words."""

    time_ns: Int64s
    key: Int32s
    result: Bools
    cmp: Floats
    thresh: Floats
    res: Bools


@dataclass
class Channel:
    """One way by which reports arrived.

    ``source`` is the file or folder as given, ``way`` the kind of channel, ``topic`` its name in
    messages. ``pairs`` are the (key, node) codes seen on it. ``process`` identifies the process if
    all reports are of one.
    """

    code: int
    source: str
    way: Way
    topic: str
    process: str = ""
    first_ns: int = 2**63 - 1
    last_ns: int = -(2**63)
    count: int = 0
    pairs: set[tuple[int, int]] = field(default_factory=set)

    @property
    def name(self) -> str:
        """For the user."""
        return f"{self.source}: {self.topic}" if self.topic else self.source


class Gathering:
    """Everything that was read.

    ``spans`` are the times of recordings on their own clock; ``notes`` and ``late_notes`` are for
    the user, before and after those about duplicates; ``without_reports`` are text files without a
    report. ``marks_nearby`` belong to the recording as far as they lie within its time.

    Args:
        folder: where rows that are too many for memory are kept; None: all stays in memory.
        run_rows: how many rows are held in memory before they go there.
        most_rows: with how many reports a file is condensed by its reader; None: never.
        period_ns: condense all files of processes, into summaries of this length.
    """

    def __init__(
        self,
        folder: Path | None = None,
        run_rows: int = RUN_ROWS,
        most_rows: int | None = None,
        period_ns: int | None = None,
    ) -> None:
        self.most_rows = most_rows
        self.period_ns = period_ns
        self.keys = WordCodes()
        self.nodes = WordCodes()
        self.channels: list[Channel] = []
        self.events = Spool(
            EVENT_ROW, "time_ns", None if folder is None else folder / "events", run_rows
        )
        self.summaries = Spool(
            SUMMARY_ROW,
            "begin_ns",
            None if folder is None else folder / "summaries",
            run_rows // 4 + 1,
        )
        self.marks: list[Mark] = []
        self.marks_nearby: list[Mark] = []
        self.mark_messages = MarkMessages()
        self.malformed = 0
        self._first: list[tuple[int, MalformedRecord]] = []
        self._turn = 0
        self.lost: Counter[str] = Counter()
        self.dropped: Counter[tuple[str, str, str]] = Counter()
        self.dropped_flops: Counter[tuple[str, str, str]] = Counter()
        self.names: dict[ReadName, None] = {}
        self.node_of_key: defaultdict[tuple[str, str], set[str]] = defaultdict(set)
        self.values: list[SetValue] = []
        self._sampled: set[int] = set()
        self._about: set[int] = set()
        self._uninspected = 0
        self.without_reports: list[str] = []
        self.notes: list[str] = []
        self.late_notes: list[str] = []
        self.spans: list[tuple[int, int]] = []
        self._held: dict[int, list[Summary]] = {}
        self._held_count = 0

    def channel(self, source: str, way: Way, topic: str = "") -> Channel:
        """A new channel.

        Raises:
            ValueError: there are 65,536 of them already.
        """
        if len(self.channels) == MOST_CHANNELS:
            raise ValueError(f"more than {MOST_CHANNELS:,} sources")
        self.channels.append(Channel(len(self.channels), source, way, topic))
        return self.channels[-1]

    def has_room(self, rows: int) -> bool:
        """Whether so many more reports fit into memory."""
        if self.period_ns is not None:
            return False
        return self.most_rows is None or len(self.events) + rows <= self.most_rows

    def known_marks(self) -> tuple[Mark, ...]:
        """The marks that were read until now."""
        return joined([*self.marks, *self.mark_messages.marks()])

    def turns(self, count: int) -> range:
        """Numbers for this many records, in the order in which they came."""
        self._turn += count
        return range(self._turn - count + 1, self._turn + 1)

    def add_events(self, channel: Channel, node: Int32s | int, reports: ReportColumns) -> None:
        """Add reports of one node, or of those whose codes are in ``node``."""
        time_ns = reports.time_ns
        if not time_ns.size:
            return
        rows = np.empty(time_ns.size, EVENT_ROW)
        rows["time_ns"] = time_ns
        rows["cmp"] = reports.cmp
        rows["thresh"] = reports.thresh
        rows["key"] = reports.key
        rows["node"] = node
        rows["channel"] = channel.code
        rows["result"] = reports.result
        rows["res"] = reports.res
        channel.first_ns = min(channel.first_ns, int(time_ns.min()))
        channel.last_ns = max(channel.last_ns, int(time_ns.max()))
        channel.count += time_ns.size
        channel.pairs |= self._pairs(reports.key, node)
        self.events.append(rows)

    def _pairs(self, key: Int32s, node: Int32s | int) -> set[tuple[int, int]]:
        shape = (len(self.keys.codes), len(self.nodes.codes))
        if shape[0] * shape[1] > _LARGEST_TABLE:
            found = np.unique(key.astype(np.int64) * shape[1] + node)
            return set(zip((found // shape[1]).tolist(), (found % shape[1]).tolist(), strict=True))
        seen = np.zeros(shape, np.bool_)
        seen[key, node] = True
        keys, nodes = np.nonzero(seen)
        return set(zip(keys.tolist(), nodes.tolist(), strict=True))

    def add_summary(self, channel: Channel, summary: Summary) -> None:
        """Take in a summary."""
        self._held.setdefault(channel.code, []).append(summary)
        self._held_count += 1
        if self._held_count >= _HELD_SUMMARIES:
            self.flush()

    def add_short(self, channel: Channel, short: ShortSummary) -> None:
        """Take in a summary of the policy ``light``."""
        summary = short.summary
        self.add_summary(channel, summary)
        self.note_sample(self.keys.code(summary.key), summary.count, short.seen, short.about)

    def note_sample(self, key: int, count: int, seen: int, about: bool) -> None:
        """Note for ``light_notes`` that ``seen`` of ``count`` evaluations were inspected."""
        if count > seen:
            self._sampled.add(key)
            self._uninspected += count - seen
        if about:
            self._about.add(key)

    def light_notes(self) -> list[str]:
        """What the policy ``light`` left out, in sentences."""
        notes = []
        if self._sampled:
            where = many(len(self._sampled), "comparison")
            notes.append(
                f"{many(self._uninspected, 'evaluation')} of {where} in hot loops were counted and"
                " not inspected (policy light): their extremes and means are those of a sample"
            )
        if self._about:
            notes.append(
                f"the numbers of evaluations or flops of {many(len(self._about), 'comparison')} are"
                " estimates: several threads evaluate them, or they change too often"
            )
        return notes

    def add_summaries(self, channel: int, table: Summaries) -> None:
        """Take in the summaries of the channel with this code."""
        rows = np.empty(len(table), SUMMARY_ROW)
        for name, column in table.columns().items():
            rows[name] = column
        rows["key"] = self.keys.all(table.keys)[table.key]
        rows["node"] = self.nodes.all(table.nodes)[table.node]
        rows["channel"] = channel
        self.summaries.append(rows)

    def add_dropped(self, dropped: Dropped) -> None:
        """Count reports that a process dropped."""
        word = (dropped.key, dropped.node, dropped.why)
        self.dropped[word] += dropped.count
        self.dropped_flops[word] += dropped.flops

    def add_named(self, named: Named, node: str) -> None:
        """Take in what the process of ``node`` said of a name, an object or a node."""
        if named.node:
            self.node_of_key[named.key, node].add(named.node)
        else:
            self.add_name(ReadName(named.key, node, named.name, named.object))

    def moved_nodes(self) -> NodesOfKeys:
        """The nodes of the reports of processes that have several."""
        moves = {
            (self.keys.code(key), self.nodes.code(node)): self.nodes.code(min(own))
            for (key, node), own in self.node_of_key.items()
            # Another process of this name may have had another order.
            if len(own) == 1
        }
        return NodesOfKeys(moves, len(self.nodes.codes))

    def add_name(self, name: ReadName) -> None:
        """Take in the name of a parameter; nodes report each several times."""
        if len(self.names) < MOST_NAMES:
            self.names[name] = None

    def add_values(self, event: ParameterEvent, time_ns: int) -> None:
        """Take in what a node's parameters were set to; ``time_ns`` is when it was recorded."""
        if event.is_of_tpc:
            return
        for name, value in event.values.items():
            full = f"{event.node.rstrip('/')}/{name}"
            self.values.append(SetValue(event.stamp_ns or time_ns, full, value))

    def skip(self, topic: str, time_ns: int, what: str, text: str, turn: int | None = None) -> None:
        """Count a record that cannot be read; the first 20 are kept, in the order of ``turn``."""
        self.malformed += 1
        turn = self.turns(1)[0] if turn is None else turn
        if len(self._first) == _SHOWN and turn > self._first[-1][0]:
            return
        self._first.append((turn, MalformedRecord(topic, time_ns, what, text[:_SHOWN_TEXT])))
        self._first.sort(key=lambda item: item[0])
        del self._first[_SHOWN:]

    def flush(self) -> None:
        """Hand on the summaries that are still held."""
        for channel, summaries in self._held.items():
            self.add_summaries(channel, Summaries.of_rows(summaries))
        self._held, self._held_count = {}, 0

    @property
    def malformed_first(self) -> tuple[MalformedRecord, ...]:
        """The first 20 records that were skipped."""
        return tuple(record for _, record in self._first)

    def _node_of(self, key: str, node: str) -> str:
        own = self.node_of_key.get((key, node), ())
        return next(iter(own)) if len(own) == 1 else node

    @property
    def dropped_list(self) -> tuple[Dropped, ...]:
        """All dropped reports, by node, key and reason."""
        found = [
            Dropped(key, self._node_of(key, node), count, self.dropped_flops[key, node, why], why)
            for (key, node, why), count in self.dropped.items()
            if count
        ]
        return tuple(sorted(found, key=Dropped.order))
