"""The live diagnosis of a running mission: evaluations in, what to show about the suspects out.

The scores are those of `pytpc.diagnosis.scores.live_scores`. In addition this keeps the last values
of each comparison, its last flop, and how near it came to its threshold.
"""

from __future__ import annotations

import copy
import math
from array import array
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from pytpc.diagnosis.full_names import is_of_ros2, with_full_names
from pytpc.diagnosis.question import WINDOW_S
from pytpc.diagnosis.ranking.live_groups import LiveGroups
from pytpc.diagnosis.results.live import Kept, LiveRow, Look, Seen, TrendPart
from pytpc.diagnosis.results.suspects import MarkRanking, Suspect
from pytpc.diagnosis.results.turn_groups import TurnGroup
from pytpc.diagnosis.results.turning import Compared
from pytpc.diagnosis.scores.live_scores import LiveRanking
from pytpc.recording.events import Events
from pytpc.recording.marking_session import MarkChange
from pytpc.recording.marks import Mark, MarkType
from pytpc.recording.mission import ReadName, Recording
from pytpc.recording.summaries import Summary
from pytpc.static.parameters import base_key, parameter_name
from pytpc.static.static_info import StaticInfo

BINS = 8
"""The number of parts of the window that are shown of each comparison."""

_MOST_TURNS = 50
_LINE_PART, _LINE_PARTS = 60, 8
_LINE_STEP_S = 0.25
"""At least so far apart are the kept values of a comparison: two minutes, or more of summaries."""

_MOST_WAITING = 100_000
_NOBODY: frozenset[str] = frozenset()
"""So many reports of new instances wait for a look."""

KINDS: tuple[MarkType | None, ...] = ("I", "II", None)


@dataclass(slots=True)
class _Bin:
    """Sums over one part of time."""

    total: float = 0.0
    count: int = 0
    flops: int = 0


@dataclass(slots=True)
class _Line:
    """The last values as time (s), cmp, thresh, one after the other.

    What is full never changes, so that all copies of a mission share it.
    """

    full: tuple[bytes, ...] = ()
    rest: array[float] = field(default_factory=lambda: array("d"))
    until_s: float = -math.inf

    def draw(self, seen: Seen) -> None:
        """Keep the values, unless the last ones are just before."""
        seconds = seen.time_ns / 1e9
        if seconds < self.until_s + _LINE_STEP_S:
            return
        self.until_s = seconds
        self.rest.extend((seconds, seen.cmp, seen.thresh))
        if len(self.rest) >= 3 * _LINE_PART:
            self.full = (*self.full, self.rest.tobytes())[-_LINE_PARTS:]
            self.rest = array("d")

    def values(self) -> array[float]:
        """All that is kept."""
        found = array("d")
        found.frombytes(b"".join(self.full))
        return found + self.rest


@dataclass(slots=True)
class _Track:
    """What is kept of one comparison, however long the mission is."""

    last: Seen | None = None
    flop_ns: int | None = None
    results: dict[str, tuple[int, bool]] = field(default_factory=dict)
    low: float = math.inf
    high: float = -math.inf
    bins: dict[int, _Bin] = field(default_factory=dict)
    since: dict[str, tuple[int, bool]] = field(default_factory=dict)
    """By node: since when it has had its present result."""
    lasts: dict[str, Seen] = field(default_factory=dict)
    """By node: its last evaluation."""
    lines: dict[str, _Line] = field(default_factory=dict)
    """By node: its last values."""

    def draw(self, seen: Seen) -> None:
        """Keep what is shown of its node."""
        known = self.lasts.get(seen.node)
        if known is not None and known.time_ns > seen.time_ns:
            return
        self.lasts[seen.node] = seen
        line = self.lines.get(seen.node)
        if line is None:
            line = self.lines[seen.node] = _Line()
        line.draw(seen)


