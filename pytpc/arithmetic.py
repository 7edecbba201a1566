"""What a threshold is computed from its parameter by: evaluated, and inverted near a value.

The tree is that of docs/formats.md: a number, ``"x"`` (the parameter), or a tuple of an operator
and its operands, one of which holds ``"x"``. Such a function of one variable is monotone on pieces;
on the piece around a value it is inverted by bisection over the doubles, which is exact: what is
found is the nearest double that does.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from pytpc.advice.thresholds import HalfLine

Tree = float | str | tuple["Tree", ...]

_LARGEST = 1.7976931348623157e308
_SMALLEST = 5e-324
_CLOSE = 1e-9


def _wrap(value: float, bits: float) -> float:
    size = 2 ** int(bits)
    low = int(value) % size
    return float(low - size if low >= size // 2 else low)


_ONE: dict[str, Callable[[float], float]] = {
    "sqrt": math.sqrt,
    "abs": abs,
    "trunc": lambda x: float(math.trunc(x)),
    "floor": lambda x: float(math.floor(x)),
    "ceil": lambda x: float(math.ceil(x)),
    "round": lambda x: float(math.trunc(x + math.copysign(0.5, x))),
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "asin": math.asin,
    "acos": math.acos,
    "atan": math.atan,
    "exp": math.exp,
    "log": math.log,
    "log2": math.log2,
    "log10": math.log10,
}
_TWO: dict[str, Callable[[float, float], float]] = {
    "+": lambda a, b: a + b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "div": lambda a, b: float(math.trunc(a / b)),
    "rem": math.fmod,
    "shr": lambda a, b: float(math.floor(a / 2**b)),
    "and": lambda a, b: float(int(a) & int(b)),
    "pow": math.pow,
    "min": min,
    "max": max,
    "wrap": _wrap,
    "wrapu": lambda a, b: float(int(a) % 2 ** int(b)),
}


def from_json(tree: object) -> Tree:
    """The tree of parsed JSON that the schema has let pass."""
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
        operands = [_evaluate(part, x) for part in tree[1:]]
        return _ONE[name](*operands) if len(operands) == 1 else _TWO[name](*operands)
    return x if isinstance(tree, str) else float(tree)


@dataclass(frozen=True, slots=True)
class Piece:
    """An interval of parameters, both ends in it, on which a function is monotone."""

    low: float
    high: float


@dataclass(frozen=True)
class Expression:
    """A tree as the unit of a parameter, near the value that it has now.

    ``anchor`` is where to look first: the parameter's default, if there is one.
    """

    tree: Tree
    threshold: float
    anchor: float | None = None

    def forward(self, parameter: float) -> float:
        """The threshold that a value of the parameter gives."""
        return evaluate(self.tree, parameter)

    @cached_property
    def current(self) -> float | None:
        """The parameter that gives ``threshold``; None where none is found.

        Of several the anchor, else the one on the anchor's piece, else a positive one.
        """
        t = self.threshold
        if self.anchor is not None and _is_close(self.forward(self.anchor), t):
            return self.anchor
        root = math.sqrt(abs(t)) if math.isfinite(t) else 1.0
        seeds = [1.0, 0.0, t, root, 1 / t if t else 1.0, 0.1, 10.0, 1e3, -1.0, -t, -root]
        if self.anchor is not None:
            seeds.insert(0, self.anchor)
        for seed in seeds:
            found = self._solve(seed)
            if found is not None:
                return found
        return None

    def back(self, threshold: float) -> float:
        """The parameter that gives a threshold, on the piece around the current one; else NaN."""
        if self.current is None:
            return math.nan
        if _is_close(threshold, self.threshold):
            return self.current
        found = Expression(self.tree, threshold)._solve(self.current)
        return math.nan if found is None else found

    def parameters(self, thresholds: HalfLine) -> HalfLine | None:
        """The parameters nearest to the current one that give thresholds of a half-line.

        They are a half-line as far as the piece goes on which the function is monotone. None where
        no parameter of the piece does it.
        """
        now = self.current
        if now is None or thresholds.holds(self.forward(now)):
            return None
        piece = self._piece(now)
        for end in (piece.high, piece.low):
            if end == now or not thresholds.holds(self.forward(end)):
                continue
            inside, outside = _boundary(end, now, lambda x: thresholds.holds(self.forward(x)))
            if not thresholds.inclusive and self.forward(outside) == thresholds.bound:
                return HalfLine(outside, False, end > now)
            return HalfLine(inside, True, end > now)
        return None

    def grain(self, bound: float) -> float:
        """No steps are swallowed: bisection has found the end."""
        return 0.0

    def _piece(self, x: float) -> Piece:
        return _piece(self.tree, x)

    def _solve(self, seed: float) -> float | None:
        """A parameter on the piece around ``seed`` that gives the threshold."""
        start = self.forward(seed)
        if math.isnan(start):
            return None
        if _is_close(start, self.threshold):
            return seed
        piece = self._piece(seed)
        up = start < self.threshold
        for end in (piece.high, piece.low):
            value = self.forward(end)
            reached = value >= self.threshold if up else value <= self.threshold
            if not reached or end == seed:
                continue
            inside, outside = _boundary(
                end,
                seed,
                lambda x: (
                    self.forward(x) >= self.threshold if up else self.forward(x) <= self.threshold
                ),
            )
            for found in (inside, outside):
                if _is_close(self.forward(found), self.threshold):
                    return found
        return None


def _is_close(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=_CLOSE, abs_tol=1e-12)


def _piece(tree: Tree, x: float) -> Piece:
    """The widest interval around ``x`` of which it is known that the tree is monotone there."""
    if not isinstance(tree, tuple):
        return _EVERYWHERE
    name, operands = str(tree[0]), tree[1:]
    inner = next((part for part in operands if _has_x(part)), None)
    if inner is None:
        return _EVERYWHERE
    within = _piece(inner, x)
    value = evaluate(inner, x)
    if math.isnan(value):
        return Piece(x, x)
    constant = next((evaluate(part, 0.0) for part in operands if part is not inner), None)
    outer = _outer_piece(name, value, constant, first=operands[0] is not inner)

    def is_inside(y: float) -> bool:
        return outer.low <= evaluate(inner, y) <= outer.high

    ends = []
    for end in (within.low, within.high):
        if is_inside(end) or end == x:
            ends.append(end)
        else:
            ends.append(_boundary(end, x, lambda y: not is_inside(y))[1])
    return Piece(ends[0], ends[1])


def _has_x(tree: Tree) -> bool:
    return any(map(_has_x, tree)) if isinstance(tree, tuple) else tree == "x"


_EVERYWHERE = Piece(-_LARGEST, _LARGEST)
_FIXED = {
    "sqrt": Piece(0.0, _LARGEST),
    "log": Piece(_SMALLEST, _LARGEST),
    "log2": Piece(_SMALLEST, _LARGEST),
    "log10": Piece(_SMALLEST, _LARGEST),
    "asin": Piece(-1.0, 1.0),
    "acos": Piece(-1.0, 1.0),
}


def _outer_piece(name: str, value: float, constant: float | None, *, first: bool) -> Piece:
    """The interval around ``value`` on which one operator is monotone; ``first``: c op x."""
    if constant is None:
        return _FIXED.get(name) or _function_piece(name, value)
    if first and name in {"/", "div", "rem"}:
        return _half(value)
    if first or name not in {"pow", "rem", "and", "wrap", "wrapu"}:
        return _EVERYWHERE
    return _power_piece(value, constant) if name == "pow" else _bits_piece(name, value, constant)


def _function_piece(name: str, value: float) -> Piece:
    if name == "abs":
        return Piece(0.0, _LARGEST) if value >= 0 else Piece(-_LARGEST, 0.0)
    if name in {"sin", "tan"}:
        return _period(value, -math.pi / 2, math.pi)
    return _period(value, 0.0, math.pi) if name == "cos" else _EVERYWHERE


def _bits_piece(name: str, value: float, constant: float) -> Piece:
    if name == "rem":
        return _remainder_piece(value, abs(constant))
    if name == "and":
        # Only a mask of the low bits is monotone, between its multiples.
        mask = int(constant)
        is_mask = mask > 0 and mask & (mask + 1) == 0
        return _period(value, 0.0, mask + 1.0) if is_mask else Piece(value, value)
    size = 2.0 ** int(constant)
    return _period(value, -size / 2 if name == "wrap" else 0.0, size)


def _half(value: float) -> Piece:
    return Piece(_SMALLEST, _LARGEST) if value > 0 else Piece(-_LARGEST, -_SMALLEST)


def _power_piece(value: float, exponent: float) -> Piece:
    whole = exponent == int(exponent)
    if exponent < 0:
        return _half(value)
    if whole and int(exponent) % 2:
        return _EVERYWHERE
    return Piece(0.0, _LARGEST) if value >= 0 or not whole else Piece(-_LARGEST, 0.0)


def _period(value: float, begin: float, length: float) -> Piece:
    """That one of the intervals ``begin + k * length`` which ``value`` is in, without its end."""
    periods = (value - begin) / length
    if not math.isfinite(periods):
        return Piece(value, value)
    low = begin + math.floor(periods) * length
    return Piece(low, math.nextafter(low + length, -math.inf))


def _remainder_piece(value: float, divisor: float) -> Piece:
    if value < 0:
        mirrored = _remainder_piece(-value, divisor)
        return Piece(-mirrored.high, -mirrored.low)
    return _period(value, 0.0, divisor)


def _boundary(inside: float, outside: float, holds: Callable[[float], bool]) -> tuple[float, float]:
    """Two neighbouring doubles between two, of which ``holds`` is true and false."""
    yes, no = _ordinal(inside), _ordinal(outside)
    while abs(yes - no) > 1:
        middle = (yes + no) // 2
        if holds(_double(middle)):
            yes = middle
        else:
            no = middle
    return _double(yes), _double(no)


def _ordinal(value: float) -> int:
    """The number of a double in their order."""
    bits: int = struct.unpack("<q", struct.pack("<d", value))[0]
    return bits if bits >= 0 else -(bits & 0x7FFFFFFFFFFFFFFF)


def _double(ordinal: int) -> float:
    bits = ordinal if ordinal >= 0 else -ordinal | -0x8000000000000000
    value: float = struct.unpack("<d", struct.pack("<q", bits))[0]
    return value


OPERATORS: Sequence[str] = (*_ONE, *_TWO)
