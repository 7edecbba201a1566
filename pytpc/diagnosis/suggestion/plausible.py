"""Whether a person would try a value of a parameter, and why not.

A value is usual within a factor of 10 of a value that the parameter has or that is known to be good
(a good run's, a default), or among what a good run compared with it. It is unusual, which is said,
up to a factor of 100, or among what the mission itself compared with it, give or take one half.
Nobody tries one that is further away, or of the other sign, unless the declared range says so.
Values off the scale, such as a time since the epoch, do not count as compared.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Floats, Int64s
from pytpc.base.off_scale import off_scale
from pytpc.base.wording import show, tidy
from pytpc.diagnosis.suggestion.kinds_by_name import NamedKind
from pytpc.diagnosis.thresholds.intervals import Interval
from pytpc.recording.mission import Recording

USUAL, UNUSUAL, NOBODY = range(3)
_REACH = {USUAL: 10.0, UNUSUAL: 100.0}
_ROUNDING = 1e-9
_MANY = 1e6
_BULK = (0.05, 0.95)
_BESIDE = 1.5
_MOST_LOOKED_AT = 10_000


class Doubt(NamedTuple):
    """Why a person would not try a value: ``grade`` is one of the three above, the worse the more.

    ``words`` are the value in words, ``a value of the other sign``; ``what`` is what was against
    it, ``sign``. Both are empty for a usual value.
    """

    grade: int
    words: str
    what: str

    @property
    def text(self) -> str:
        """The sentence about a value where no other would do; empty for a usual value."""
        return f"only {self.words} would have prevented it" if self.words else ""


NO_DOUBT = Doubt(USUAL, "", "")


class Spread(NamedTuple):
    """Where most compared values lie, and most of their sizes without the zeros."""

    low: float
    high: float
    small: float
    large: float

    @property
    def is_both_sides_of_zero(self) -> bool:
        """Whether many are negative and many are positive, and neither are noise beside the other.

        A sensor's noise around 0 is far smaller than what it measures.
        """
        less, more = sorted((-self.low, self.high))
        return less > 0 and more <= less * _REACH[USUAL]

    def holds_size(self, value: float, beside: float = 1.0) -> bool:
        """Whether the size is one of theirs, or differs by a factor of ``beside`` at most."""
        return self.small / beside <= abs(value) <= self.large * beside


def spread_of(recording: Recording, key: str) -> Spread | None:
    """The spread of what a mission compared; None without a finite value."""
    events, summaries = recording.events, recording.summaries
    rows = _some(events.rows_of(key))
    own = summaries.take(summaries.rows_of(key))
    ends = [own.thresh + own.diff_min, own.thresh + own.diff_max]
    values: Floats = np.concatenate([events.cmp[rows], *ends])
    values = values[np.isfinite(values)]
    if not values.size:
        return None
    values = values[~off_scale(values, np.concatenate([events.thresh[rows], own.thresh]))]
    low, high = np.quantile(values, _BULK).tolist()
    sizes = np.abs(values[values != 0])
    small, large = np.quantile(sizes, _BULK).tolist() if sizes.size else (0.0, 0.0)
    return Spread(low, high, small, large)


def _some(rows: Int64s) -> Int64s:
    """At most so many rows as are looked at, spread evenly."""
    return rows[:: 1 + rows.size // _MOST_LOOKED_AT]


@dataclass(frozen=True, slots=True)
class Shown:
    """What the good runs, the defaults and the mission show of a parameter.

    ``good`` are values that are known to be good; ``usual`` is what a good run compared with it,
    ``seen`` what the mission did.
    """

    good: tuple[float, ...] = ()
    usual: Spread | None = None
    seen: Spread | None = None


_ANY = Interval()


def _itself(value: float) -> float:
    return value


@dataclass(frozen=True)
class ParameterKind:
    """What is known of a parameter, apart from which of its values would do.

    ``declared`` is its range; ``look`` finds the rest, and is asked only if the present value does
    not settle it. ``threshold`` gives the threshold of a value.
    """

    present: float
    declared: Interval = _ANY
    named: tuple[NamedKind, ...] = ()
    look: Callable[[], Shown] = Shown
    threshold: Callable[[float], float] = _itself

    @cached_property
    def _shown(self) -> Shown:
        return self.look()

    @property
    def _anchors(self) -> list[float]:
        """The values that are known, except for 0, which has no size and no sign."""
        return [one for one in (self.present, *self._shown.good) if one and math.isfinite(one)]

    def doubt(self, value: float) -> Doubt:
        """Why a person would not try a value: the gravest reason."""
        near = value * self.present > 0 and _factor(value, self.present) <= _REACH[USUAL]
        found = NO_DOUBT
        if not near:
            found = self._zero() if value == 0 else self._sign(value) or self._size(value)
        return max(found, self._name(value), key=lambda one: one.grade)

    def furthest(self, *, up: bool) -> float | None:
        """The value of the present one's sign that is furthest from it and still usual."""
        same = [abs(one) for one in self._anchors if one * self.present > 0]
        if not same:
            return None
        away = up == (self.present > 0)
        size = max(same) * _REACH[USUAL] if away else min(same) / _REACH[USUAL]
        return float(tidy(math.copysign(size, self.present)))

    def _zero(self) -> Doubt:
        known = (self.present, *self._shown.good)
        sides = any(one.is_both_sides_of_zero for one in self._spreads)
        if 0.0 in known or sides or (self._is_declared(-1) and self._is_declared(1)):
            return NO_DOUBT
        return Doubt(UNUSUAL, "0, which often switches a check off,", "zero")

    def _is_declared(self, sign: float) -> bool:
        """Whether the declared range names an end of this sign."""
        end = self.declared.low if sign < 0 else self.declared.high
        return math.isfinite(end) and end * sign > 0

    @property
    def _spreads(self) -> list[Spread]:
        return [one for one in (self._shown.usual, self._shown.seen) if one is not None]

    def _sign(self, value: float) -> Doubt | None:
        """A doubt if no known value has this sign; None if the sign is all right."""
        anchors = self._anchors
        if not anchors or any(one * value > 0 for one in anchors):
            return None
        if self._is_declared(value):
            return NO_DOUBT
        if any(not _is_in(kind, self.present) and _is_in(kind, value) for kind in self.named):
            # -1 often means that there is no limit.
            return NO_DOUBT
        sides = any(one.is_both_sides_of_zero for one in self._spreads)
        return Doubt(UNUSUAL if sides else NOBODY, "a value of the other sign", "sign")

    def _size(self, value: float) -> Doubt:
        threshold = self.threshold(value)
        usual, seen = self._shown.usual, self._shown.seen
        if usual is not None and usual.holds_size(threshold):
            return NO_DOUBT
        what = "order of magnitude"
        same = [one for one in self._anchors if one * value > 0]
        if not same:
            far = seen is not None and not seen.holds_size(threshold, _REACH[USUAL])
            return (
                Doubt(UNUSUAL, "a value of another order of magnitude", what) if far else NO_DOUBT
            )
        nearest = min(same, key=lambda one: _factor(value, one))
        factor = _factor(value, nearest)
        if factor <= _REACH[USUAL]:
            return NO_DOUBT
        within = math.isfinite(self.declared.low) and math.isfinite(self.declared.high)
        compared = seen is not None and factor < _MANY and seen.holds_size(threshold, _BESIDE)
        grade = UNUSUAL if factor <= _REACH[UNUSUAL] or within or compared else NOBODY
        which = "the present one" if nearest == self.present else "a good one"
        times = f"{round(factor):,} times" if factor < _MANY else "over a million times"
        if abs(value) > abs(nearest):
            return Doubt(grade, f"a value {times} {which}", what)
        return Doubt(grade, f"a value {times} smaller than {which}", what)

    def _name(self, value: float) -> Doubt:
        """By the name's kind; it says nothing where the present value is none of this kind."""
        broken = [kind for kind in self.named if not _is_in(kind, value)]
        broken = [kind for kind in broken if _is_in(kind, self.present)]
        if broken:
            good = self._shown.good
            broken = [kind for kind in broken if all(_is_in(kind, one) for one in good)]
        if not broken:
            return NO_DOUBT
        first = max(broken, key=lambda kind: kind.firm)
        end = first.low if value < first.low else first.high
        words = f"a value beyond {show(end)}, which is unusual for {first.what},"
        words = words if end else "a negative value"
        return Doubt(NOBODY if first.firm else UNUSUAL, words, first.what)


def _factor(value: float, other: float) -> float:
    """How many times the one is the other, or the other the one; 1 if rounding tells them apart."""
    small, large = sorted((abs(value), abs(other)))
    return large / small * (1 - _ROUNDING) if small else math.inf


def _is_in(kind: NamedKind, value: float) -> bool:
    return kind.low <= value <= kind.high
