"""Chooses one value of those that would do: near the current one, possible, and readable."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

from pytpc.base.wording import show
from pytpc.diagnosis.suggestion.plausible import NO_DOUBT, Doubt, ParameterKind
from pytpc.diagnosis.thresholds.intervals import Interval, Intervals, intersection, words
from pytpc.recording.declaration import Declared

WHOLE = "whole number"
_FIRST_DIGITS = 3
_LAST_DIGITS = 6
_ALL_DIGITS = 17
_NOTHING = 1e-300


@dataclass(frozen=True, slots=True)
class Choice:
    """A value, its interval of good values, and what kept it from the interval's end.

    ``doubt`` says why a person would not try it, although it is the best of all that would do.
    """

    value: float
    interval: Interval
    limited_by: str
    doubt: Doubt = NO_DOUBT


@dataclass(frozen=True, slots=True)
class Possible:
    """Which values a parameter takes, by its declaration and its C++ type."""

    whole: bool = False
    unsigned: bool = False
    declared: Declared | None = None

    @property
    def interval(self) -> Interval:
        """The range."""
        low, high = self._ends()
        if self.unsigned:
            low = max(0.0, -math.inf if low is None else low)
        return Interval.closed(low, high)

    @property
    def is_limited(self) -> bool:
        """Whether a range is known."""
        return self.interval != Interval()

    @property
    def step(self) -> Decimal | None:
        """The step of the grid that values lie on, a positive number."""
        step = self.declared.step if self.declared is not None else None
        return Decimal(repr(float(step))) if step is not None and step > 0 else None

    def origin(self, current: float) -> Decimal:
        """A number of the grid: the lower end of the range, else the present value."""
        low = self._ends()[0]
        return Decimal(repr(float(current if low is None else low)))

    def toward(self, end: float, current: float) -> float | None:
        """The value nearest to ``end`` of those between it and the present one, if there is one."""
        up = end > current
        limit = self.interval.high if up else self.interval.low
        end = min(end, limit) if up else max(end, limit)
        if self.step is not None:
            grid = self.origin(current)
            rounding = ROUND_FLOOR if up else ROUND_CEILING
            count = ((Decimal(repr(end)) - grid) / self.step).to_integral_value(rounding)
            end = float(grid + count * self.step)
        elif self.whole:
            end = float(math.floor(end) if up else math.ceil(end))
        return (
            end if (end > current) == up and end != current and self.interval.holds(end) else None
        )

    def words(self) -> str:
        """``declared range 0..1``."""
        low, high = self._ends()
        if low is None and high is None:
            return "type, which holds no negative number"
        ends = ["" if end is None else show(end) for end in (low, high)]
        return f"declared range {ends[0]}..{ends[1]}"

    def _ends(self) -> tuple[float | None, float | None]:
        found = self.declared
        if found is None:
            return None, None
        # Ends that are strings, or in the wrong order, do not count.
        low, high = (None if end is None else float(end) for end in (found.low, found.high))
        if low is not None and high is not None and not low <= high:
            return None, None
        return low, high


def choose(
    feasible: Intervals,
    current: float,
    possible: Possible,
    kind: ParameterKind | None = None,
    *,
    up_first: bool = True,
) -> Choice | str:
    """The value nearest to ``current`` that would do and that the parameter can take.

    One that a person would try goes before all others, by the ``kind`` of the parameter; without
    it only the present value and the declared range count. If two intervals are as near,
    ``up_first`` decides. ``current`` is in none of them.

    Returns:
        The choice, or why there is none.
    """
    allowed = intersection(feasible, [possible.interval])
    if not allowed:
        name = "no value in the " if possible.declared is not None else "no value of its "
        return f"{name}{possible.words()} would do: {words(feasible)}"
    kind = kind or ParameterKind(current, possible.interval)
    found = []
    for interval in allowed:
        value = _nearest(interval, current, possible)
        if value is not None:
            found.append((_order(value, current, kind, up_first), value, interval))
    if not found:
        grid = "no whole number" if possible.step is None else f"no step of {possible.step}"
        return f"{grid} would do: {words(allowed)}"
    _, first, inside = min(found, key=lambda one: one[0])
    home = next(one for one in feasible if one.holds(first))
    value = first
    if not possible.whole and possible.step is None:
        value = readable(inside, first, current)
    limited_by = _limits(feasible, first, current, possible, kind)
    return Choice(value, home, limited_by, kind.doubt(value))


def _order(
    value: float, current: float, kind: ParameterKind, up_first: bool
) -> tuple[int, float, bool]:
    return (kind.doubt(value).grade, abs(value - current), (value > current) != up_first)


def _limits(
    feasible: Intervals, first: float, current: float, possible: Possible, kind: ParameterKind
) -> str:
    """Why ``first`` is not the smallest change that would do; empty if it is."""
    ends = [one.first() if one.first() > current else one.last() for one in feasible]
    end = min(ends, key=lambda value: abs(value - current))
    if abs(first - current) <= abs(end - current):
        return ""
    if not possible.interval.holds(end):
        return possible.words()
    passed = kind.doubt(end)
    if passed.grade > kind.doubt(first).grade:
        return passed.what
    if possible.step is not None and not _is_on(possible, end, current):
        return f"step {possible.step.normalize():f}"
    return WHOLE if possible.whole and end != round(end) else ""


def _is_on(possible: Possible, value: float, current: float) -> bool:
    step = possible.step
    if step is None or not math.isfinite(value):
        return False
    count = (Decimal(repr(value)) - possible.origin(current)) / step
    return count == count.to_integral_value()


def _nearest(interval: Interval, current: float, possible: Possible) -> float | None:
    """The value of an interval nearest to ``current``, on the grid of steps or whole numbers."""
    up = interval.first() > current
    end = interval.first() if up else interval.last()
    if possible.step is None:
        if not possible.whole:
            return end
        value = float(math.ceil(end) if up else math.floor(end))
        return value if interval.holds(value) else None
    # The range's own ends are always allowed (rcl_interfaces), and end the grid.
    origin, step = possible.origin(current), possible.step
    count = ((Decimal(repr(end)) - origin) / step).to_integral_value(
        ROUND_CEILING if up else ROUND_FLOOR
    )
    values = [float(origin + count * step)]
    ends = possible.interval
    values += [edge for edge in (ends.high if up else ends.low,) if math.isfinite(edge)]
    values = [value for value in values if not possible.whole or value == round(value)]
    return next((value for value in values if interval.holds(value)), None)


def readable(interval: Interval, first: float, current: float) -> float:
    """A value with few digits, inside ``interval`` and not nearer to ``current`` than ``first``.

    It has three significant digits, or more if three would go past ``first`` by more than half of
    the way from ``current``.
    """
    up = first > current
    way = abs(first - current)
    context = Context(rounding=ROUND_CEILING if up else ROUND_FLOOR)
    if abs(first) < max(way * 1e-9, _NOTHING):
        # Next to 0 the digits of the end do not show what is small.
        size = way if way > _NOTHING else 1.0
        around = Decimal(10) ** (math.floor(math.log10(size)) - _FIRST_DIGITS + 1)
        return _inside(interval, [0.0, float(around if up else -around)], first)
    found = []
    for digits in range(_FIRST_DIGITS, _ALL_DIGITS + 1):
        context.prec = digits
        rounded = context.create_decimal(repr(first))
        beyond = context.next_plus(rounded) if up else context.next_minus(rounded)
        value = _inside(interval, [float(rounded), float(beyond)], math.nan)
        if abs(value - first) <= way / 2:
            return value
        if not math.isnan(value):
            found.append(value)
        if digits >= _LAST_DIGITS and found:
            return found[0] if way <= abs(first) * 1e-9 else found[-1]
    return first


def _inside(interval: Interval, values: list[float], otherwise: float) -> float:
    return next((value for value in values if interval.holds(value)), otherwise)
