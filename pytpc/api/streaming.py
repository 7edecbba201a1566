"""Passes on what a robot decides now: to a viewer of Rerun's, and to /diagnostics."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from typing import NamedTuple, Protocol

import numpy as np

from pytpc.api.exporting import mark_line, suspects_at, verdict_line
from pytpc.api.graph_feed import GraphFeed
from pytpc.api.live_diagnosis import LiveDiagnosis
from pytpc.api.live_mission import Feed
from pytpc.api.live_reports import Item
from pytpc.api.live_series import LiveSeries
from pytpc.api.node_health import NodeHealth, suspects_status
from pytpc.base.columns import Int64s
from pytpc.base.errors import TpcError
from pytpc.diagnosis.ranking.watching import Watching
from pytpc.diagnosis.results.exported import ComparisonSeries
from pytpc.diagnosis.results.live import Seen
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.present.viewers.rerun_export import RerunViewer, blueprint, path_of
from pytpc.recording.marks import Mark
from pytpc.recording.mission import ReadName
from pytpc.ros.diagnostic_messages import DiagnosticStatus
from pytpc.ros.graphs import nodes_at
from pytpc.ros.node_status import NodeStatus

_RANK_S = 1.0
_REACH_S = 1.0
_REACH_PATIENCE_S = 0.2
_CLOSE_S = 5.0
_LAYOUT_S = 10.0
_SETTINGS_S = 15.0
_SHOWN = 3
_RANKED = 10


class Outlet(Protocol):
    """Where the stream goes."""

    def take(self, now: Moment) -> None:
        """Take what is new; called about ten times a second."""

    def close(self) -> None:
        """Send what waits, and end."""


class Moment(NamedTuple):
    """What is known at one time.

    ``items`` came since the last moment. ``ranking`` is that of marks without a type, worked out
    once a second.
    """

    now_ns: int | None
    items: Sequence[Item]
    watching: Watching
    ranking: MarkRanking | None
    marks: tuple[Mark, ...]
    judged: LiveDiagnosis
    fault: str


class Stream:
    """Takes reports and marks in, and passes each moment to all outlets.

    Args:
        feed: where the reports come from.
        clock: the time of the graph or the recording; None: it has none yet.
        marks: the marks so far.
        judged: the diagnosis, worked out in a thread of its own.
        outlets: where it goes.
    """

    def __init__(
        self,
        feed: Feed,
        clock: Callable[[], int | None],
        marks: Callable[[], tuple[Mark, ...]],
        judged: LiveDiagnosis,
        outlets: Sequence[Outlet],
    ) -> None:
        """Nothing is passed on yet."""
        self._feed = feed
        self._clock = clock
        self._marks = marks
        self._judged = judged
        self._outlets = outlets
        self._watching, _ = feed.take(None)
        self._known: tuple[Mark, ...] = ()
        self._ranking: MarkRanking | None = None
        self._ranked_s = 0.0

    @property
    def evaluations(self) -> int:
        """How many came, also in summaries."""
        return self._watching.evaluations

    @property
    def why_gone(self) -> str:
        """Why the graph did not answer the last time that it was asked; empty if it did."""
        return self._feed.fault() if self._feed.is_gone else ""

    @property
    def is_judged(self) -> bool:
        """Whether the verdict by all marks so far is there."""
        asked = self._judged.found
        return not self._known or (
            asked is not None and len(asked.run.recording.marks) == len(self._known)
        )

    def tick(self) -> None:
        """Take in what has come, and pass it on."""
        now_ns = self._clock()
        before = self._watching
        self._watching, items = self._feed.take(now_ns)
        if self._watching is not before:
            self._judged.restart()
        self._judged.take(items)
        for item in items:
            if isinstance(item, Seen):
                self._watching.take(item)
            elif isinstance(item, ReadName):
                self._watching.take_name(item)
            else:
                self._watching.take_summary(item)
        marks = self._marks()
        if marks != self._known:
            self._known = marks
            self._judged.mark(lambda _: marks)
        self._rank(now_ns)
        moment = Moment(
            now_ns, items, self._watching, self._ranking, marks, self._judged, self._feed.fault()
        )
        for outlet in self._outlets:
            outlet.take(moment)

    def _rank(self, now_ns: int | None) -> None:
        steady_s = time.monotonic()
        if now_ns is not None and steady_s >= self._ranked_s + _RANK_S:
            self._ranking = self._watching.ranking_at(Mark(now_ns, None))
            self._ranked_s = steady_s

    def close(self) -> None:
        """Leave the graph and the outlets."""
        self._judged.close()
        self._feed.close()
        for outlet in self._outlets:
            outlet.close()


class RerunOutlet:
    """Shows the stream in a viewer of Rerun's; `left_out` counts what was too much to show.

    Args:
        viewer: is connected already.
        rr: Rerun's module.

    Attributes:
        is_gone: the viewer ended, and gets nothing any more.
    """

    def __init__(self, viewer: RerunViewer, rr: object) -> None:
        """Nothing is shown yet."""
        self._viewer = viewer
        self._rr = rr
        self._live = LiveSeries()
        self._results: Int64s = np.empty(0, np.int64)
        self._ranked: MarkRanking | None = None
        self._marks: tuple[Mark, ...] = ()
        self._verdict: object = None
        self._shown: tuple[ComparisonSeries, ...] | None = None
        self._layout_s = 0.0
        self._reached_s = time.monotonic()
        self.is_gone = False

    @property
    def left_out(self) -> int:
        """How many evaluations were not shown."""
        return self._live.left_out

    def take(self, now: Moment) -> None:
        """Send the evaluations; once a second the ranks, and what is new of the rest."""
        if self.is_gone or not self._reaches():
            return
        viewer = self._viewer
        rows, new = self._live.rows(now.items, now.watching.static_info.comparisons)
        if new:
            viewer.describe(new)
            self._results = np.append(self._results, np.full(len(new), -1, np.int64))
        if rows.time_ns.size:
            viewer.add_rows(self._live.series, rows, self._results)
        if now.ranking is not self._ranked and now.now_ns is not None:
            self._ranked = now.ranking
            self._add_ranks(now.ranking, now.now_ns)
        if now.marks != self._marks:
            known = set(self._marks)
            viewer.add_lines([mark_line(mark) for mark in now.marks if mark not in known])
            self._marks = now.marks
        self._add_verdict(now)
        self._arrange(now)

    def close(self) -> None:
        """Send what waits, if the viewer is there and takes it."""
        try:
            self._viewer.close(0.0 if self.is_gone else _CLOSE_S)
        except RuntimeError:
            self.is_gone = True

    def _reaches(self) -> bool:
        """Look once a second whether the viewer is there."""
        steady_s = time.monotonic()
        if steady_s >= self._reached_s + _REACH_S:
            self.is_gone = not self._viewer.reaches(_REACH_PATIENCE_S)
            self._reached_s = time.monotonic()
        return not self.is_gone

    def _add_ranks(self, ranking: MarkRanking | None, now_ns: int) -> None:
        times = np.array([now_ns], np.int64)
        for one in () if ranking is None else ranking.suspects[:_RANKED]:
            path = path_of(self._live.topic("ranks", one.parameter))
            self._viewer.add_scalars(path, times, [one.rank])

    def _add_verdict(self, now: Moment) -> None:
        asked = now.judged.found
        if asked is None or asked is self._verdict or not asked.run.recording.marks:
            return
        self._verdict = asked
        marks = asked.run.recording.marks
        last = marks[-1]
        found = suspects_at(last, len(marks), asked.diagnosis, self._live.of_key)
        if now.now_ns is not None:
            found = found._replace(time_ns=max(found.time_ns, now.now_ns))
        self._viewer.add_suspects(found)
        self._viewer.add_lines([verdict_line(found)])
        times = np.array([found.time_ns], np.int64)
        for one in found.suspects[:_RANKED]:
            path = path_of(self._live.topic("probabilities", one.parameter))
            self._viewer.add_scalars(path, times, [one.probability])

    def _arrange(self, now: Moment) -> None:
        """Show the first suspects, by the marks or else by the ranks; not too often others."""
        steady_s = time.monotonic()
        if self._shown and steady_s < self._layout_s + _LAYOUT_S:
            return
        asked = now.judged.found
        keys: list[str | None] = []
        if asked is not None and asked.run.recording.marks:
            keys = [one.key for one in asked.diagnosis.blame.suspects]
        elif now.ranking is not None:
            keys = [one.key for one in now.ranking.suspects]
        numbers = [number for key in keys for number in self._live.of_key(key)[:1]][:_SHOWN]
        shown = tuple(self._live.series[number] for number in numbers)
        if shown and shown != self._shown:
            self._shown, self._layout_s = shown, steady_s
            self._viewer.stream.send_blueprint(blueprint(self._rr, shown))


class Publishes(Protocol):
    """What publishes diagnostics: `pytpc.ros.stream_side.StreamSide`."""

    fault: str

    def publish(self, statuses: Sequence[DiagnosticStatus]) -> None:
        """Publish the state of all things."""


class DiagnosticsOutlet:
    """Publishes the state of each node that reports, and the suspects, once a second.

    Args:
        side: publishes.
        feed: knows what was dropped.
        address: of the graph, whose nodes are asked for their settings every 15 seconds.
        period_s: how often it publishes.
    """

    def __init__(
        self, side: Publishes, feed: GraphFeed, address: str, period_s: float = 1.0
    ) -> None:
        """Ask the nodes in a thread of its own."""
        self._side = side
        self._feed = feed
        self._address = address
        self._period_s = period_s
        self._health = NodeHealth()
        self._due_s = 0.0
        self._settings: dict[str, NodeStatus] = {}
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._ask, name="settings", daemon=True)
        self._thread.start()

    def take(self, now: Moment) -> None:
        """Count what came, and publish if it is time."""
        steady_s = time.monotonic()
        for item in now.items:
            if isinstance(item, ReadName):
                continue
            evaluations = 1 if isinstance(item, Seen) else item.count
            self._health.see(item.node, evaluations, steady_s)
        if steady_s < self._due_s:
            return
        self._due_s = steady_s + self._period_s
        self._health.tell_settings(self._settings, steady_s)
        self._health.tell_dropped(self._feed.dropped(), steady_s)
        asked = now.judged.found
        is_judged = asked is not None and bool(asked.run.recording.marks)
        diagnosis = asked.diagnosis if asked is not None and is_judged else None
        fault = now.fault or self._side.fault
        suspects = suspects_status(diagnosis, now.ranking, len(now.marks), fault)
        self._side.publish([suspects, *self._health.statuses(steady_s)])

    def close(self) -> None:
        """Ask no more."""
        self._ended.set()

    def _ask(self) -> None:
        """Keep up what the nodes say of their settings; the graph may come and go."""
        while not self._ended.is_set():
            try:
                with closing(nodes_at(self._address)) as nodes:
                    while not self._ended.is_set():
                        found = nodes.reload_all(nodes.names())
                        self._settings = {one.node: one for one in found}
                        self._ended.wait(_SETTINGS_S)
            except TpcError:
                self._ended.wait(_SETTINGS_S)
