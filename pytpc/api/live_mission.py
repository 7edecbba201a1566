"""What `pytpc watch` shows: the reports of a running graph, or of a recording as its clock runs."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from rich.text import Text

from pytpc.api.graph_feed import GraphFeed
from pytpc.api.live_diagnosis import LiveDiagnosis
from pytpc.api.live_reports import Item
from pytpc.base.wording import plain
from pytpc.diagnosis.question import Question, Types
from pytpc.diagnosis.ranking.watching import KINDS, KeptRankings, Watching
from pytpc.diagnosis.results.live import Look, Seen
from pytpc.diagnosis.scores.live_scores import LiveRanking
from pytpc.present.marking_terminal import MarkedMission
from pytpc.present.watch_screen import LAYOUTS, Panel, Status, WatchOptions, watch_screen
from pytpc.recording.marking_session import MarkChange, Session, View
from pytpc.recording.mission import ReadName, Recording
from pytpc.recording.summaries import Summary
from pytpc.static.static_info import StaticInfo

__all__ = ["KINDS", "Feed", "RecordedFeed", "WatchedMission", "Watching"]
__all__ += ["fresh_watching"]

_RATE_S = 5.0
# Ranking a hundred comparisons takes a few hundredths of a second; on a busy machine, longer. It is
# done again when so many times as long has passed as it took.
_RANK_S = 0.4
_RANK_SHARE = 5.0
_SNAPSHOT_NS = 30 * 10**9
_MOST_COPIES = 64
_MOST_AT_ONCE = 20_000


def fresh_watching(static_info: StaticInfo, question: Question) -> Watching:
    """The ranking of a mission before its first report.

    If types are ignored, the observer can still choose the tables of both types.
    """
    types: Types = "doubt" if question.types == "doubt" else "believe"
    engine = LiveRanking(static_info, replace(question, types=types))
    return Watching(engine, static_info, question.window_s)


class RecordedFeed:
    """The reports of a recording up to where its clock is, which may go back.

    Args:
        recording: the mission.
        fresh: a ranking without reports.
    """

    live = False
    is_gone = False

    def __init__(self, recording: Recording, fresh: Watching) -> None:
        """The clock is at the beginning; a copy is kept every half minute, to go back to.

        In a long recording there are fewer copies, as each takes memory.
        """
        self._recording = recording
        self._ends = np.argsort(recording.summaries.end_ns, kind="stable")
        self._end_ns = recording.summaries.end_ns[self._ends]
        fresh = fresh.snapshot()
        for name in recording.names:
            fresh.take_name(name)
        self._watching = fresh.snapshot()
        self._place = 0, 0
        self._at_ns = recording.start_ns - 1
        self._copies = [(self._at_ns, self._place, fresh)]
        self._apart_ns = _SNAPSHOT_NS

    def stop(self, now_ns: int | None) -> int | None:
        """How far to `take` at a time on the way to ``now_ns``.

        So copies are kept on the way, and a jump over a million reports can be shown as it goes on.
        """
        if now_ns is None:
            return None
        at_ns = self._at_ns if now_ns >= self._at_ns else self._copy_before(now_ns)[0]
        stop_ns = min(now_ns, at_ns + _SNAPSHOT_NS)
        for times in (self._recording.events.time_ns, self._end_ns):
            most = int(np.searchsorted(times, at_ns, side="right")) + _MOST_AT_ONCE
            if most < times.size:
                stop_ns = min(stop_ns, int(times[most]))
        return stop_ns

    def take(self, now_ns: int | None) -> tuple[Watching, Sequence[Item]]:
        """What happened since the last call; if the clock went back, from a kept copy on."""
        if now_ns is None:
            return self._watching, ()
        if now_ns < self._at_ns:
            self._at_ns, self._place, copy = self._copy_before(now_ns)
            self._watching = copy.snapshot()
        elif self._at_ns >= self._copies[-1][0] + self._apart_ns:
            self._copies.append((self._at_ns, self._place, self._watching.snapshot()))
            if len(self._copies) > _MOST_COPIES:
                del self._copies[1::2]
                self._apart_ns *= 2
        first, second = self._place
        last = int(np.searchsorted(self._recording.events.time_ns, now_ns, side="right"))
        end = int(np.searchsorted(self._end_ns, now_ns, side="right"))
        items: list[Item] = list(_seen(self._recording, first, last))
        items += [_summary(self._recording, int(row)) for row in self._ends[second:end]]
        self._place, self._at_ns = (last, end), now_ns
        return self._watching, items

    def _copy_before(self, now_ns: int) -> tuple[int, tuple[int, int], Watching]:
        """The last copy that is kept of a time up to this one; else the first."""
        return next((one for one in self._copies[::-1] if one[0] <= now_ns), self._copies[0])

    def fault(self) -> str:
        """A recording has no connection to lose."""
        return ""

    def lost(self) -> int:
        """How many messages the recorder never received."""
        return sum(self._recording.lost.values())

    def close(self) -> None:
        """Nothing to do."""


Feed = GraphFeed | RecordedFeed


class WatchedMission:
    """A mission of ``pytpc.present.marking_terminal`` with its live ranking.

    Args:
        mission: the graph or the recording that is marked.
        feed: where its evaluations come from.
        options: what is to be shown.
        believe: whether a mark's type chooses the ranking that is kept at it.
        judged: the diagnosis by all marks so far, beside good runs; None without any.

    Attributes:
        about: further lines to show above the tables; more may be added meanwhile.
        behind_s: how much of a recording was not read yet when the patience of `tick` ended.
    """

    def __init__(
        self,
        mission: MarkedMission,
        feed: Feed,
        options: WatchOptions,
        *,
        believe: bool = True,
        judged: LiveDiagnosis | None = None,
    ) -> None:
        """Nothing is shown yet."""
        self.about: Sequence[str] = ()
        self._judged = judged
        self._mission = mission
        self._feed = feed
        self._options = options
        self._believe = believe
        self._rates: deque[tuple[float, int]] = deque()
        self._look: tuple[float, Look, tuple[object, ...]] | None = None
        self._rank_s = _RANK_S
        self.kept = KeptRankings(options.top)
        self.behind_s = 0.0
        self.watching, _ = feed.take(None)

    @property
    def is_live(self) -> bool:
        """Whether a robot runs, and not a recording."""
        return self._feed.live

    @property
    def is_gone(self) -> bool:
        """Whether the graph does not answer."""
        return self._feed.is_gone

    def now_ns(self) -> int | None:
        """The time that a mark would have now."""
        return self._mission.now_ns()

    def press(self, key: str) -> bool:
        """``v`` changes the tables, ``m`` looks back at the marks, the rest is the mission's."""
        self._look = None
        options = self._options
        if key == "v":
            place = LAYOUTS.index(options.layout) + 1
            self._options = options._replace(layout=LAYOUTS[place % len(LAYOUTS)], back=None)
            return True
        if key == "m":
            newest = len(self.kept) - 1
            back = newest if options.back is None else options.back - 1
            self._options = options._replace(back=back if back >= 0 else None)
            return True
        return self._mission.press(key)

    def view(self) -> View:
        """The mission's own view, with what differs, the verdict so far, and the further lines."""
        view = self._mission.view()
        judged = () if self._judged is None else self._judged.lines
        return view._replace(status=(*view.status, *map(plain, judged), *self.about))

    def send(self, change: MarkChange) -> str:
        """Keep the ranking of this instant, tell the mission, and say who is suspected."""
        self.take()
        if self._judged is not None:
            self._judged.mark(change.apply)
        self.kept.follow(change, self.watching, believe=self._believe)
        self._options = self._options._replace(back=None)
        self._mission.send(change)
        made = change.after is not None and change.before is None
        return self.kept[-1].words() if made else ""

    def tick(self, patience_s: float | None = None) -> None:
        """Take in what has arrived; with ``patience_s``, the rest of it with the next call."""
        self._mission.tick()
        self.take(patience_s)

    def take(self, patience_s: float | None = None) -> None:
        """Take in what has arrived up to now; see `tick`."""
        began_s = time.monotonic()
        now_ns = self.now_ns()
        while True:
            stop_ns = self._feed.stop(now_ns)
            self._take_to(stop_ns)
            if now_ns is None or stop_ns is None or stop_ns >= now_ns:
                self.behind_s = 0.0
                return
            self.behind_s = (now_ns - stop_ns) / 1e9
            if patience_s is not None and time.monotonic() >= began_s + patience_s:
                return

    def _take_to(self, now_ns: int | None) -> None:
        before = self.watching
        self.watching, items = self._feed.take(now_ns)
        if self._judged is not None:
            if self.watching is not before:
                self._judged.restart()
            self._judged.take(items)
            self.watching.differing = self._judged.differing
        for item in items:
            if isinstance(item, Seen):
                self.watching.take(item)
            elif isinstance(item, ReadName):
                self.watching.take_name(item)
            else:
                self.watching.take_summary(item)

    def close(self) -> None:
        """Leave the graph."""
        if self._judged is not None:
            self._judged.close()
        self._feed.close()
        self._mission.close()

    def unheard(self) -> int:
        """How many messages about marks nobody got."""
        return self._mission.unheard()

    def status(self) -> Status:
        """The counts and faults so far."""
        steady_s, evaluations = time.monotonic(), self.watching.evaluations
        self._rates.append((steady_s, evaluations))
        while self._rates[0][0] < steady_s - _RATE_S:
            self._rates.popleft()
        since, before = self._rates[0]
        rate = max(0, evaluations - before) / (steady_s - since) if steady_s > since else 0.0
        return Status(
            evaluations=evaluations,
            rate=rate if self._feed.live else None,
            nodes=len(self.watching.nodes),
            unknown=len(self.watching.unknown),
            lost=self._feed.lost(),
            late=self.watching.late,
            fault=self._feed.fault(),
        )

    def panel(self, now_ns: int, *, utf8: bool) -> Panel:
        """What the screen shows of an instant."""
        options = self._options._replace(utf8=utf8)
        return Panel(self._look_at(now_ns), tuple(self.kept), self.status(), options)

    def _look_at(self, now_ns: int) -> Look:
        """The look of now; worked out again only if anything is new and some time has passed."""
        options = self._options
        watching = self.watching
        of = (
            now_ns,
            watching,
            watching.evaluations,
            watching.differing,
            options.top,
            options.layout,
        )
        steady_s = time.monotonic()
        if self._look is not None:
            since, look, before = self._look
            if of == before or steady_s < since + self._rank_s:
                return look
        look = self.watching.look(now_ns, options.top, options.layout)
        ended_s = time.monotonic()
        self._rank_s = max(_RANK_S, _RANK_SHARE * (ended_s - steady_s))
        self._look = ended_s, look, of
        return look

    def paint(
        self, session: Session, view: View, width: int, height: int, utf8: bool
    ) -> Sequence[Text]:
        """The screen, for ``pytpc.present.marking_terminal.run_marking``."""
        now_ns = view.now_ns if view.now_ns is not None else (self.watching.last_ns or 0)
        return watch_screen(session, view, self.panel(now_ns, utf8=utf8), width, height)


def _seen(recording: Recording, first: int, last: int) -> Iterator[Seen]:
    """Rows ``first`` to ``last`` of the events, as plain numbers."""
    events = recording.events
    rows = slice(first, last)
    columns = (
        events.time_ns[rows].tolist(),
        [events.keys[code] for code in events.key[rows].tolist()],
        [events.nodes[code] for code in events.node[rows].tolist()],
        events.result[rows].tolist(),
        events.cmp[rows].tolist(),
        events.thresh[rows].tolist(),
        events.res[rows].tolist(),
    )
    for values in zip(*columns, strict=True):
        yield Seen(*values)


def _summary(recording: Recording, row: int) -> Summary:
    table = recording.summaries
    values = {name: column[row].item() for name, column in table.columns().items()}
    values["key"], values["node"] = table.keys[table.key[row]], table.nodes[table.node[row]]
    return Summary(**values)
