"""How far a compared value was from its threshold, with a sign that says whether it holds."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from pytpc.base.columns import Floats, Int32s, frozen
from pytpc.diagnosis.thresholds.units import NoUnitError, added_by, tree_of
from pytpc.static.arithmetic import Tree, evaluate
from pytpc.static.link_unit import Comparison

_KINDS = {">": 0, ">=": 0, "<": 1, "<=": 1, "==": 2, "!=": 3}
_NO_KIND = 4


def slope_of(comparison: Comparison) -> float | None:
    """By how much the threshold moves with its parameter; None if that is not one number.

    ``threshold = 2 * x + 1`` has the slope 2, ``threshold = x * x`` has none.
    """
    if comparison.source is None:
        return None
    try:
        slope = _slope(tree_of(comparison))
    except NoUnitError:
        slope = added_by(comparison)
    return slope if slope is not None and slope and math.isfinite(slope) else None


def _slope(tree: Tree) -> float | None:
    """The slope of a sum, product or quotient with constants; None of anything else."""
    if tree == "x":
        return 1.0
    if not isinstance(tree, tuple) or len(tree) != 3:
        return None
    name, left, right = tree
    if name == "/" and not _holds_x(right):
        slope, by = _slope(left), evaluate(right, math.nan)
        return None if slope is None or not by else slope / by
    if name not in ("+", "*"):
        return None
    one, constant = (left, right) if _holds_x(left) else (right, left)
    slope = None if _holds_x(constant) else _slope(one)
    if slope is None or name == "+":
        return slope
    return slope * evaluate(constant, math.nan)


def _holds_x(tree: Tree) -> bool:
    if isinstance(tree, tuple):
        return any(map(_holds_x, tree[1:]))
    return tree == "x"


@dataclass(frozen=True, eq=False)
class MarginRules:
    """The rules of n comparisons: ``kind`` int32[n], ``scale`` float64[n].

    ``in_parameters`` says of each whether its margin is in the unit of its parameter; else it is in
    that of the compared values.
    """

    kind: Int32s
    scale: Floats
    in_parameters: tuple[bool, ...]

    @classmethod
    def of(cls, comparisons: Iterable[Comparison]) -> MarginRules:
        """The rules of some comparisons, in their order."""
        found = list(comparisons)
        slopes = [slope_of(one) for one in found]
        kinds = [_KINDS.get(one.relation, _NO_KIND) for one in found]
        scale = [1.0 if slope is None else 1.0 / abs(slope) for slope in slopes]
        return cls(
            frozen(np.array(kinds, np.int32)),
            frozen(np.array(scale, np.float64)),
            tuple(slope is not None for slope in slopes),
        )

    def margins(self, which: Int32s, cmp: Floats, thresh: Floats) -> Floats:
        """float64[m]: the margins of m evaluations; ``which`` int32[m] says of which comparison.

        Above 0 the comparison holds, below 0 it does not. At 0, ``>=``, ``<=`` and ``==`` hold. The
        margin of ``==`` is never above 0 and that of ``!=`` never below. A flag has none (NaN).
        """
        with np.errstate(invalid="ignore", over="ignore"):
            over = (cmp - thresh) * self.scale[which]
        none = np.full(over.shape, np.nan)
        choices = [over, -over, -np.abs(over), np.abs(over), none]
        found: Floats = np.choose(self.kind[which], choices)
        return found
