"""How a parameter gives the threshold of a comparison, and back: its arithmetic and its type."""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context
from functools import cached_property, lru_cache

import numpy as np

from pytpc.base.columns import Floats
from pytpc.diagnosis.thresholds.intervals import Interval, Intervals
from pytpc.diagnosis.thresholds.inverse import kept_as, preimage
from pytpc.static.arithmetic import Tree, evaluate
from pytpc.static.link_unit import Comparison, LinkUnit
from pytpc.static.parameters import same_parameter

_WHOLE_TYPES = frozenset(
    f"{sign}{name}"
    for sign in ("", "unsigned ", "signed ")
    for name in ("char", "short", "int", "long", "long long")
)
_FLOAT_TYPES = frozenset({"float", "double", "long double"})
_CLOSE = 1e-9
_TINY = 1e-12

_LONGEST_TEXT = 500


class NoUnitError(Exception):
    """Why a threshold cannot be worked out from its parameter."""


@dataclass(frozen=True)
class ParameterUnit:
    """A tree, at the threshold that it gives now.

    ``anchor`` is the first guess of the parameter's value: its default, if there is one.
    """

    tree: Tree
    threshold: float
    anchor: float | None = None

    def forward(self, parameter: float) -> float:
        """The threshold that a value of the parameter gives; NaN if there is none."""
        return evaluate(self.tree, parameter)

    @cached_property
    def current(self) -> float | None:
        """The value of the parameter; None if no value gives ``threshold``.

        If several values do: the anchor, else the one next to it, else the smallest, positive ones
        first. If several round to the same threshold: the one with the fewest digits.
        """
        anchor, t = self.anchor, self.threshold
        if self.tree == "x" or not math.isfinite(t):
            return t
        if anchor is not None and _is_close(self.forward(anchor), t):
            return anchor
        near = 1.0 if anchor is None else anchor
        slack = max(abs(t) * _CLOSE, _TINY)
        for wanted in (Interval.point(t), Interval.closed(t - slack, t + slack)):
            values = [simplest(part) for part in preimage(self.tree, (wanted,), near)]
            if values and anchor is not None:
                return min(values, key=lambda value: abs(value - near))
            if values:
                return min(values, key=lambda value: (value < 0, abs(value)))
        return None

    def parameters(self, thresholds: Intervals) -> Intervals:
        """All parameters that give one of ``thresholds``, see `preimage`."""
        near = self.current
        return preimage(self.tree, thresholds, 1.0 if near is None else near)


def unit_of(comparison: Comparison, unit: LinkUnit | None, threshold: float) -> ParameterUnit:
    """How the parameter of ``comparison`` gives ``threshold`` now.

    Raises:
        NoUnitError: the file does not say how.
    """
    tree = tree_of(comparison)
    default = comparison.default
    anchor = None if default is None or isinstance(default, str) else float(default)
    kept = ParameterUnit(kept_as(tree, read_type(comparison, unit)), threshold, anchor)
    # The program may read a float and compute in doubles, or the other way round.
    return kept if kept.current is not None else ParameterUnit(tree, threshold, anchor)


def tree_of(comparison: Comparison) -> Tree:
    """The arithmetic from the parameter to the threshold.

    Raises:
        NoUnitError: the file does not say what it is.
    """
    transform = comparison.transform
    if transform is None:
        return "x"
    if transform.tree is not None:
        return transform.tree
    if transform.kind != "affine" or transform.scale is None or transform.offset is None:
        raise NoUnitError(f"the threshold is computed from the parameter: {transform.text}")
    if transform.scale == 0:
        raise NoUnitError("the parameter is multiplied by 0")
    scaled: Tree = "x" if transform.scale == 1 else ("*", float(transform.scale), "x")
    return scaled if transform.offset == 0 else ("+", scaled, float(transform.offset))


def added_by(comparison: Comparison) -> float | None:
    """By how much a threshold moves with its parameter, where other values are only added to it.

    1 for ``x + start``, 1000 for ``now - 1000 * x`` with the sign of the text; None where other
    values multiply the parameter, or the text says something else. Not of thresholds with a tree.
    """
    transform = comparison.transform
    if transform is None or transform.kind != "expression" or transform.tree is not None:
        return None
    return _slope_of(transform.text)


