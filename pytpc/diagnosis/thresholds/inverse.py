"""Computes which values of a parameter give a set of thresholds.

A tree is inverted from its outermost operator to its innermost. Each operator, as a function of its
operand that holds the parameter, is monotone on pieces, which are listed here. On a piece an end of
an interval is found by bisection over the doubles, with the same arithmetic as ``evaluate``: a
double is in the result exactly if its threshold is in the set. Overflow is not special: 1 / (1 / x)
is 0 where 1 / x is infinite. Of periodic operators (sines, remainders) only the pieces next to a
given value are searched.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from itertools import pairwise

from pytpc.diagnosis.thresholds.intervals import Interval, Intervals, union
from pytpc.static.arithmetic import SINGLE, Tree, evaluate

_LARGEST = 1.7976931348623157e308
_SMALLEST = 5e-324
_PERIODS = 2
_ROUNDER = 4
_EVERYWHERE = [(-math.inf, math.inf)]
_NOT_NEGATIVE = (0.0, math.inf)
_NOT_POSITIVE = (-math.inf, 0.0)
_POSITIVE = (_SMALLEST, math.inf)
_NEGATIVE = (-math.inf, -_SMALLEST)

Pieces = list[tuple[float, float]]
Function = Callable[[float], float]


def preimage(tree: Tree, wanted: Intervals, near: float) -> Intervals:
    """The parameters whose threshold lies in ``wanted``; about ``near`` where there is no end.

    Infinite values of the parameter are in no result. Where the sine and its kind round
    differently at two neighbouring doubles, the ends are exact but for such a neighbour.
    """
    # What overflows is beyond every number, and so in an interval without that end.
    extended = tuple(
        Interval(
            part.low,
            part.high,
            part.low_inclusive or math.isinf(part.low),
            part.high_inclusive or math.isinf(part.high),
        )
        for part in wanted
    )
    return _finite(_extended_preimage(tree, extended, near))


def _extended_preimage(tree: Tree, wanted: Intervals, near: float) -> Intervals:
    """The same with infinity as a number, which is in an interval that includes it."""
    if not isinstance(tree, tuple):
        return wanted if isinstance(tree, str) else ()
    inner, apply, pieces = _operator(tree, near)
    found = []
    for low, high in pieces:
        for interval in wanted:
            found.append(_on_piece(apply, low, high, interval))
    return _extended_preimage(inner, union(part for part in found if part is not None), near)


def _finite(wanted: Intervals) -> Intervals:
    """The finite numbers of a set; one that goes up to the last of them has no end there."""
    return union(
        Interval(
            part.low if part.first() > -_LARGEST else -math.inf,
            part.high if part.last() < _LARGEST else math.inf,
            part.low_inclusive and part.first() > -_LARGEST,
            part.high_inclusive and part.last() < _LARGEST,
        )
        for part in wanted
        if part.first() <= _LARGEST and part.last() >= -_LARGEST
    )


def _operator(tree: tuple[Tree, ...], near: float) -> tuple[Tree, Function, Pieces]:
    """The operand that holds the parameter, the operator as its function, its monotone pieces."""
    name, operands = str(tree[0]), tree[1:]
    place = next((i for i, part in enumerate(operands) if _has_x(part)), 0)
    inner = operands[place]
    value = evaluate(inner, near)
    if len(operands) == 1:
        return inner, lambda y: evaluate((name, "x"), y), _pieces_of_one(name, value)
    constant = evaluate(operands[1 - place], 0.0)
    if place == 0:
        pieces = _pieces_of_first(name, constant, value)
        return inner, lambda y: evaluate((name, "x", constant), y), pieces
    pieces = _pieces_of_second(name, constant, value)
    return inner, lambda y: evaluate((name, constant, "x"), y), pieces


def _has_x(tree: Tree) -> bool:
    return any(map(_has_x, tree[1:])) if isinstance(tree, tuple) else isinstance(tree, str)


def _pieces_of_one(name: str, value: float) -> Pieces:
    fixed: dict[str, Pieces] = {
        "sqrt": [_NOT_NEGATIVE],
        "abs": [_NOT_POSITIVE, _NOT_NEGATIVE],
        "log": [_POSITIVE],
        "log2": [_POSITIVE],
        "log10": [_POSITIVE],
        "asin": [(-1.0, 1.0)],
        "acos": [(-1.0, 1.0)],
    }
    if name in {"sin", "tan"}:
        return _periods(value, -math.pi / 2, math.pi)
    if name == "cos":
        return _periods(value, 0.0, math.pi)
    return fixed.get(name, _EVERYWHERE)


def _pieces_of_first(name: str, constant: float, value: float) -> Pieces:
    """Pieces of ``x name constant``."""
    if name == "pow":
        return _pieces_of_power(constant)
    if name == "rem":
        return _remainder_pieces(value, abs(constant))
    if name == "and":
        # Only a mask of the low bits is monotone between its multiples.
        mask = int(constant) if math.isfinite(constant) else 0
        is_mask = mask > 0 and mask & (mask + 1) == 0
        return _whole_periods(value, 0.0, mask + 1.0) if is_mask else []
    if name in {"wrap", "wrapu"}:
        size = 2.0 ** int(constant)
        return _whole_periods(value, -size / 2 if name == "wrap" else 0.0, size)
    return _EVERYWHERE


def _pieces_of_second(name: str, constant: float, value: float) -> Pieces:
    """Pieces of ``constant name x``."""
    if name in {"/", "div"}:
        return [_NEGATIVE, _POSITIVE]
    if name == "pow":
        return _EVERYWHERE if constant > 0 else []
    if name == "shr":
        return [(0.0, 63.0)]
    if name in {"rem", "and", "wrap", "wrapu"}:
        return [(value, value)]
    return _EVERYWHERE


def _pieces_of_power(exponent: float) -> Pieces:
    whole = exponent == math.floor(exponent)
    if exponent < 0:
        return [_NEGATIVE, _POSITIVE] if whole else [_POSITIVE]
    if not whole:
        return [_NOT_NEGATIVE]
    return _EVERYWHERE if exponent % 2 == 1 else [_NOT_POSITIVE, _NOT_NEGATIVE]


def _periods(value: float, begin: float, length: float) -> Pieces:
    """Those of the intervals ``begin + k * length``, each without its end, next to ``value``."""
    number = (value - begin) / length if length else math.nan
    if not math.isfinite(number) or abs(number) > 2**50:
        return []
    middle = math.floor(number)
    lows = [begin + k * length for k in range(middle - _PERIODS, middle + _PERIODS + 2)]
    return [(a, math.nextafter(b, -math.inf)) for a, b in pairwise(lows)]


def _whole_periods(value: float, begin: float, length: float) -> Pieces:
    """The same for what takes the whole part, towards zero, of its operand first."""
    pieces = []
    for low, high in _periods(value, begin, length):
        last = math.nextafter(high, math.inf) - 1
        first = math.nextafter(low - 1, math.inf) if low <= 0 else low
        pieces.append((first, last if last < 0 else high))
    return pieces


def _remainder_pieces(value: float, divisor: float) -> Pieces:
    """Towards zero: below zero the pieces are the mirrored ones."""
    pieces = []
    for low, high in _periods(abs(value), 0.0, divisor):
        if low >= 0:
            pieces += [(low, high), (-high, -low)]
    return pieces


def _on_piece(apply: Function, low: float, high: float, wanted: Interval) -> Interval | None:
    """The values of a piece that ``apply`` takes into ``wanted``; None where there are none."""
    # Where infinity gives no number (0 * x), the piece ends before it.
    low, high = (_nearest_with_value(apply, end) for end in (low, high))
    at_low, at_high = apply(low), apply(high)
    if math.isnan(at_low) or math.isnan(at_high):
        return None

    def is_above(y: float) -> bool:
        return apply(y) >= wanted.low if wanted.low_inclusive else apply(y) > wanted.low

    def is_below(y: float) -> bool:
        return apply(y) <= wanted.high if wanted.high_inclusive else apply(y) < wanted.high

    rises = at_low <= at_high
    enters, leaves = (is_above, is_below) if rises else (is_below, is_above)
    if not enters(high) or not leaves(low):
        return None
    # The bound that is met first on the way up, and the one that is met last.
    near_bound, far_bound = (wanted.low, wanted.high) if rises else (wanted.high, wanted.low)
    begin, begin_in = _end(apply, high, low, enters, near_bound)
    end, end_in = _end(apply, low, high, leaves, far_bound)
    found = Interval(begin, end, begin_in, end_in)
    return None if found.is_empty else found


def _nearest_with_value(apply: Function, end: float) -> float:
    endless = math.isinf(end) and math.isnan(apply(end))
    return math.copysign(_LARGEST, end) if endless else end


def _end(
    apply: Function, inside: float, outside: float, is_in: Callable[[float], bool], bound: float
) -> tuple[float, bool]:
    """Where, on the way from ``inside`` to ``outside``, it ends; and whether the end is in it."""
    if is_in(outside):
        if abs(outside) == _SMALLEST:
            return 0.0, False
        return outside, True
    yes, no = _boundary(inside, outside, is_in)
    # Of two neighbours the one that reads better: "below 3", not "at most 2.9999999999999996".
    is_round = len(repr(no)) < len(repr(yes)) - _ROUNDER
    return (no, False) if is_round or apply(no) == bound else (yes, True)


def _boundary(inside: float, outside: float, is_in: Callable[[float], bool]) -> tuple[float, float]:
    """Two neighbouring doubles between two, of which one is in it and the other is not."""
    yes, no = _ordinal(inside), _ordinal(outside)
    while abs(yes - no) > 1:
        middle = (yes + no) // 2
        if is_in(_double(middle)):
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


def kept_as(tree: Tree, type_: str | None) -> Tree:
    """``tree`` of a parameter that the program keeps in a variable of a C++ type."""
    if type_ != "float":
        return tree
    if isinstance(tree, tuple):
        return (tree[0], *(kept_as(part, type_) for part in tree[1:]))
    return (SINGLE, "x") if isinstance(tree, str) else tree
