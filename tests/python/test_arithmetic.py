"""Thresholds that are computed from a parameter: evaluated, and inverted."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from static_units import comparison, unit

from pytpc.advice.thresholds import HalfLine
from pytpc.arithmetic import OPERATORS, Expression, evaluate, from_json
from pytpc.static_json import check_unit


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


# x^2 > 9 from x = 2: above 3; from x = -2 (so the default says): below -3.
def test_the_piece_of_the_present_value():
    above = HalfLine(9, False, True)
    assert Expression(("pow", "x", 2), 4, 2.0).parameters(above) == HalfLine(3, False, True)
    assert Expression(("pow", "x", 2), 4, -2.0).parameters(above) == HalfLine(-3, False, False)
    # Nobody knows the default: a positive one is taken.
    assert Expression(("pow", "x", 2), 4).current == pytest.approx(2)
    # 1 / x is turned: at least 4 are at most 0.25.
    turned = Expression(("/", 1, "x"), 1, 1.0).parameters(HalfLine(4, True, True))
    assert turned == HalfLine(0.25, True, False)
    # No square is below 0; min(x, 3) never gets to 4; |x| of 2 comes to 0, and no further.
    assert Expression(("pow", "x", 2), 4, 2.0).parameters(HalfLine(0, False, False)) is None
    assert Expression(("min", "x", 3), 2, 2.0).parameters(HalfLine(4, True, True)) is None
    assert Expression(("abs", "x"), 2, 2.0).parameters(HalfLine(0, True, False)) == HalfLine(
        0, True, False
    )


# trunc(x) >= 3 from 3 on; x rem 4 from 5 (1) gets to 3 at 7 (floor 3.0 of doubles) and not to 4.
def test_steps():
    assert Expression(("trunc", "x"), 2, 2.5).parameters(HalfLine(3, True, True)) == HalfLine(
        3, True, True
    )
    assert Expression(("rem", "x", 4), 1, 5.0).parameters(HalfLine(3, True, True)) == HalfLine(
        7, True, True
    )
    assert Expression(("rem", "x", 4), 1, 5.0).parameters(HalfLine(4, True, True)) is None
    assert Expression(("wrapu", "x", 8), 3, 259.0).parameters(HalfLine(10, True, True)) == (
        HalfLine(266, True, True)
    )
    # 0x15 is no mask of the low bits: bits come and go.
    assert Expression(("and", "x", 21), 4, 4.0).parameters(HalfLine(5, True, True)) is None


CONSTANTS = st.one_of(st.integers(1, 9).map(float), st.sampled_from([0.5, 0.25, 2.5, 100.0]))


def step(inner):
    """One more operator around a tree."""
    two = st.sampled_from(["+", "*", "pow", "min", "max"])
    whole = st.sampled_from(["div", "rem", "shr"])
    one = st.sampled_from(["sqrt", "abs", "trunc", "floor", "ceil", "sin", "atan", "exp", "log"])
    return st.one_of(
        st.tuples(two, inner, CONSTANTS),
        st.tuples(whole, inner, st.integers(1, 9).map(float)),
        st.tuples(st.just("+"), inner, CONSTANTS.map(lambda c: -c)),
        st.tuples(st.just("*"), st.just(-1.0), inner),
        st.tuples(st.sampled_from(["/"]), CONSTANTS, inner),
        st.tuples(one, inner),
    )


TREES = st.one_of(step(st.just("x")), step(step(st.just("x"))), step(step(step(st.just("x")))))
VALUES = st.one_of(st.floats(-50, 50), st.integers(-50, 50).map(float))


@settings(max_examples=500, deadline=None)
@given(TREES, VALUES)
# Looking for the value, exp() goes beyond all periods of the remainder.
@example(("rem", ("exp", ("trunc", "x")), 1.0), 3.0)
def test_apply_then_invert(tree, x):
    threshold = evaluate(tree, x)
    assume(math.isfinite(threshold) and abs(threshold) < 1e12)
    assert Expression(tree, threshold, x).current == x
    # Without the default some value is found that gives the same, or none.
    found = Expression(tree, threshold).current
    if found is not None:
        assert evaluate(tree, found) == pytest.approx(threshold, rel=1e-6, abs=1e-6)


@settings(max_examples=500, deadline=None)
@given(
    TREES, VALUES, st.builds(HalfLine, st.floats(-20, 20), *[st.booleans()] * 2), st.floats(0, 1)
)
def test_half_lines_are_the_nearest(tree, x, line, between):
    threshold = evaluate(tree, x)
    assume(math.isfinite(threshold) and abs(threshold) < 1e12)
    assume(not line.holds(threshold))
    how = Expression(tree, threshold, x)
    mine = how.parameters(line)
    assume(mine is not None)
    first = mine.bound
    if not mine.inclusive:
        first = math.nextafter(first, math.inf if mine.up else -math.inf)
    assert mine.up == (first > x)
    assert line.holds(evaluate(tree, first))
    # Nothing between the present value and the end does it.
    nearer = x + (mine.bound - x) * between
    if (nearer < first) if mine.up else (nearer > first):
        assert not line.holds(evaluate(tree, nearer))


# Simple functions, whose inverse is written down here, are inverted wherever they have one.
@settings(max_examples=300, deadline=None)
@given(st.floats(0.01, 100))
def test_against_written_inverses(x):
    for tree, there in [
        (("sqrt", "x"), math.sqrt(x)),
        (("pow", "x", 3), x**3),
        (("/", 3, "x"), 3 / x),
        (("+", ("*", -2, ("log", "x")), 1), 1 - 2 * math.log(x)),
    ]:
        assert Expression(tree, there).current == pytest.approx(x, rel=1e-6)