@lru_cache(4096)
def _slope_of(text: str) -> float | None:
    if len(text) > _LONGEST_TEXT:
        return None
    try:
        slope = _slope(ast.parse(text.replace("->", ".").replace("::", "_"), mode="eval").body)
    except (SyntaxError, ValueError, RecursionError, ArithmeticError, MemoryError):
        return None
    return slope if slope and math.isfinite(slope) else None


def _slope(node: ast.expr) -> float:
    """The constant factor of ``x`` in an expression.

    Raises:
        ValueError: there is no such factor.
    """
    match node:
        case ast.Name(id="x"):
            return 1.0
        case _ if not any(isinstance(one, ast.Name) and one.id == "x" for one in ast.walk(node)):
            return 0.0
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            slope = -_slope(operand)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            slope = _slope(left) + _slope(right)
        case ast.BinOp(left=left, op=ast.Sub(), right=right):
            slope = _slope(left) - _slope(right)
        case ast.BinOp(
            left=ast.Constant(value=int() | float() as factor), op=ast.Mult(), right=one
        ):
            slope = factor * _slope(one)
        case ast.BinOp(
            left=one, op=ast.Mult(), right=ast.Constant(value=int() | float() as factor)
        ):
            slope = factor * _slope(one)
        case ast.BinOp(left=one, op=ast.Div(), right=ast.Constant(value=int() | float() as factor)):
            slope = _slope(one) / factor
        case _:
            raise ValueError("not only added")
    return slope


def threshold_of(comparison: Comparison, value: float) -> float:
    """The threshold that a value of the parameter gives; NaN if that is not known."""
    try:
        return evaluate(tree_of(comparison), value)
    except (ArithmeticError, ValueError, NoUnitError):
        return math.nan


def read_type(comparison: Comparison, unit: LinkUnit | None) -> str | None:
    """The C++ type of the variable that the parameter is read into, if it is known."""
    place, source = comparison.read_at, comparison.source
    if unit is None or place is None or source is None:
        return None
    there = [
        read for read in unit.parameters if (read.file, read.lineno) == (place.file, place.lineno)
    ]
    for read in there:
        if read.name == source:
            return read.type
    # A mission may have told the name of the read, or only the number of the object.
    alike = [read for read in there if same_parameter(read.name, source)] or there
    types = {read.type for read in alike}
    return types.pop() if len(types) == 1 else None


def is_text(comparison: Comparison, unit: LinkUnit | None) -> bool:
    """Whether the parameter is text, of which only results are logged."""
    type_ = read_type(comparison, unit) or ""
    return isinstance(comparison.default, str) or type_.startswith("std::")


def is_whole(comparison: Comparison, unit: LinkUnit | None, values: Floats) -> bool:
    """Whether a parameter takes whole numbers only.

    The C++ type decides. If it is not known: the default is an int, and all ``values`` (float64[n],
    seen of the parameter) are whole except for rounding.
    """
    type_ = read_type(comparison, unit)
    if type_ in _WHOLE_TYPES:
        return True
    if type_ in _FLOAT_TYPES:
        return False
    finite = values[np.isfinite(values)]
    return type(comparison.default) is int and bool(
        np.allclose(finite, np.round(finite), rtol=1e-9, atol=1e-9)
    )


def is_unsigned(comparison: Comparison, unit: LinkUnit | None) -> bool:
    """Whether the variable that is read into holds no negative number."""
    return (read_type(comparison, unit) or "").startswith("unsigned")


def simplest(interval: Interval) -> float:
    """The number in an interval with the fewest digits; the smallest of several."""
    low, high = interval.first(), interval.last()
    if interval.holds(0.0):
        return 0.0
    if high < 0:
        low, high = -high, -low
    for digits in range(1, 18):
        value = float(Context(prec=digits, rounding=ROUND_CEILING).create_decimal(repr(low)))
        if value <= high:
            return value if interval.low >= 0 else -value
    return interval.first()


def _is_close(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=_CLOSE, abs_tol=_TINY)
