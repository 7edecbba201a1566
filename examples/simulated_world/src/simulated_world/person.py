"""A person beside a robot who presses a key when something is wrong.

``/mark_action`` is "it did what it should not" (type I), ``/mark_no_action`` "it does not do what
it should" (type II). The time in a mark is the simulated time at which the key was pressed, a
human's delay after the cause. What is wrong is said by the robot's rules.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Generic

from simulated_world.rules import Rules, SightT, Waiting

TYPE_I = "mark_action"
TYPE_II = "mark_no_action"

REACTION_MEDIAN_S = 2.5  # thesis, table 6.14: 1 to 4 s where the error was plain to see
REACTION_SIGMA = 0.4
PATIENCE_S = (7.0, 1.0)  # with the reaction the 7 to 10 s of table 6.14, type II
REPEAT_S = (4.0, 9.0)  # from one mark to the next, while nothing comes


@dataclass(frozen=True)
class Mark:
    """A key press: simulated time in s, and which key."""

    time: float
    topic: str
    reason: str


class Person(Generic[SightT]):
    """Turns what a robot's rules find into marks, while the robot is at it."""

    def __init__(self, rules: Rules[SightT], seed: int) -> None:
        """``seed`` is for the delays of this person."""
        self._rules = rules
        # Apart, so that a moment's hesitation does not change how fast this person is later.
        self._reaction = random.Random(seed)
        self._patience = random.Random(f"patience {seed}")
        self._pending: list[Mark] = []
        self._waiting_until: float | None = None

    def see(self, sight: SightT) -> list[Mark]:
        """Take in one sight; return the keys that were pressed until it."""
        finding = self._rules.see(sight)
        for wrong in finding.wrong:
            self._press(TYPE_I, wrong.time, wrong.reason)
        self._wait(sight.time, finding.waiting)
        pressed = [mark for mark in self._pending if mark.time <= sight.time]
        self._pending = [mark for mark in self._pending if mark.time > sight.time]
        return sorted(pressed, key=lambda mark: mark.time)

    def _press(self, topic: str, cause: float, reason: str) -> None:
        delay = self._reaction.lognormvariate(math.log(REACTION_MEDIAN_S), REACTION_SIGMA)
        self._pending.append(Mark(cause + delay, topic, reason))

    def _wait(self, now: float, waiting: Waiting | None) -> None:
        """Wait for what does not come: with patience, then pressing again and again.

        Where there is nothing to wait for any more, the hand leaves the key.
        """
        if waiting is None:
            self._pending = [mark for mark in self._pending if mark.topic != TYPE_II]
            self._waiting_until = None
            return
        if self._waiting_until is None:
            patience = max(self._rules.patience_s, self._patience.gauss(*PATIENCE_S))
            self._waiting_until = now + patience
        if now < self._waiting_until:
            return
        self._press(TYPE_II, now, waiting.reason)
        self._waiting_until = now + self._patience.uniform(*REPEAT_S)
