"""What a person beside a robot knows: from what is seen to what is wrong.

A robot's observer derives from ``Rules`` and says in ``judge`` what it takes for wrong. What people
make of it, and when they press a key, stands in ``person`` (one person, live) and in ``crowd``
(several, from a recording). Both see the same findings, sight by sight: a rule knows nothing of
what comes later.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

KIND_I = "I"
KIND_II = "II"

MOVING_M_S = 0.3


@dataclass(frozen=True)
class Look:
    """What is seen of any robot at one moment: time in s, its place in m.

    A robot's sight adds floats, ints and bools. What happens at a moment (a camera clicks) is a
    counter, so that a table of sights holds all that was seen.
    """

    time: float
    x: float
    y: float
    z: float


SightT = TypeVar("SightT", bound=Look)


@dataclass(frozen=True)
class Wrong:
    """Kind I: the time in s at which the robot did what it should not."""

    time: float
    reason: str


@dataclass(frozen=True)
class Waiting:
    """Kind II: the robot does not do what it should, since a time in s."""

    since: float
    reason: str


@dataclass(frozen=True)
class Finding:
    """What the rules make of one sight."""

    wrong: tuple[Wrong, ...]
    waiting: Waiting | None


@dataclass(frozen=True)
class Cause:
    """Why a person may press a key; ``start`` and ``end`` in s of simulated time.

    Kind "I" is a moment (``end`` is ``start``), kind "II" lasts until the robot went on.
    """

    kind: str
    start: float
    end: float
    reason: str


class Rules(Generic[SightT]):
    """From sights to findings; time runs forwards only.

    A robot's rules call in ``judge`` what is wrong. ``recent`` are the sights of the last
    ``window_s`` seconds; a wait that is shorter than ``patience_s`` is none.
    """

    window_s = 1.0
    patience_s = 4.0

    def __init__(self) -> None:
        """The mission has not begun."""
        self.recent: deque[SightT] = deque()
        self._wrong: list[Wrong] = []
        self._missing: str | None = None
        self._waits_since: float | None = None

    def see(self, sight: SightT) -> Finding:
        """Take in one sight; return what is wrong at it."""
        self.recent.append(sight)
        while sight.time - self.recent[0].time > self.window_s:
            self.recent.popleft()
        self._wrong, self._missing = [], None
        self.judge(sight)
        if self._missing is None:
            self._waits_since = None
            return Finding(tuple(self._wrong), None)
        if self._waits_since is None:
            self._waits_since = sight.time
        return Finding(tuple(self._wrong), Waiting(self._waits_since, self._missing))

    def judge(self, sight: SightT) -> None:
        """Call ``wrong`` and ``waiting`` for what is wrong at this sight."""
        raise NotImplementedError

    def wrong(self, time: float, reason: str) -> None:
        """Kind I: at ``time``, now or shortly before, the robot did what it should not."""
        self._wrong.append(Wrong(time, reason))

    def waiting(self, missing: bool, reason: str) -> None:
        """Kind II: whether, at this sight, the robot does not do what it should.

        A wait lasts while one of the rules says so at each sight. Where several do, the reason
        is that of the first.
        """
        if missing and self._missing is None:
            self._missing = reason

    def elapsed(self) -> float:
        """Seconds from the first to the last of the recent sights."""
        return self.recent[-1].time - self.recent[0].time

    def moving(self) -> bool:
        """Whether the robot is seen to move over the ground."""
        first, last = self.recent[0], self.recent[-1]
        if self.elapsed() <= 0.0:
            return False
        return math.hypot(last.x - first.x, last.y - first.y) / self.elapsed() > MOVING_M_S


def causes_of(rules: Rules[SightT], sights: Iterable[SightT]) -> list[Cause]:
    """What was wrong in a whole mission, in the order of its begin.

    A wait that never ended ends with the last sight; it has the reason it began with.
    """
    causes: list[Cause] = []
    begun: Waiting | None = None
    now = 0.0

    def end_wait(end: float) -> None:
        if begun is not None and end - begun.since >= rules.patience_s:
            causes.append(Cause(KIND_II, begun.since, end, begun.reason))

    for sight in sights:
        now = sight.time
        finding = rules.see(sight)
        causes += [Cause(KIND_I, each.time, each.time, each.reason) for each in finding.wrong]
        if finding.waiting is None:
            end_wait(now)
            begun = None
        elif begun is None:
            begun = finding.waiting
    end_wait(now)
    return sorted(causes, key=lambda cause: (cause.start, cause.kind))
