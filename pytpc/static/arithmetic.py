"""The arithmetic by which a threshold is computed from its parameter.

It is a tree (docs/reference/formats.md#transform): a number, ``"x"`` (the parameter), or a tuple of
an operator and its operands, one of which holds ``"x"``.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Sequence

Tree = float | str | tuple["Tree", ...]

SINGLE = "single"
"""The operator of a parameter that is kept in a C++ float; it is in no file."""


def _wrap(value: float, bits: float) -> float:
    size = 2 ** int(bits)
    low = int(value) % size
    return float(low - size if low >= size // 2 else low)


def _whole(rule: Callable[[float], int]) -> Callable[[float], float]:
    """A rule of rounding for doubles; infinity stays what it is."""
    return lambda x: x if math.isinf(x) else float(rule(x))


def _power(base: float, exponent: float) -> float:
    try:
        return math.pow(base, exponent)
    except OverflowError:
        return -math.inf if base < 0 and exponent % 2 == 1 else math.inf


def _exponential(exponent: float) -> float:
    try:
        return math.exp(exponent)
    except OverflowError:
        return math.inf


_ONE: dict[str, Callable[[float], float]] = {
    "sqrt": math.sqrt,
    "abs": abs,
    "trunc": _whole(math.trunc),
    "floor": _whole(math.floor),
    "ceil": _whole(math.ceil),
    "round": _whole(lambda x: math.trunc(x + math.copysign(0.5, x))),
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
    "exp": _exponential,
    "log": math.log,
    "log2": math.log2,
    "log10": math.log10,
}
_TWO: dict[str, Callable[[float, float], float]] = {
    "+": lambda a, b: a + b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "div": lambda a, b: _ONE["trunc"](a / b),
    "rem": math.fmod,
    "shr": lambda a, b: _ONE["floor"](math.ldexp(a, -int(b))),
    "and": lambda a, b: float(int(a) & int(b)),
    "pow": _power,
    "min": min,
    "max": max,
    "wrap": _wrap,
    "wrapu": lambda a, b: float(int(a) % 2 ** int(b)),
}


def from_json(tree: object) -> Tree:
    """The tree in parsed JSON that was checked by the schema."""
    if isinstance(tree, list):
        return tuple(from_json(part) for part in tree)
    return tree if isinstance(tree, str) else float(tree)  # type: ignore[arg-type]


def evaluate(tree: Tree, x: float) -> float:
    """The value of a tree where the parameter is ``x``; NaN where there is none."""
    try:
        return _evaluate(tree, x)
    except OverflowError:
        return math.inf
    except (ValueError, ZeroDivisionError):
        return math.nan


def _evaluate(tree: Tree, x: float) -> float:
    if isinstance(tree, tuple):
        name = str(tree[0])
        if name == SINGLE:
            return ctypes.c_float(_evaluate(tree[1], x)).value
        operands = [_evaluate(part, x) for part in tree[1:]]
        return _ONE[name](*operands) if len(operands) == 1 else _TWO[name](*operands)
    return x if isinstance(tree, str) else float(tree)


OPERATORS: Sequence[str] = (*_ONE, *_TWO)
