"""From a process's steady clock to ROS time, by the moments at which it noted both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pytpc.base.columns import Int64s

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
        """int64[n]: real time at ``steady``, int64[n]; quick where that rises."""
        if not steady.size:
            return steady
        if bool((steady[1:] < steady[:-1]).any()):
            order = np.argsort(steady, kind="stable")
            times = np.empty_like(steady)
            times[order] = self.real(steady[order])
            return times
        return self.rising(steady)

    def rising(self, steady: Int64s) -> Int64s:
        """The same for at least one time, in ascending order."""
        first, last = self._place(int(steady[0])), self._place(int(steady[-1]))
        if first == last:
            return self._between(steady, first)
        # What lies between two moments is a slice.
        cuts = np.searchsorted(steady, self.steady[first + 1 : last + 1], "left").tolist()
        begins, ends = [0, *cuts], [*cuts, steady.size]
        parts = zip(begins, ends, range(first, last + 1), strict=True)
        return np.concatenate([self._between(steady[b:e], at) for b, e, at in parts if b < e])

    def _place(self, steady: int) -> int:
        return max(0, int(np.searchsorted(self.steady, steady, "right")) - 1)

    def _between(self, steady: Int64s, place: int) -> Int64s:
        shift = int(self.shift[place])
        times: Int64s = steady + shift
        if place + 1 == self.steady.size:
            return times
        change = int(self.shift[place + 1]) - shift
        if change and abs(change) < _JUMP_NS:
            begin = int(self.steady[place])
            # The change is small against the time: what a double rounds of that does not matter.
            drift = np.subtract(steady, begin, dtype=np.float64)
            drift *= change / (int(self.steady[place + 1]) - begin)
            if steady[0] < begin:
                # Before the first moment the line is not followed.
                drift[steady < begin] = 0.0
            times += np.rint(drift, out=drift).astype(np.int64)
        return times
