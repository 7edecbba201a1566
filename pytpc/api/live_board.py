"""What decides now, as plain data: one board for the page of `pytpc live`, and for other programs.

A board is JSON. Its lists have rows with an ``id``, so that a page can be told which ones changed;
all texts are printable. Times are seconds since the begin of the mission
(docs/reference/formats.md#a-board).
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

from pytpc.api.live_mission import WatchedMission
from pytpc.api.live_observers import Answer, Observers
from pytpc.base.wording import plain, show
from pytpc.diagnosis.ranking.turning import Turning
from pytpc.diagnosis.results.live import LiveRow, Seen
from pytpc.diagnosis.results.turn_groups import TurnGroup
from pytpc.diagnosis.results.turning import Compared, NearRow
from pytpc.present.marking_terminal import RecordedMission
from pytpc.present.page.source import source_lines, way_of
from pytpc.present.watch_screen import Panel, score_text, told_apart
from pytpc.recording.marking_session import SPEEDS, View
from pytpc.recording.marks import Mark, MarkType, short_note
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import parameter_name

Board = dict[str, Any]

MOST_ROWS = 50
_MOST_TURNS = 30
_MOST_MARKS = 100
_MOST_CHOICES = 300
_MOST_MEMBERS = 20
_QUIET_S = 3.0
"""Without a report for so long, the page says so: the default sink sends one each second."""
_AGAIN_NS = 500_000_000
"""Without news the rows are made again after so long: time passes in the trends, too."""
_LONGEST = 400
_TITLES: dict[MarkType | None, str] = {
    "I": "Type I: what changed last",
    "II": "Type II: what is near its threshold",
    None: "Both types combined",
}


class LiveBoard:
    """Makes boards of a mission, and does what observers ask for. All calls are of one thread.

    Args:
        watched: the mission with its ranking.
        observers: the sessions of those who mark.
        recorded: the clock of a recording; None for a robot that runs.
        window_s: the window of type II, in seconds.
    """

    def __init__(
        self,
        watched: WatchedMission,
        observers: Observers,
        recorded: RecordedMission | None,
        window_s: float,
    ) -> None:
        """See the class."""
        self.observers = observers
        self.recorded = recorded
        self._watched = watched
        self._window_s = window_s
        self._turning = Turning(window_s)
        self._of: object = None
        self._gone_since: float | None = None
        self._heard: tuple[int, float] = (-1, time.monotonic())
        self._made: tuple[object, Board] | None = None
        self._shown: Board | None = None

    def tick(self, patience_s: float | None = None) -> None:
        """Take in what arrived; see `WatchedMission.tick`."""
        self._watched.tick(patience_s)
        self.observers.flush()
        if not self._watched.is_gone:
            self._gone_since = None
        elif self._gone_since is None:
            self._gone_since = time.time()
        if self._watched.watching.evaluations != self._heard[0]:
            self._heard = self._watched.watching.evaluations, time.monotonic()

    def board(self) -> Board:
        """The board of now."""
        watching = self._watched.watching
        if watching is not self._of:
            # The clock went back: nothing of the old order is left.
            self._of, self._turning = watching, Turning(self._window_s)
        view = self._watched.view()
        now_ns = view.now_ns if view.now_ns is not None else (watching.last_ns or 0)
        marks = self.observers.marks
        of = watching, watching.evaluations, now_ns // _AGAIN_NS, marks, view.places
        passing = {
            "clock": self._clock(view, now_ns),
            "state": self._state(view, self._watched.status().words()),
        }
        if self._watched.behind_s and self._shown is not None:
            return {**passing, **self._shown}
        if self._made is None or self._made[0] != of:
            panel = self._watched.panel(now_ns, utf8=True)
            made = self._comparisons(view, now_ns, marks, panel)
            # The ranking is not worked out each time. One of another moment does not stay.
            behind_ns = abs(now_ns - panel.look.now_ns)
            is_old = behind_ns > (_AGAIN_NS if passing["clock"]["rate"] else 0)
            self._made = None if is_old else (of, made)
            self._shown = made
        return {**passing, **(self._shown or {})}

    def _comparisons(self, view: View, now_ns: int, marks: Sequence[Mark], panel: Panel) -> Board:
        """What is worked out again only if something is new."""
        look = self._turning.look(self._watched.watching, now_ns, MOST_ROWS)
        start_ns = view.start_ns
        kept = {one.mark.order(): one.words() for one in panel.kept}
        groups = _Groups(panel.look.groups)
        return {
            "window_s": self._window_s,
            "near": groups.named(_near_rows(look.near, start_ns)),
            "held": groups.named(_near_rows(look.held, start_ns)),
            "turns": self._turns(look.turns[:_MOST_TURNS], start_ns),
            "suspects": [
                {
                    "id": kind or "combined",
                    "title": _TITLES[kind],
                    "reason": plain(panel.look.reasons[kind]),
                    "rows": groups.joined([_suspect(row, now_ns, start_ns) for row in rows]),
                }
                for kind, rows in panel.look.rows.items()
            ],
            "marks": [
                _mark(mark, start_ns, kept.get(mark.order(), "")) for mark in marks[-_MOST_MARKS:]
            ],
            "places": [
                {"id": plain(place.name), "about": plain(place.about)}
                for place in view.places[:_MOST_CHOICES]
            ],
        }

    def detail(self, key: str, node: str = "") -> Board | None:
        """All about one comparison: its last values in a node, the source around it, and its way.

        None if there is no comparison of this key.
        """
        watching = self._watched.watching
        static = watching.static_info
        found = static.comparisons.get(key)
        if found is None:
            return None
        lines, note = source_lines(static, found)
        return {
            "id": key,
            "parameter": plain(parameter_name(found)),
            "place": plain(f"{found.file}:{found.lineno}"),
            "function": plain(found.function),
            "topic": plain(found.topic or ""),
            "transform": plain(found.transform.text) if found.transform is not None else "",
            "note": plain(note),
            "source": [
                {"number": one.number, "text": plain(one.text), "here": one.here} for one in lines
            ],
            "way": [
                {"place": plain(step.place), "what": plain(step.what), "here": step.here}
                for step in way_of(found)
            ],
            "line": self.line(key, node),
        }

    def line(self, key: str, node: str = "") -> Board:
        """The last values of one comparison in a node, two minutes or more."""
        start_s = self._watched.view().start_ns / 1e9
        times, values, thresholds = self._watched.watching.line_of(key, node)
        return {
            "t": [round(one - start_s, 3) for one in times],
            "value": [_finite(one) for one in values],
            "threshold": [_finite(one) for one in thresholds],
        }

    def mark_time(self, seconds: float | None) -> int | None:
        """The time of a mark whose observer gives it in seconds of the mission; None: now.

        Raises:
            ValueError: it is not in the mission so far; a line that says so.
        """
        now_ns = self._watched.now_ns()
        if seconds is None or now_ns is None:
            return None
        start_ns = self._watched.view().start_ns
        wanted = start_ns + round(seconds * 1e9)
        # The clocks of a page and of this machine do not run alike.
        if not start_ns - 10**9 <= wanted <= now_ns + 10**9:
            raise ValueError("its time is not in this mission: the clock was set back since")
        return min(wanted, now_ns)

    def play(self, what: str, to: float) -> Answer:
        """Move the clock of a recording.

        Args:
            what: ``play``, ``pause``, ``seek`` (to seconds of the mission), ``step`` (by so many
                seconds), ``speed`` (one of ``SPEEDS``, or the next one in this direction).
            to: see ``what``.
        """
        mission = self.recorded
        if mission is None:
            return Answer(False, "a robot that runs has no clock to move")
        player = mission.player
        now_ns = mission.now_ns() or player.start_ns
        if what in ("play", "pause"):
            if what == "play" and now_ns >= player.end_ns:
                mission.go_to(player.start_ns)
            if mission.player.playing != (what == "play"):
                mission.press(" ")
        elif what == "seek":
            mission.go_to(player.start_ns + round(to * 1e9))
        elif what == "step":
            mission.go_to(now_ns + round(to * 1e9))
        elif what == "faster":
            mission.press("+" if to > 0 else "-")
        else:
            wanted = min(SPEEDS, key=lambda speed: abs(speed - to))
            for _ in SPEEDS:
                if mission.player.speed != wanted:
                    mission.press("+" if mission.player.speed < wanted else "-")
        return Answer(True, "")

    def close(self) -> str:
        """Write the last marks and leave the graph; what is wrong, or nothing."""
        wrong = self.observers.close()
        self._watched.close()
        return wrong

    def _clock(self, view: View, now_ns: int) -> Board:
        """``rate`` is how many seconds of the mission pass in one second."""
        found: Board = {
            "now": round((now_ns - view.start_ns) / 1e9, 2),
            "known": view.now_ns is not None,
            "end": None,
            "playing": None,
            "speed": 1.0,
            "rate": 1.0 if view.now_ns is not None else 0.0,
        }
        if self.recorded is not None:
            player = self.recorded.player
            going = player.playing and now_ns < player.end_ns
            found |= {
                "end": (player.end_ns - player.start_ns) / 1e9,
                "playing": going,
                "speed": player.speed,
                "rate": player.speed if going else 0.0,
            }
        return found

    def _state(self, view: View, counts: str) -> Board:
        quiet_s = time.monotonic() - self._heard[1]
        is_quiet = self._watched.is_live and quiet_s > _QUIET_S
        return {
            "title": plain(view.title),
            "lines": [plain(line) for line in view.status],
            "counts": plain(counts),
            "live": self._watched.is_live,
            # When, in seconds since 1970: a page shows it in its own time zone.
            "gone_since": self._gone_since,
            "quiet_since": round(time.time() - quiet_s) if is_quiet else None,
            "unsaved": plain(self.observers.unsaved),
            "behind": round(self._watched.behind_s, 1),
        }

    def _turns(self, turns: Sequence[Seen], start_ns: int) -> list[Board]:
        known = self._watched.watching.static_info.comparisons
        found = []
        alike: Counter[tuple[int, str, str]] = Counter()
        # A loop may turn several times at one instant: the oldest has the first number.
        for seen in reversed(turns):
            comparison = known.get(seen.key)
            if comparison is None:
                continue
            same = seen.time_ns, seen.key, seen.node
            alike[same] += 1
            found.append(
                {
                    "id": f"{seen.key} {plain(seen.node)} {seen.time_ns} {alike[same]}",
                    "at": round((seen.time_ns - start_ns) / 1e9, 2),
                    "result": seen.result,
                    **_about(comparison, seen),
                }
            )
        return found[::-1]


class _Groups:
    """Says at rows which comparisons turn as one with them."""

    def __init__(self, groups: Sequence[TurnGroup]) -> None:
        self._of = {
            (one.key, plain(one.node)): group
            for group in groups
            if len(group.parameters) > 1
            for one in group.members
        }

    def named(self, rows: list[Board]) -> list[Board]:
        """The rows; each names the others of its group."""
        return [row | self._with(row) for row in rows]

    def joined(self, rows: list[Board]) -> list[Board]:
        """The same; one row stands for all of a group, the first one."""
        seen: set[int] = set()
        found = []
        for row in rows:
            group = self._of.get((row["key"], row["node"]))
            if group is None or id(group) not in seen:
                found.append(row | self._with(row))
            if group is not None:
                seen.add(id(group))
        return found

    def _with(self, row: Board) -> Board:
        group = self._of.get((row["key"], row["node"]))
        if group is None:
            return {"members": [], "turning": ""}
        others = [plain(name) for name in group.parameters if plain(name) != row["parameter"]]
        return {"members": others[:_MOST_MEMBERS], "turning": group.text}


def _about(comparison: Comparison, seen: Seen | None) -> Board:
    """What is shown of a comparison wherever it stands."""
    found: Board = {
        "key": comparison.key,
        "parameter": plain(parameter_name(comparison)),
        "relation": plain(comparison.relation),
        "place": plain(f"{comparison.file}:{comparison.lineno}"),
        "code": plain((comparison.source_code or "").strip()[:_LONGEST]),
        "topic": plain(comparison.topic or ""),
        "node": "",
        "value": "",
        "threshold": "",
        "res": None,
    }
    if seen is not None:
        found |= {"node": plain(seen.node), "res": seen.res}
        if comparison.relation != "flag":
            left, right = told_apart(seen.cmp, seen.thresh)
            found |= {"value": left, "threshold": right}
    return found


def _near_rows(rows: Sequence[NearRow], start_ns: int) -> list[Board]:
    """The rows; those of a comparison that runs in several nodes say in which."""
    alike = Counter(row.compared.last.key for row in rows)
    return [_near(row, start_ns, alike[row.compared.last.key] > 1) for row in rows]


def _near(row: NearRow, start_ns: int, is_shared: bool) -> Board:
    one: Compared = row.compared
    return {
        "id": f"{one.last.key} {plain(one.last.node)}",
        **_about(one.comparison, one.last),
        "shared": is_shared,
        "result": one.last.result,
        "margin": "" if row.margin is None else show(float(f"{row.margin:.3g}")),
        "in_unit": row.in_unit,
        "share": None if row.share is None else round(min(1.0, row.share), 4),
        "last": round((one.last.time_ns - start_ns) / 1e9, 1),
        "since": round((one.since_ns - start_ns) / 1e9, 1),
        "trend": [
            None if math.isnan(part.distance) else round(part.distance, 3) for part in one.parts
        ],
        "flops": [part.flopped for part in one.parts],
    }


def _suspect(row: LiveRow, now_ns: int, start_ns: int) -> Board:
    suspect = row.suspect
    flop = None if row.flop_s is None else round((now_ns - start_ns) / 1e9 - row.flop_s, 1)
    return {
        "id": plain(suspect.parameter),
        **_about(suspect.comparison, row.last),
        "parameter": plain(suspect.parameter),
        "position": f"{suspect.position}{'=' if suspect.tied else ''}",
        "score": score_text(suspect.score),
        "type": suspect.type,
        "flop": flop,
    }


def _mark(mark: Mark, start_ns: int, words: str) -> Board:
    return {
        "id": f"{mark.time_ns} {plain(mark.observer)} {mark.type or ''}",
        "at": round((mark.time_ns - start_ns) / 1e9, 2),
        "type": mark.type or "",
        "observer": plain(mark.observer),
        "note": plain(short_note(mark.note)),
        "remark": plain(short_note(mark.remark)),
        "suspects": plain(words),
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
