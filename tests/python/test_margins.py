"""Margins: their unit and their sign."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mission_samples import comparison

from pytpc.diagnosis.thresholds.margins import MarginRules, slope_of
from pytpc.static.arithmetic import Tree
from pytpc.static.link_unit import Comparison, Transform


def margin(one: Comparison, cmp: float, thresh: float) -> float:
    columns = (np.array([value]) for value in (cmp, thresh))
    return float(MarginRules.of([one]).margins(np.zeros(1, np.int32), *columns)[0])


# 5 against 3 is 2 above: > and >= hold, < and <= do not; == misses by 2, != holds by 2.
@pytest.mark.parametrize(
    ("relation", "wanted"),
    [(">", 2.0), (">=", 2.0), ("<", -2.0), ("<=", -2.0), ("==", -2.0), ("!=", 2.0)],
)
def test_the_sign_says_whether_it_holds(relation: str, wanted: float) -> None:
    assert margin(comparison(0, "~a", relation), 5.0, 3.0) == wanted


def test_a_flag_has_no_margin() -> None:
    assert math.isnan(margin(comparison(0, "~a", "flag"), 1.0, 1.0))


def test_what_is_not_finite_has_no_margin_or_an_infinite_one() -> None:
    assert math.isnan(margin(comparison(0, "~a"), math.inf, math.inf))
    assert margin(comparison(0, "~a"), math.inf, 3.0) == math.inf


# The threshold moves by so much when the parameter moves by one.
@pytest.mark.parametrize(
    ("tree", "slope"),
    [
        ("x", 1.0),
        (("*", 2.0, "x"), 2.0),
        (("+", ("*", "x", -4.0), 7.0), -4.0),
        (("/", "x", 4.0), 0.25),
        (("/", 1.0, "x"), None),
        (("pow", "x", 2.0), None),
        (("*", 0.0, "x"), None),
        (("/", "x", 0.0), None),
        (("+", "x", ("*", 2.0, 3.0)), 1.0),
    ],
)
def test_the_slope_of_a_threshold(tree: Tree, slope: float | None) -> None:
    transform = Transform("expression", tree=tree)
    assert slope_of(comparison(0, "~a", transform=transform)) == slope


# The threshold is -4 * x: 5 > 3 holds by 2 of the value, and half a unit of the parameter.
def test_a_margin_is_in_the_unit_of_the_parameter() -> None:
    transform = Transform("affine", -4.0, 0.0)
    assert margin(comparison(0, "~a", transform=transform), 5.0, 3.0) == 0.5
