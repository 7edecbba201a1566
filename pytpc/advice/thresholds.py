"""Sets of thresholds that give a comparison one outcome, and a readable number inside them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from pytpc.events import Bools, Floats

_RELATIONS: dict[str, np.ufunc] = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
}

_OPPOSITE = {"<": ">=", ">=": "<", ">": "<=", "<=": ">"}
_FIRST_DIGITS = 3
_LAST_DIGITS = 6
_STEPS = 64
_NOTHING = 1e-300


@dataclass(frozen=True, slots=True)
class HalfLine:
    """All numbers above (``up``) or below ``bound``, with or without ``bound`` itself."""

    bound: float
    inclusive: bool
    up: bool

    def holds(self, value: float) -> bool:
        """Whether ``value`` lies in it."""
        if value == self.bound:
            return self.inclusive
        return value > self.bound if self.up else value < self.bound

    def words(self) -> str:
        """``at least 3``, ``below 0.5``."""
        name = {
            (True, True): "at least",
            (True, False): "above",
            (False, True): "at most",
            (False, False): "below",
        }[self.up, self.inclusive]
        return f"{name} {self.bound:.6g}"


class Unit(Protocol):
    """How a parameter gives a threshold, as far as suggestions need it."""

    def forward(self, parameter: float) -> float:
        """The threshold that a value of the parameter gives, in the arithmetic of doubles."""
        ...

    def back(self, threshold: float) -> float:
        """The parameter that gives ``threshold``, as near as doubles come; NaN if none does."""
        ...

    def parameters(self, thresholds: HalfLine) -> HalfLine | None:
        """The half-line of parameters that belongs to one of thresholds; None if none does."""
        ...

    def grain(self, bound: float) -> float:
        """A step of the parameter that the arithmetic does not swallow near ``bound``."""
        ...


@dataclass(frozen=True, slots=True)
class Affine:
    """threshold = scale * parameter + offset; ``scale`` is not 0."""

    scale: float = 1.0
    offset: float = 0.0

    def forward(self, parameter: float) -> float:
        """The threshold that a value of the parameter gives, in the arithmetic of doubles."""
        return self.scale * parameter + self.offset

    def back(self, threshold: float) -> float:
        """The parameter that gives ``threshold``, as near as doubles come."""
        return (threshold - self.offset) / self.scale

    def parameters(self, thresholds: HalfLine) -> HalfLine:
        """The half-line of parameters that belongs to one of thresholds; turned where scale < 0."""
        up = thresholds.up == (self.scale > 0)
        return HalfLine(self.back(thresholds.bound), thresholds.inclusive, up)

    def grain(self, bound: float) -> float:
        """A step of the parameter that rounding does not swallow near the threshold ``bound``."""
        return max(math.ulp(bound), math.ulp(self.offset)) / abs(self.scale)


def outcomes(relation: str, cmp: Floats, thresh: Floats) -> Bools:
    """bool[n]: ``cmp relation thresh`` of docs/formats.md, the threshold on the right-hand side."""
    return np.asarray(_RELATIONS[relation](cmp, thresh), dtype=np.bool_)


def thresholds_for(relation: str, cmp: float, outcome: bool) -> HalfLine:
    """The thresholds T with ``(cmp relation T) == outcome``, for one of ``< <= > >=``.

    >>> thresholds_for(">=", 3, False).words()
    'above 3'
    """
    wanted = relation if outcome else _OPPOSITE[relation]
    return HalfLine(cmp, wanted in {"<=", ">="}, wanted in {"<", "<="})


def nearest(line: HalfLine, unit: Unit, whole: bool) -> float | None:
    """The value of the parameter nearest to the end of a half-line of thresholds, inside it.

    Of doubles the next one after the end, of whole numbers the next whole one. Where rounding in
    ``unit`` swallows single steps, they are doubled until the threshold moves.

    Returns:
        The value, or None where there is no finite one.
    """
    mine = unit.parameters(line)
    if mine is None or not math.isfinite(mine.bound):
        return None
    start = mine.bound
    if whole:
        start = float(math.ceil(start) if mine.up else math.floor(start))
    candidates = [start]
    step = 1.0
    if not whole:
        candidates.append(math.nextafter(start, math.inf if mine.up else -math.inf))
        step = max(math.ulp(start), unit.grain(line.bound))
    steps = [step * 2.0**power for power in range(_STEPS)]
    candidates += [start + step if mine.up else start - step for step in steps]
    inside = (v for v in candidates if math.isfinite(v) and line.holds(unit.forward(v)))
    return next(inside, None)


def readable(line: HalfLine, unit: Unit, first: float, current: float) -> float:
    """A value of the parameter with few digits, inside a half-line of thresholds.

    Three significant digits, more where those would go past the end by more than half of the way
    from ``current``. ``first`` is what ``nearest`` gave.
    """
    mine = unit.parameters(line)
    up = mine.up if mine is not None else first > current
    way = abs(first - current)
    context = Context(rounding=ROUND_CEILING if up else ROUND_FLOOR)
    if abs(first) < max(way * 1e-9, _NOTHING):
        # Next to 0 the digits of the end say nothing about what is small here.
        size = way if way > _NOTHING else 1.0
        around = Decimal(10) ** (math.floor(math.log10(size)) - _FIRST_DIGITS + 1)
        return _inside(line, unit, [0.0, float(around if up else -around)], first)
    found = []
    for digits in range(_FIRST_DIGITS, _LAST_DIGITS + 1):
        context.prec = digits
        rounded = context.create_decimal(repr(first))
        beyond = context.next_plus(rounded) if up else context.next_minus(rounded)
        value = _inside(line, unit, [float(rounded), float(beyond)], first)
        if abs(value - first) <= way / 2:
            return value
        found.append(value)
    return found[0] if way <= abs(first) * 1e-9 else found[-1]


def _inside(line: HalfLine, unit: Unit, values: list[float], otherwise: float) -> float:
    for value in values:
        if math.isfinite(value) and line.holds(unit.forward(value)):
            return value
    return otherwise
