"""A person beside a robot who presses a key when something is wrong: what all of them share.

``/mark_action`` is "it did what it should not" (type I), ``/mark_no_action`` "it does not do what
it should" (type II). The time in a mark is the simulated time at which the key was pressed, a
human's delay after the cause. What the person makes of what it sees stands with each robot.
"""

from __future__ import annotations

import math
import random
from collections import deque
from dataclasses import dataclass
from typing import Generic, TypeVar

TYPE_I = "mark_action"
TYPE_II = "mark_no_action"

REACTION_MEDIAN_S = 2.5  # thesis, table 6.14: 1 to 4 s where the error was plain to see
REACTION_SIGMA = 0.4
PATIENCE_S = (7.0, 1.0)  # with the reaction the 7 to 10 s of table 6.14, type II
REPEAT_S = (4.0, 9.0)
MOVING_M_S = 0.3


@dataclass(frozen=True)
class Look:
    """What is seen of any robot at one moment: time in s, its place in m."""

    time: float
    x: float
    y: float
    z: float


SightT = TypeVar("SightT", bound=Look)


@dataclass(frozen=True)
class Mark:
    """A key press: simulated time in s, and which key."""

    time: float
    topic: str
    reason: str


class Person(Generic[SightT]):
    """Turns sights into marks; time runs forwards only.

    A robot's observer says in ``judge`` what is wrong. ``recent`` are the sights of the last
    ``window_s`` seconds, ``least_patience_s`` is how long this person waits at least.
    """

    window_s = 1.0
    least_patience_s = 4.0

    def __init__(self, seed: int) -> None:
        """``seed`` is for the delays of this person."""
        self._random = random.Random(seed)
        self._pending: list[Mark] = []
        self._waiting_until: float | None = None
        self.recent: deque[SightT] = deque()

    def see(self, sight: SightT) -> list[Mark]:
        """Take in one sight; return the keys that were pressed until it."""
        self.recent.append(sight)
        while sight.time - self.recent[0].time > self.window_s:
            self.recent.popleft()
        self.judge(sight)
        pressed = [mark for mark in self._pending if mark.time <= sight.time]
        self._pending = [mark for mark in self._pending if mark.time > sight.time]
        return sorted(pressed, key=lambda mark: mark.time)

    def judge(self, sight: SightT) -> None:
        """Press keys for what is wrong."""
        raise NotImplementedError

    def press(self, topic: str, cause: float, reason: str) -> None:
        """Press a key, a reaction's time after the cause."""
        delay = self._random.lognormvariate(math.log(REACTION_MEDIAN_S), REACTION_SIGMA)
        self._pending.append(Mark(cause + delay, topic, reason))

    def wait(self, sight: SightT, waiting: bool, reason: str) -> None:
        """Wait for what does not come: with patience, then pressing again and again.

        Where there is nothing to wait for any more, the hand leaves the key.
        """
        if not waiting:
            if self._waiting_until is not None:
                self.give_up()
            self._waiting_until = None
            return
        if self._waiting_until is None:
            patience = max(self.least_patience_s, self._random.gauss(*PATIENCE_S))
            self._waiting_until = sight.time + patience
        if sight.time < self._waiting_until:
            return
        self.press(TYPE_II, sight.time, reason)
        self._waiting_until = sight.time + self._random.uniform(*REPEAT_S)

    def give_up(self) -> None:
        """What was waited for came, or can come no more."""
        self._pending = [mark for mark in self._pending if mark.topic != TYPE_II]

    def elapsed(self) -> float:
        """Seconds from the first to the last of the recent sights."""
        return self.recent[-1].time - self.recent[0].time

    def moving(self) -> bool:
        """Whether the robot is seen to move over the ground."""
        first, last = self.recent[0], self.recent[-1]
        if self.elapsed() <= 0.0:
            return False
        return math.hypot(last.x - first.x, last.y - first.y) / self.elapsed() > MOVING_M_S
