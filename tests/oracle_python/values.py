"""Numbers and texts that say where they come from, through copies and arithmetic with constants."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

MEASURED = frozenset({"<measured>"})
"""What a value from outside carries, and what is made of more than one value."""


class Number(float):
    """A float with ``origin``: the names of its parameters, or ``MEASURED``."""

    origin: frozenset[str]

    def __new__(cls, value: float, origin: frozenset[str]) -> Number:
        """``value`` as it came from ``origin``."""
        made = super().__new__(cls, value)
        made.origin = origin
        return made

    def __neg__(self) -> Number:
        """Minus it."""
        return Number(-float(self), self.origin)

    def __abs__(self) -> Number:
        """Its absolute value."""
        return Number(abs(float.__add__(self, 0.0)), self.origin)

    def __reduce__(self) -> tuple[Any, ...]:
        """For copies."""
        return Number, (float.__add__(self, 0.0), self.origin)


class Text(str):
    """A text with ``origin``."""

    origin: frozenset[str]

    def __new__(cls, value: str, origin: frozenset[str]) -> Text:
        """``value`` as it came from ``origin``."""
        made = super().__new__(cls, value)
        made.origin = origin
        return made


def origin_of(value: object) -> frozenset[str]:
    """Where a value comes from; nothing for a constant."""
    return value.origin if isinstance(value, Number | Text) else frozenset()


def joined(*values: object) -> frozenset[str]:
    """Where what is made of ``values`` comes from: of one with constants, else it is measured."""
    origins = [origin for origin in map(origin_of, values) if origin]
    if not origins:
        return frozenset()
    return origins[0] if len(origins) == 1 else MEASURED


def made(value: float, *of: object) -> float:
    """``value``, which was computed of other values."""
    origin = joined(*of)
    return Number(value, origin) if origin else value


def _arithmetic(compute: Callable[[Any, Any], Any]) -> tuple[Any, Any]:
    def forward(self: Number, other: Any) -> Any:
        return made(compute(float.__add__(self, 0.0), plain(other)), self, other)

    def backward(self: Number, other: Any) -> Any:
        return made(compute(plain(other), float.__add__(self, 0.0)), other, self)

    return forward, backward


def plain(value: Any) -> Any:
    """A number that says nothing."""
    return float.__add__(value, 0.0) if isinstance(value, Number) else value


for _name in ("add", "sub", "mul", "truediv"):
    _forward, _backward = _arithmetic(getattr(operator, _name))
    setattr(Number, f"__{_name}__", _forward)
    setattr(Number, f"__r{_name}__", _backward)


def to_float(value: Any = 0.0) -> float:
    """``float``."""
    return made(float(plain(value)), value)


def least(*values: Any) -> Any:
    """``min`` of arguments."""
    return made(min(map(plain, values)), *values)


def largest(*values: Any) -> Any:
    """``max`` of arguments."""
    return made(max(map(plain, values)), *values)


BUILTINS = {"float": to_float, "min": least, "max": largest}
