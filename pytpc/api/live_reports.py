"""Turns the messages of a running graph into evaluations and summaries, each once.

The forms are those of docs/reference/formats.md: log messages on ``/rosout``, single lines and
numbered batches on ``/threshold_information``.
"""

from __future__ import annotations

from collections import Counter, deque
from dataclasses import replace
from typing import NamedTuple

from pytpc.diagnosis.results.live import Seen
from pytpc.ingest.decoders import ROS1, Decoders
from pytpc.ingest.losses import LossCounter
from pytpc.ingest.messages import BEGIN
from pytpc.ingest.rosout_line import (
    BATCH_PREFIX,
    NAME_PREFIX,
    Drop,
    Malformed,
    Named,
    parse_other,
    parse_report,
    parse_stamped,
)
from pytpc.ingest.short_summary import (
    SPAN,
    ShortSummary,
    Span,
    is_short,
    parse_short,
    parse_span,
)
from pytpc.recording.mission import ReadName
from pytpc.recording.summaries import Summary
from pytpc.ros.intake import sender_of
from pytpc.ros.ros1.relay import ROSOUT, lines_of
from pytpc.ros.source import Source

Item = Seen | Summary | ReadName
Other = Summary | Drop | Named | Malformed | None

_HOLD_S = 0.5
_FORGET_S = 5.0


class _Held(NamedTuple):
    """A single line that may copy a log message which has not arrived yet."""

    until: float
    line: str
    item: Item


class Reports:
    """Messages in, evaluations and summaries out, each once.

    A relay repeats the reports of /rosout under its own name. So a single line on the topic waits a
    moment, and is dropped if /rosout brings the same line.
    """

    def __init__(self, decoders: Decoders = ROS1) -> None:
        """Nothing has come yet; ``decoders`` are those of the graph's ROS."""
        self._decoders = decoders
        self._counter: LossCounter[str] = LossCounter()
        self._logged: Counter[str] = Counter()
        self._order: deque[tuple[float, str]] = deque()
        self._held: deque[_Held] = deque()
        # The nodes of keys, by key and the node that the process is named after.
        self._nodes: dict[tuple[str, str], str] = {}
        self.malformed = 0
        self.dropped: Counter[tuple[str, str]] = Counter()
        """How many reports processes dropped, by the node that a process is named after and why."""

    @property
    def lost(self) -> int:
        """How many messages never arrived, by their sequence numbers."""
        return sum(self._counter.lost.values())

    def read(self, source: Source, data: bytes, steady_s: float) -> list[Item]:
        """Read a message of either topic; broken ones are counted."""
        try:
            if source.topic == ROSOUT:
                return self._log(source, data, steady_s)
            return self._text(source, data, steady_s)
        except ValueError:
            self.malformed += 1
            return []

    def due(self, steady_s: float) -> list[Item]:
        """Lines that have waited long enough and are not copies."""
        found = []
        while self._held and self._held[0].until <= steady_s:
            held = self._held.popleft()
            if self._logged[held.line] > 0:
                self._logged[held.line] -= 1
            else:
                found.append(held.item)
        while self._order and self._order[0][0] <= steady_s:
            line = self._order.popleft()[1]
            self._logged[line] -= 1
            if self._logged[line] <= 0:
                del self._logged[line]
        return found

    def _log(self, source: Source, data: bytes, steady_s: float) -> list[Item]:
        log = self._decoders.log(data)
        node = log.node.decode("utf-8", "replace")
        self._counter.see(source.node or node, log.seq, latched=source.latched)
        if not log.msg.startswith(BEGIN):
            return []
        text = log.msg.decode("utf-8", "replace")
        for line in lines_of(text, log.stamp_ns):
            self._logged[line] += 1
            self._order.append((steady_s + _FORGET_S, line))
        if text.startswith(BATCH_PREFIX):
            # Of another numbering than the topic's batches.
            self._counter.see_text(f"{node}{ROSOUT}", log.msg[len(BATCH_PREFIX) :])
            return self._batch(text, node)
        report = parse_report(text)
        if isinstance(report, Malformed):
            self.malformed += 1
            return []
        if report is not None:
            key, result, cmp, thresh, res = report
            return [Seen(log.stamp_ns, key, self._node(key, node), result, cmp, thresh, res)]
        item = self._item(parse_other(text, node), node)
        return [] if item is None else [item]

    def _text(self, source: Source, data: bytes, steady_s: float) -> list[Item]:
        raw = self._decoders.text(data)
        self._counter.see_text(source.node, raw)
        text = raw.decode("utf-8", "replace")
        if text.startswith("#"):
            return self._batch(text, source.node or sender_of(raw))
        item = self._line(text, source.node)
        if item is not None:
            self._held.append(_Held(steady_s + _HOLD_S, text.rstrip(), item))
        return []

    def _batch(self, text: str, node: str) -> list[Item]:
        found: list[Item] = []
        span: Span | None = None
        lines = text.split("\n")[1:]
        # A batch begins with its reports.
        for line in lines:
            if NAME_PREFIX in line:
                self._learn(parse_other(line, node, stamped=True), node)
        for line in lines:
            item: object = None
            if is_short(line):
                item = parse_span(line) if line[0] == SPAN else parse_short(line, span, node)
                self.malformed += isinstance(item, Malformed)
                span = item if isinstance(item, Span) else span
            elif line:
                item = self._line(line, node)
            if isinstance(item, ShortSummary):
                found.append(self._placed(item.summary))
            elif isinstance(item, Seen | Summary | ReadName):
                found.append(item)
        return found

    def _line(self, line: str, node: str) -> Item | None:
        other = parse_other(line, node, stamped=True)
        if other is not None:
            return self._item(other, node)
        found = parse_stamped(line)
        if isinstance(found, Malformed):
            self.malformed += 1
            return None
        time_ns, (key, result, cmp, thresh, res) = found
        return Seen(time_ns, key, self._node(key, node), result, cmp, thresh, res)

    def _node(self, key: str, process: str) -> str:
        """The node whose key it is, in the process that is named after a node."""
        return self._nodes.get((key, process), process)

    def _placed(self, summary: Summary) -> Summary:
        node = self._node(summary.key, summary.node)
        return summary if node == summary.node else replace(summary, node=node)

    def _learn(self, other: Other, node: str) -> None:
        if isinstance(other, Named) and other.node:
            self._nodes[other.key, node] = other.node

    def _item(self, other: Other, node: str) -> Item | None:
        """What the ranking takes of a line that is no report."""
        self._learn(other, node)
        if isinstance(other, Drop):
            self.dropped[node, other.why] += other.count
        if isinstance(other, Named):
            return None if other.node else ReadName(other.key, node, other.name, other.object)
        return self._placed(other) if isinstance(other, Summary) else None
