"""Thresholds that are computed from a parameter: evaluated, and inverted."""

from __future__ import annotations

import math

import pytest
from static_units import comparison, unit

from pytpc.base.checked_json import check_unit
from pytpc.static.arithmetic import OPERATORS, evaluate, from_json


# By hand, at x = 5 unless it says otherwise; remainders and divisions are C++'s, to zero.
@pytest.mark.parametrize(
    ("tree", "x", "value"),
    [
        (("+", ("*", 2, "x"), 1), 5, 11),
        (("/", 10, "x"), 5, 2),
        (("div", "x", 2), -5, -2),
        (("rem", "x", 3), -5, -2),
        (("shr", "x", 1), -5, -3),
        (("and", "x", 6), 5, 4),
        (("pow", "x", 3), 5, 125),
        (("pow", 2, "x"), 5, 32),
        (("min", "x", 3), 5, 3),
        (("max", "x", 3), 5, 5),
        (("wrap", "x", 8), 130, -126),
        (("wrapu", "x", 8), -1, 255),
        (("sqrt", "x"), 9, 3),
        (("abs", "x"), -5, 5),
        (("trunc", "x"), -2.5, -2),
        (("floor", "x"), -2.5, -3),
        (("ceil", "x"), -2.5, -2),
        (("round", "x"), -2.5, -3),
        (("cos", "x"), 0, 1),
        (("atan", ("tan", "x")), 1, pytest.approx(1)),
        (("log2", "x"), 8, 3),
        (("log10", ("exp", "x")), 0, 0),
    ],
)
def test_operators(tree, x, value):
    assert evaluate(tree, x) == value


def test_what_has_no_value_is_nan_or_infinite():
    assert math.isnan(evaluate(("sqrt", "x"), -1))
    assert math.isnan(evaluate(("/", 1, "x"), 0))
    assert math.isnan(evaluate(("pow", "x", 0.5), -1))
    assert evaluate(("exp", "x"), 1e4) == math.inf


def test_json_goes_there():
    assert from_json(["+", ["*", 2, "x"], 1]) == ("+", ("*", 2.0, "x"), 1.0)


# The schema knows the operators that are evaluated, and no others.
def test_the_schema_knows_each_operator(tmp_path):
    for name in OPERATORS:
        how = {"kind": "expression", "text": "", "tree": [name, "x", 2]}
        check_unit(unit(comparisons=[comparison(type="derived", transform=how)]), tmp_path)
    how = {"kind": "expression", "text": "", "tree": ["system", "x"]}
    with pytest.raises(Exception, match="tree"):
        check_unit(unit(comparisons=[comparison(type="derived", transform=how)]), tmp_path)