class Watching:
    """The state of a mission at its last evaluation.

    Args:
        engine: the live scores, without a report yet.
        static_info: what the analysis found.
        window_s: the window of type II, in seconds.
    """

    def __init__(
        self, engine: LiveRanking, static_info: StaticInfo, window_s: float = WINDOW_S
    ) -> None:
        """Start without an evaluation."""
        self._engine = engine
        self.static_info = static_info
        self._given = static_info
        self._known = static_info.comparisons
        self._instances: set[str] = set()
        self._learned: frozenset[str] = frozenset()
        self._waiting: list[Seen | Summary] = []
        self._names: set[ReadName] = set()
        self._has_new_names = False
        self._of_ros2 = frozenset(
            one.key
            for unit in static_info.units
            for one in unit.comparisons
            if is_of_ros2(one, unit)
        )
        # By key; they complete the names of parameters of ROS 2.
        self._nodes: dict[str, frozenset[str]] = {}
        self._bin_ns = max(1, round(window_s * 1e9) // BINS)
        self._tracks: dict[str, _Track] = {}
        self.differing: frozenset[str] = frozenset()
        """Parameters that differ from good runs: they come before all others."""
        self.evaluations = 0
        self.last_ns: int | None = None
        self.nodes: set[str] = set()
        self.turns: deque[Seen] = deque(maxlen=_MOST_TURNS)
        """The last flops, the newest last."""
        self._groups = LiveGroups()
        self.unknown: dict[str, int] = {}

    @property
    def late(self) -> int:
        """How many evaluations arrived too late to count."""
        return self._engine.scores.late

    def take(self, seen: Seen) -> None:
        """Take in an evaluation; those of unknown comparisons are only counted."""
        self._note(seen.time_ns, seen.node)
        self.evaluations += 1
        if self._knows(seen):
            self._add(seen)

    def _add(self, seen: Seen) -> None:
        self._engine.scores.add(*seen)
        track = self._tracks.setdefault(seen.key, _Track())
        part = self._bin(track, seen.time_ns)
        before = track.results.get(seen.node)
        if before is None or before[0] <= seen.time_ns:
            if before is not None and before[1] != seen.result:
                track.flop_ns = max(seen.time_ns, track.flop_ns or seen.time_ns)
                part.flops += 1
                self.turns.append(seen)
                self._groups.turned(seen.key, seen.node, seen.time_ns)
            track.results[seen.node] = seen.time_ns, seen.result
            if before is None or before[1] != seen.result:
                track.since[seen.node] = seen.time_ns, seen.result
        track.draw(seen)
        if track.last is None or track.last.time_ns <= seen.time_ns:
            track.last = seen
        difference = abs(seen.cmp - seen.thresh)
        if math.isfinite(difference):
            part.total += difference
            part.count += 1
            track.low = min(track.low, seen.cmp, seen.thresh)
            track.high = max(track.high, seen.cmp, seen.thresh)

    def take_summary(self, summary: Summary) -> None:
        """Take in a summary of many evaluations; its flops arrive as evaluations."""
        self._note(summary.end_ns, summary.node)
        self.evaluations += summary.count
        if self._knows(summary):
            self._add_summary(summary)

    def _add_summary(self, summary: Summary) -> None:
        self._engine.scores.add_summary(summary)
        track = self._tracks.setdefault(summary.key, _Track())
        values = summary.result, summary.cmp, summary.thresh, summary.res
        last = Seen(summary.end_ns, summary.key, summary.node, *values)
        track.draw(last)
        if track.last is None or track.last.time_ns <= summary.end_ns:
            track.last = last
        self._note_result(track, summary)
        finite = summary.count - summary.odd
        if finite and math.isfinite(summary.abs_mean):
            part = self._bin(track, summary.end_ns)
            part.total += summary.abs_mean * finite
            part.count += finite
            track.low = min(track.low, summary.low)
            track.high = max(track.high, summary.high)

    @staticmethod
    def _note_result(track: _Track, summary: Summary) -> None:
        """Since when a node has had its result, where flops were not reported one by one."""
        since = track.since.get(summary.node)
        if since is None:
            track.since[summary.node] = summary.begin_ns, summary.result
        elif summary.end_ns >= since[0] and (
            since[1] != summary.result or (summary.flops and since[0] < summary.begin_ns)
        ):
            track.since[summary.node] = summary.end_ns, summary.result

    def take_name(self, name: ReadName) -> None:
        """Take in the name of a parameter; nodes repeat them."""
        if name not in self._names:
            self._names.add(name)
            self._has_new_names = True

    def _knows(self, report: Seen | Summary) -> bool:
        """Whether the analysis has found this comparison; then so it has each of its instances.

        The reports of a new instance wait for the next look: learning takes about as long for one
        as for hundreds.
        """
        key = report.key
        if report.node not in self._nodes.get(key, _NOBODY):
            self._note_node(key, report.node)
        if key in self._known:
            return True
        if base_key(key) in self._known and key not in self._learned:
            self._instances.add(key)
            self._waiting.append(report)
            if len(self._waiting) >= _MOST_WAITING:
                self._learn()
            return False
        count = report.count if isinstance(report, Summary) else 1
        self.unknown[key] = self.unknown.get(key, 0) + count
        return False

    def _note_node(self, key: str, node: str) -> None:
        self._nodes[key] = self._nodes.get(key, _NOBODY) | {node}
        self._has_new_names |= base_key(key) in self._of_ros2

    def _learn(self) -> None:
        """Give the instances that were seen, and the names that were told, to the ranking."""
        keys = Events.empty(sorted(self._instances))
        told = Recording("", keys, (), 0, 0, names=tuple(sorted(self._names)))
        nodes = {k: some for k, some in self._nodes.items() if base_key(k) in self._of_ros2}
        self.static_info = with_full_names(self._given, told, {}, nodes)
        self._known = self.static_info.comparisons
        self._engine.learn(self.static_info)
        self._has_new_names = False
        self._learned = frozenset(self._instances)
        waiting, self._waiting = self._waiting, []
        for report in waiting:
            if not self._knows(report):
                continue
            if isinstance(report, Summary):
                self._add_summary(report)
            else:
                self._add(report)

    def ranking_at(self, mark: Mark) -> MarkRanking:
        """The suspects at an instant, by `LiveRanking.ranking_at` and by what differs."""
        if self._has_new_names or self._waiting:
            self._learn()
        return self._ordered(self._engine.ranking_at(mark))

    def _ordered(self, ranking: MarkRanking) -> MarkRanking:
        return ranking.with_first(self.differing) if self.differing else ranking

    def look(self, now_ns: int, top: int, kinds: Sequence[MarkType | None] = KINDS) -> Look:
        """What to show now: the first ``top`` suspects of each of ``kinds``."""
        if self._has_new_names or self._waiting:
            self._learn()
        marks = [Mark(now_ns, kind) for kind in kinds]
        found = map(self._ordered, self._engine.rankings_at(now_ns, marks))
        return self.look_of(dict(zip(kinds, found, strict=True)), now_ns, top)

    def look_of(
        self, rankings: Mapping[MarkType | None, MarkRanking], now_ns: int, top: int
    ) -> Look:
        """The same for rankings that exist already."""
        return Look(
            now_ns,
            {
                kind: tuple(self._row(one, now_ns) for one in ranking.suspects[:top])
                for kind, ranking in rankings.items()
            },
            {kind: "" if r.enough else r.reason for kind, r in rankings.items()},
            max((ranking.parameters for ranking in rankings.values()), default=0),
            self.groups(now_ns),
        )

    def compared(self, now_ns: int, recent_s: float) -> list[Compared]:
        """The comparisons with parameters that were evaluated within the last ``recent_s``.

        One that runs in several nodes is there once for each.
        """
        if self._has_new_names or self._waiting:
            self._learn()
        earliest = now_ns - round(recent_s * 1e9)
        found = []
        for key, track in self._tracks.items():
            comparison = self._known.get(key)
            if comparison is None or comparison.type == "constant":
                continue
            recent = [last for last in track.lasts.values() if last.time_ns >= earliest]
            if not recent:
                continue
            spread = track.high - track.low
            parts = self._parts(track, now_ns)
            name = parameter_name(comparison)
            for last in recent:
                since_ns, _ = track.since.get(last.node, (last.time_ns, last.result))
                whole = spread if spread > 0 else 0.0
                found.append(Compared(comparison, name, last, since_ns, whole, parts))
        return found

    def groups(self, now_ns: int) -> tuple[TurnGroup, ...]:
        """The comparisons that turn as one, by the turns of the last minutes."""

        def name_of(key: str) -> str | None:
            found = self._known.get(key)
            return None if found is None else parameter_name(found)

        return self._groups.groups(now_ns, name_of)

    def line_of(self, key: str, node: str) -> tuple[list[float], list[float], list[float]]:
        """The last values of a comparison: times (s), compared values, thresholds.

        Those in ``node``; if it has none, in the node that was the last to report.
        """
        track = self._tracks.get(key)
        line = None
        if track is not None and track.last is not None:
            line = track.lines.get(node, track.lines.get(track.last.node))
        values = array("d") if line is None else line.values()
        return values[::3].tolist(), values[1::3].tolist(), values[2::3].tolist()

    def snapshot(self) -> Watching:
        """An independent copy, which shares what the analysis found."""
        shared: Iterable[object] = (
            self.static_info,
            self._given,
            self._known,
            *self._known.values(),
        )
        return copy.deepcopy(self, {id(one): one for one in shared})

    def _note(self, time_ns: int, node: str) -> None:
        self.nodes.add(node)
        self.last_ns = time_ns if self.last_ns is None else max(self.last_ns, time_ns)

    def _bin(self, track: _Track, time_ns: int) -> _Bin:
        number = time_ns // self._bin_ns
        part = track.bins.get(number)
        if part is None:
            part = track.bins[number] = _Bin()
            newest = max(track.bins)
            for old in [one for one in track.bins if one <= newest - 2 * BINS]:
                del track.bins[old]
        return part

    def _row(self, suspect: Suspect, now_ns: int) -> LiveRow:
        track = self._tracks.get(suspect.key, _Track())
        flop_s = None if track.flop_ns is None else max(0, now_ns - track.flop_ns) / 1e9
        return LiveRow(suspect, track.last, flop_s, self._parts(track, now_ns))

    def _parts(self, track: _Track, now_ns: int) -> tuple[TrendPart, ...]:
        newest = now_ns // self._bin_ns
        spread = track.high - track.low
        parts = []
        for number in range(newest - BINS + 1, newest + 1):
            part = track.bins.get(number, _Bin())
            known = part.count > 0 and spread > 0
            mean = part.total / part.count / spread if known else math.nan
            parts.append(TrendPart(min(1.0, mean) if known else math.nan, part.flops > 0))
        return tuple(parts)


class KeptRankings(list[Kept]):
    """The rankings at the marks of a session, in the order in which they were made."""

    def __init__(self, top: int) -> None:
        """``top`` is how many suspects of each are kept."""
        super().__init__()
        self._top = top

    def follow(self, change: MarkChange, watching: Watching, *, believe: bool = True) -> None:
        """Follow a mark that was made, taken back or noted."""
        before, after = change
        if before is not None and after is not None:
            self[:] = [one._replace(mark=after) if one.mark == before else one for one in self]
        elif before is not None:
            self[:] = [one for one in self if one.mark != before]
        elif after is not None:
            asked = after if believe else Mark(after.time_ns, None)
            ranking = watching.ranking_at(asked)
            look = watching.look_of({after.type: ranking}, after.time_ns, self._top)
            self.append(Kept(after, ranking, look))
