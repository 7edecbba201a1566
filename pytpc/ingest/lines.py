"""Reads reports in text, and numbered messages of several lines, into a gathering."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from pytpc.ingest.bulk_lines import LINES, read_lines
from pytpc.ingest.gathering import Channel, Gathering, ReportColumns
from pytpc.ingest.losses import LossCounter
from pytpc.ingest.rosout_line import (
    PREFIX,
    BatchHead,
    Drop,
    Malformed,
    Named,
    as_text,
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
from pytpc.recording.events import Report
from pytpc.recording.mission import Dropped
from pytpc.recording.summaries import Summary


class Lines:
    """Reads the text reports of one channel, thousands at a time.

    With ``stamped`` each line begins with its own time. The time given to ``add`` then counts only
    if the line's own is 0, or the line is malformed.
    """

    def __init__(
        self, batches: Batches, channel: Channel, *, stamped: bool, prefix: str = ""
    ) -> None:
        """``prefix`` was cut off the lines that ``add`` gets; messages about them show it."""
        self.gathering = batches.gathering
        self.channel = channel
        self._batches = batches
        self._stamped = stamped
        self._prefix = prefix
        self._lines: list[bytes] = []
        self._times: list[int] = []
        self._nodes: list[int] = []
        self._turns: list[int] = []
        self._places: list[int] = []
        self._span: Span | None = None
        self.unstamped = 0

    def add(self, line: bytes, time_ns: int, node: int, number: int = 0) -> None:
        """Add a line; ``number`` is that of the line in the file or message, if any."""
        self._lines.append(line)
        self._times.append(time_ns)
        self._nodes.append(node)
        self._turns += self.gathering.turns(1)
        self._places.append(number)
        if len(self._lines) >= LINES:
            self.flush()

    def extend(
        self,
        lines: list[bytes],
        times_ns: list[int],
        nodes: list[int],
        numbers: list[int] | None = None,
    ) -> None:
        """The same for many lines."""
        self._lines += lines
        self._times += times_ns
        self._nodes += nodes
        self._turns += self.gathering.turns(len(lines))
        self._places += numbers or [0] * len(lines)
        if len(self._lines) >= LINES:
            self.flush()

    def add_other(self, text: str, node: str, time_ns: int = 0, number: int = 0) -> None:
        """Read a line about a summary, dropped reports or a name; ``time_ns`` is for complaints."""
        if is_short(text):
            self._add_short(text, node, time_ns, number)
            return
        found = parse_other(text, node, stamped=self._stamped)
        if isinstance(found, Summary):
            self.gathering.add_summary(self.channel, found)
        elif isinstance(found, Drop):
            self._batches.drop(node, found)
        elif isinstance(found, Named):
            self.gathering.add_named(found, node)
        else:
            what = "time is missing" if found is None else f"{found.what}, column {found.column}"
            self._skip(what, time_ns, text, number)

    def _add_short(self, text: str, node: str, time_ns: int, number: int) -> None:
        found: Span | ShortSummary | Malformed
        if text.startswith(SPAN):
            found = parse_span(text)
            self._span = found if isinstance(found, Span) else None
        else:
            found = parse_short(text, self._span, node)
        if isinstance(found, Malformed):
            self._skip(f"{found.what}, column {found.column}", time_ns, text, number)
        elif isinstance(found, ShortSummary):
            self.gathering.add_short(self.channel, found)

    def flush(self) -> None:
        """Hand in everything that was added."""
        if not self._lines:
            return
        times = np.array(self._times, np.int64)
        nodes = np.array(self._nodes, np.int32)
        for part in read_lines(self._lines, stamped=self._stamped):
            if isinstance(part, int):
                self._alone(part)
                continue
            given = times[part.begin : part.end]
            time_ns = given if part.time_ns is None else part.time_ns
            if self._stamped:
                zero = time_ns == 0
                self.unstamped += int(np.count_nonzero(zero))
                time_ns = np.where(zero, given, time_ns)
            key = self.gathering.keys.all(part.keys)[part.key]
            reports = ReportColumns(time_ns, key, part.result, part.cmp, part.thresh, part.res)
            self.gathering.add_events(self.channel, nodes[part.begin : part.end], reports)
        self._lines, self._times, self._nodes = [], [], []
        self._turns, self._places = [], []

    def _alone(self, number: int) -> None:
        """Read one line strictly."""
        text = as_text(self._lines[number])
        time_ns = self._times[number]
        found: Report | Malformed | None
        if self._stamped:
            stamped = parse_stamped(text)
            if isinstance(stamped, Malformed):
                found = stamped
            else:
                stamp_ns, found = stamped
                self.unstamped += not stamp_ns
                time_ns = stamp_ns or time_ns
        else:
            found = parse_report(PREFIX + text)
        if isinstance(found, Report):
            reports = ReportColumns(
                np.array([time_ns], np.int64),
                np.array([self.gathering.keys.code(found.key)], np.int32),
                np.array([found.result]),
                np.array([found.cmp]),
                np.array([found.thresh]),
                np.array([found.res]),
            )
            self.gathering.add_events(self.channel, self._nodes[number], reports)
            return
        what = "no report" if found is None else f"{found.what}, column {found.column}"
        text = self._prefix + text
        self._skip(what, time_ns, text, self._places[number], self._turns[number])

    def _skip(
        self, what: str, time_ns: int, text: str, number: int, turn: int | None = None
    ) -> None:
        if number:
            what = f"line {number}: {what}"
        self.gathering.skip(self.channel.topic, time_ns, what, text, turn)


@dataclass
class Batches:
    """Counts what is missing and what was dropped in numbered messages of several lines."""

    gathering: Gathering
    losses: LossCounter[str] = field(default_factory=LossCounter)
    dropped: dict[tuple[str, int], int] = field(default_factory=dict)
    told: Counter[str] = field(default_factory=Counter)

    def see(self, node: str, batch: BatchHead) -> None:
        """Add the first line of a message."""
        process = (node, batch.pid)
        self.losses.see_batch(node, batch)
        self.dropped[process] = max(self.dropped.get(process, 0), batch.dropped)

    def drop(self, node: str, drop: Drop) -> None:
        """Add a line about dropped reports."""
        self.told[node] += drop.count
        self.gathering.add_dropped(Dropped(drop.key, node, drop.count, drop.flops, drop.why))

    def close(self) -> None:
        """Add the dropped reports that only the totals count."""
        totals: Counter[str] = Counter()
        for (node, _), count in self.dropped.items():
            totals[node] += count
        for node, total in sorted(totals.items()):
            if total > self.told[node]:
                rest = total - self.told[node]
                self.gathering.add_dropped(Dropped("", node, rest, 0, "unknown"))
        self.gathering.lost.update(self.losses.lost)
        self.gathering.late_notes += [
            f"{count:,} reports of {node} were sent before its first one here"
            for node, count in sorted(self.losses.missed_before.items())
        ]
