"""The groups of comparisons that turn as one, while a mission runs.

The turns of the last ``KEPT_S`` count. What turned more than ``MOST`` times in that time is noise
at its threshold, and is in no group. Of more than ``MOST_COMPARED`` comparisons, those that turned
last are compared: the screen waits for it, on the robot's own processor.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pytpc.diagnosis.ranking.result_streams import BURST_S
from pytpc.diagnosis.results.turn_groups import TurnGroup
from pytpc.diagnosis.turn_groups import LEAST, Turns, turn_groups

KEPT_S = 600.0
MOST = 256
MOST_COMPARED = 100
_RENEWED_S = 5.0
_PAIRS_PER_S = 500.0
"""The groups are worked out at most once in so many seconds of the mission, and later if there are
more pairs to compare than this for each second."""


@dataclass(slots=True)
class _Turned:
    """The turns of a comparison in a node, without those that follow within ``BURST_S``."""

    times: deque[float] = field(default_factory=lambda: deque(maxlen=MOST + 1))
    last_s: float = -np.inf


class LiveGroups:
    """Takes in each change of a result, and says which comparisons turn as one."""

    def __init__(self) -> None:
        """Nothing has turned."""
        self._turned: dict[tuple[str, str], _Turned] = {}
        self._first_s: float | None = None
        self._has_new = False
        self._due_s = -np.inf
        self._known: tuple[TurnGroup, ...] = ()

    def turned(self, key: str, node: str, time_ns: int) -> None:
        """The result of a comparison has changed."""
        one = self._turned.setdefault((key, node), _Turned())
        seconds = time_ns / 1e9
        self._first_s = seconds if self._first_s is None else min(self._first_s, seconds)
        if seconds - one.last_s > BURST_S:
            one.times.append(seconds)
            self._has_new = True
        one.last_s = max(one.last_s, seconds)

    def groups(self, now_ns: int, name_of: Callable[[str], str | None]) -> tuple[TurnGroup, ...]:
        """The groups of an instant.

        Args:
            now_ns: the time of the mission.
            name_of: the parameter of a key; None for one that is not shown.
        """
        now_s = now_ns / 1e9
        if not self._has_new or now_s < self._due_s:
            return self._known
        begin_s = max(now_s - KEPT_S, self._first_s or 0.0)
        turns = []
        for (key, node), one in sorted(self._turned.items(), key=lambda item: -item[1].last_s):
            while one.times and one.times[0] < begin_s:
                one.times.popleft()
            name = name_of(key)
            if name is None or not LEAST <= len(one.times) <= MOST:
                continue
            turns.append(Turns(key, node, name, np.sort(np.array(one.times, np.float64))))
            if len(turns) == MOST_COMPARED:
                break
        self._known = turn_groups(turns, now_s - begin_s)
        pairs = len(turns) * (len(turns) - 1) / 2
        self._due_s = now_s + max(_RENEWED_S, pairs / _PAIRS_PER_S)
        self._has_new = False
        return self._known
