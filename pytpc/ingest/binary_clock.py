"""From a process's steady clock to ROS time, by the moments at which it noted both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pytpc.columns import Int64s

_JUMP_NS = 10**6
_LARGEST = 2**62


@dataclass(frozen=True)
class Clock:
    """Real minus steady time at the moments ``steady`` (sorted): int64[n] both, n at least 1.

    Between two moments whose differences are less than 1 ms apart the difference is taken as a
    straight line, otherwise as that of the first: there the real clock was set.
    """

    steady: Int64s
    shift: Int64s

    @classmethod
    def of(cls, syncs: Sequence[tuple[int, int]]) -> Clock:
        """From pairs of steady and real time; at least one. Those beyond 146 years are left out."""
        kept = [
            (steady, real - steady)
            for steady, real in syncs
            if abs(steady) < _LARGEST and abs(real) < _LARGEST
        ] or [(0, 0)]
        kept = sorted(dict(kept).items())
        return cls(
            np.array([steady for steady, _ in kept], np.int64),
            np.array([shift for _, shift in kept], np.int64),
        )

    def real(self, steady: Int64s) -> Int64s:
        """int64[...]: real time at ``steady`` (of any shape); quick where all are between two."""
        if not steady.size:
            return steady
        first, last = self._place(int(steady.min())), self._place(int(steady.max()))
        if first == last:
            return self._between(steady, first)
        if steady.ndim > 1:
            return np.stack([self.real(row) for row in steady])
        places = np.clip(np.searchsorted(self.steady, steady, "right") - 1, 0, None)
        times = np.empty_like(steady)
        for place in np.unique(places).tolist():
            here = places == place
            times[here] = self._between(steady[here], place)
        return times

    def at(self, steady: int) -> int:
        """Real time at one moment."""
        return int(self.real(np.array([steady], np.int64))[0])

    def _place(self, steady: int) -> int:
        return max(0, int(np.searchsorted(self.steady, steady, "right")) - 1)

    def _between(self, steady: Int64s, place: int) -> Int64s:
        shift = int(self.shift[place])
        if place + 1 < self.steady.size:
            change = int(self.shift[place + 1]) - shift
            if change and abs(change) < _JUMP_NS:
                begin = int(self.steady[place])
                slope = change / (int(self.steady[place + 1]) - begin)
                # Before the first moment the line is not followed.
                drift = np.rint(np.maximum(steady - begin, 0) * slope)
                moved: Int64s = (
                    steady + shift + np.clip(drift, -_JUMP_NS, _JUMP_NS).astype(np.int64)
                )
                return moved
        same: Int64s = steady + shift
        return same
