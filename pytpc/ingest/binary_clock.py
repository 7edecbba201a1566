"""From a process's steady clock to ROS time, by the moments at which it noted both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pytpc.base.columns import Int64s

_JUMP_NS = 10**6
_LARGEST = 2**62
# The middle of the doubles that are whole numbers, and its bits.
_WHOLE = 1.5 * 2.0**52
_BITS = int(np.float64(_WHOLE).view(np.int64))
# In ns, nine hours: up to there the product is exact to a thousandth.
_LONGEST_LINE = 2**45


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

    def rising(self, steady: Int64s, out: Int64s | None = None) -> Int64s:
        """The same for at least one time, in ascending order; into ``out`` where that is given."""
        times = np.empty_like(steady) if out is None else out
        first, last = self._place(int(steady[0])), self._place(int(steady[-1]))
        # What lies between two moments is a slice.
        cuts = np.searchsorted(steady, self.steady[first + 1 : last + 1], "left").tolist()
        begins, ends = [0, *cuts], [*cuts, steady.size]
        for begin, end, place in zip(begins, ends, range(first, last + 1), strict=True):
            if begin < end:
                self._between(steady[begin:end], place, times[begin:end])
        return times

    def _place(self, steady: int) -> int:
        return max(0, int(np.searchsorted(self.steady, steady, "right")) - 1)

    def _between(self, steady: Int64s, place: int, times: Int64s) -> None:
        """Fill ``times``: all of ``steady`` is before the moment after ``place``."""
        shift = int(self.shift[place])
        last = place + 1 == self.steady.size
        change = 0 if last else int(self.shift[place + 1]) - shift
        if not change or abs(change) >= _JUMP_NS:
            np.add(steady, shift, out=times)
            return
        begin, end = int(self.steady[place]), int(self.steady[place + 1])
        if steady[0] < begin:
            # Before the first moment the line is not followed.
            early = int(np.searchsorted(steady, begin, "left"))
            np.add(steady[:early], shift, out=times[:early])
            steady, times = steady[early:], times[early:]
        if end - begin >= _LONGEST_LINE:
            drift = np.subtract(steady, begin, dtype=np.float64) * (change / (end - begin))
            np.add(steady + shift, np.rint(drift).astype(np.int64), out=times)
            return
        # A double between 2^52 and 2^53 has its integer in its lower bits, so that no number is
        # converted: time since ``begin``, times the slope, rounded by the addition.
        np.subtract(steady, begin - _BITS, out=times)
        line = times.view(np.float64)
        line -= _WHOLE
        line *= 1.0 + change / (end - begin)
        line += _WHOLE
        times += begin + shift - _BITS
