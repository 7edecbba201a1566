"""Which parameters give a set of thresholds: against the arithmetic itself, number by number."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from pytpc.diagnosis.thresholds.intervals import Interval, holds, words
from pytpc.diagnosis.thresholds.inverse import kept_as, preimage
from pytpc.diagnosis.thresholds.units import ParameterUnit, simplest
from pytpc.static.arithmetic import evaluate


# x^2 > 9: beyond 3 on both sides. 1 / x >= 4: above 0 up to 0.25. No square is below 0, min(x, 3)
# is never 4. |x| = 2 at -2 and 2; |x| <= 0 at 0 alone.
@pytest.mark.parametrize(
    ("tree", "wanted", "text"),
    [
        ("x", Interval.above(9), "above 9"),
        (("pow", "x", 2.0), Interval.above(9), "below -3 or above 3"),
        (("pow", "x", 3.0), Interval.below(-8), "below -2"),
        (("pow", "x", -1.0), Interval.above(4, True), "above 0 to 0.25"),
        (("pow", "x", 0.5), Interval.above(2, True), "at least 4"),
        (("pow", 2.0, "x"), Interval.above(8), "above 3"),
        (("/", 1.0, "x"), Interval.above(4, True), "above 0 to 0.25"),
        (("pow", "x", 2.0), Interval.below(0), "no value"),
        (("min", "x", 3.0), Interval.above(4, True), "no value"),
        (("min", "x", 3.0), Interval.above(3, True), "at least 3"),
        (("abs", "x"), Interval.below(0, True), "exactly 0"),
        (("abs", "x"), Interval.above(2), "below -2 or above 2"),
        (("*", 0.0, "x"), Interval.above(-1), "any value"),
        (("*", 0.0, "x"), Interval.above(1), "no value"),
        (("sqrt", "x"), Interval.below(2), "from 0 to below 4"),
        (("log", "x"), Interval.below(0, True), "above 0 to 1"),
        # trunc goes towards 0: -2.9 is -2.
        (("trunc", "x"), Interval.above(3, True), "at least 3"),
        (("trunc", "x"), Interval.point(0), "above -1 to below 1"),
        (("floor", "x"), Interval.point(-2), "from -2 to below -1"),
        (("ceil", "x"), Interval.point(-2), "above -3 to -2"),
        # 100 div n of whole numbers: 100 div 4 = 25, 100 div 5 = 20.
        (("div", 100.0, "x"), Interval(20, 21, True, False), "above 4.7619 to 5"),
        # 64 >> 2 = 16, and 2.9 is 2 when it is shifted by.
        (("shr", 64.0, "x"), Interval.above(16, True), "from 0 to below 3"),
        (("shr", "x", 2.0), Interval.point(3), "from 12 to below 16"),
        # Of 10 rem x only what is asked about is known: 10 rem 1 = 0.
        (("rem", 10.0, "x"), Interval.point(0), "exactly 1"),
        (("pow", 0.5, "x"), Interval.above(4), "below -2"),
        (("pow", -2.0, "x"), Interval.above(4), "no value"),
        (("asin", "x"), Interval.above(0, True), "from 0 to 1"),
        # 1 / e^x is 0 from the first double on where e^x overflows, 709.78.
        (("/", 1.0, ("exp", "x")), Interval.point(0), "at least 709.783"),
        # 1 / (1 / x) is 0 where 1 / x overflows: next to 0, up to 1 / the largest double.
        (
            ("/", 1.0, ("/", 1.0, "x")),
            Interval.point(0),
            "from -5.56268e-309 to below 0 or above 0 to 5.56268e-309",
        ),
        # 2 * (x - 1)^2 <= 8: |x - 1| <= 2.
        (("*", 2.0, ("pow", ("+", "x", -1.0), 2.0)), Interval.below(8, True), "from -1 to 3"),
    ],
)
def test_by_hand(tree, wanted, text):
    assert words(preimage(tree, (wanted,), 1.0)) == text


# x rem 4 around 5 is at least 3 from 3 to 4, from 7 to 8, and so on; below 0 it never is.
def test_what_begins_anew():
    found = preimage(("rem", "x", 4.0), (Interval.above(3, True),), 5.0)
    for number in (3, 3.5, 7, 7.9, 11):
        assert holds(found, number)
    for number in (2.9, 4, 6.9, 8, -3.5):
        assert not holds(found, number)
    # An unsigned byte: 266 keeps 10. 0x15 is no mask of low bits: nothing is known of it.
    assert holds(preimage(("wrapu", "x", 8.0), (Interval.above(10, True),), 259.0), 266)
    assert not holds(preimage(("wrapu", "x", 8.0), (Interval.above(10, True),), 259.0), 265)
    assert preimage(("and", "x", 21.0), (Interval.above(5, True),), 4.0) == ()
    # 200 in a signed byte is -56, 100 is 100.
    below = preimage(("wrap", "x", 8.0), (Interval.below(0),), 100.0)
    assert holds(below, 200)
    assert not holds(below, 100)
    # sin x >= 0.5 from pi / 6 to 5 pi / 6, and 2 pi further on.
    waves = preimage(("sin", "x"), (Interval.above(0.5, True),), 1.0)
    for number in (0.6, 2.6, 0.6 + 2 * math.pi):
        assert holds(waves, number)
    assert not holds(waves, 2.7)
    # cos x <= 0 from pi / 2 to 3 pi / 2.
    half = preimage(("cos", "x"), (Interval.below(0, True),), 1.0)
    assert holds(half, 1.6)
    assert holds(half, 4.7)
    assert not holds(half, 1.5)
    assert not holds(half, 4.8)
    # Where the present value has no remainder, nothing is known.
    assert preimage(("rem", ("log", "x"), 2.0), (Interval.above(1),), -1.0) == ()


# 0.1f is 0.100000001490116...: of a float the double 0.1 is not below that, as a float it is it.
def test_a_parameter_kept_in_a_float():
    single = kept_as(("*", 2.0, "x"), "float")
    assert evaluate(single, 0.1) == 0.20000000298023224
    assert kept_as(("*", 2.0, "x"), "double") == ("*", 2.0, "x")
    assert evaluate(kept_as("x", "float"), -1e300) == -math.inf
    # The parameter of a threshold of 0.1f is written 0.1.
    assert ParameterUnit(kept_as("x", "float"), 0.10000000149011612).current == 0.1
    above = preimage(kept_as("x", "float"), (Interval.above(0.10000000149011612),), 0.1)
    assert not holds(above, 0.1000000015)
    assert holds(above, 0.10000001)


# Of two roots of x^2 = 4 the default's side; without a default the positive one. pi / 180 * 45 is
# given by 45, though neighbouring doubles round to the same. No square is -1.
def test_the_present_value():
    assert ParameterUnit(("pow", "x", 2.0), 4.0, 3.0).current == 2
    assert ParameterUnit(("pow", "x", 2.0), 4.0, -3.0).current == -2
    assert ParameterUnit(("pow", "x", 2.0), 4.0).current == 2
    assert ParameterUnit(("*", math.pi / 180, "x"), 0.7853981633974483).current == 45
    assert ParameterUnit(("pow", "x", 2.0), -1.0).current is None
    assert ParameterUnit("x", 0.1).current == 0.1
    assert ParameterUnit(("trunc", "x"), 2.0).current == 2
    # The default where it gives the threshold, whatever else does.
    assert ParameterUnit(("trunc", "x"), 2.0, 2.75).current == 2.75


@pytest.mark.parametrize(
    ("interval", "value"),
    [
        (Interval.closed(0.59999, 0.60001), 0.6),
        (Interval.closed(-3, -2.5), -3),
        (Interval.closed(-1, 5), 0),
        (Interval(2, 3, False, True), 3),
        (Interval.closed(123.4, 126), 124),
        (Interval.point(0.1 + 0.2), 0.1 + 0.2),
    ],
)
def test_the_fewest_digits(interval, value):
    assert simplest(interval) == value


# The power of a negative number overflows to the other side.
def test_overflow_keeps_its_sign():
    assert evaluate(("pow", "x", 3.0), -1e200) == -math.inf
    assert evaluate(("pow", "x", 2.0), -1e200) == math.inf
    assert evaluate(("floor", ("*", 1e300, "x")), -1e300) == -math.inf
    assert evaluate(("*", -1.0, ("exp", "x")), 800) == -math.inf
    assert evaluate(("/", 1.0, ("exp", "x")), 800) == 0


CONSTANTS = st.one_of(st.integers(1, 9).map(float), st.sampled_from([0.5, 0.25, 2.5, 100.0]))


def step(inner):
    """One more operator around a tree."""
    two = st.sampled_from(["+", "*", "pow", "min", "max"])
    whole = st.sampled_from(["div", "shr"])
    one = st.sampled_from(["sqrt", "abs", "trunc", "floor", "ceil", "round", "atan", "exp", "log"])
    return st.one_of(
        st.tuples(two, inner, CONSTANTS),
        st.tuples(whole, inner, st.integers(1, 9).map(float)),
        st.tuples(st.just("+"), inner, CONSTANTS.map(lambda c: -c)),
        st.tuples(st.just("*"), st.just(-1.0), inner),
        st.tuples(st.sampled_from(["/", "div"]), CONSTANTS, inner),
        st.tuples(one, inner),
    )


TREES = st.one_of(step(st.just("x")), step(step(st.just("x"))), step(step(step(st.just("x")))))
VALUES = st.one_of(st.floats(-50, 50), st.integers(-50, 50).map(float))
WANTED = st.one_of(
    st.builds(Interval.above, st.floats(-20, 20), st.booleans()),
    st.builds(Interval.below, st.integers(-9, 9).map(float), st.booleans()),
    st.builds(Interval.point, st.integers(-9, 9).map(float)),
    st.builds(lambda a, b: Interval(a, a + b, True, False), st.floats(-9, 9), st.floats(0.1, 5)),
)
ROUGH = {"exp", "log", "atan", "pow"}


def has_rough(tree):
    """Whether an operator is in it that may round neighbouring doubles in the wrong order."""
    return isinstance(tree, tuple) and (tree[0] in ROUGH or any(map(has_rough, tree[1:])))


# The set holds a parameter just where its threshold is wanted.
@settings(max_examples=500, deadline=None)
@given(TREES, WANTED, VALUES)
@example(("pow", ("*", -1.0, "x"), 3.0), Interval.below(-8), 3.0)
@example(("/", 1.0, ("abs", "x")), Interval.above(2), -0.25)
@example(("sqrt", ("/", 1.0, ("/", 1.0, "x"))), Interval.below(1.0), -5e-324)
@example(("/", 1.0, ("/", 1.0, "x")), Interval.above(0), 5e-324)
@example(("/", 1.0, ("*", 0.0, "x")), Interval.below(0), 1.0)
def test_membership_is_that_of_the_threshold(tree, wanted, x):
    threshold = evaluate(tree, x)
    assume(math.isfinite(threshold))
    if has_rough(tree):
        ends = [end for end in (wanted.low, wanted.high) if math.isfinite(end)]
        assume(all(not math.isclose(threshold, end, rel_tol=1e-12) for end in ends))
    assert holds(preimage(tree, (wanted,), 1.0), x) == wanted.holds(threshold)


# Also next to its own ends, where arithmetic that rounds in order leaves no doubt.
@settings(max_examples=300, deadline=None)
@given(TREES, WANTED)
def test_the_ends_are_exact(tree, wanted):
    assume(not has_rough(tree))
    found = preimage(tree, (wanted,), 1.0)
    for part in found:
        for end in (part.low, part.high):
            for x in (end, math.nextafter(end, math.inf), math.nextafter(end, -math.inf)):
                threshold = evaluate(tree, x)
                if math.isfinite(x) and math.isfinite(threshold):
                    assert holds(found, x) == wanted.holds(threshold)


@settings(max_examples=300, deadline=None)
@given(TREES, VALUES)
def test_apply_then_invert(tree, x):
    threshold = evaluate(tree, x)
    assume(math.isfinite(threshold) and abs(threshold) < 1e12)
    assert ParameterUnit(tree, threshold, x).current == x
    # Without the default a value is found that gives the same.
    found = ParameterUnit(tree, threshold).current
    assert found is not None
    assert evaluate(tree, found) == pytest.approx(threshold, rel=1e-6, abs=1e-6)
