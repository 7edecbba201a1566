"""Sets of numbers as intervals: their algebra, checked number by number."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytpc.diagnosis.thresholds.intervals import (
    EVERYWHERE,
    Interval,
    gaps,
    holds,
    intersection,
    union,
    words,
)

INF = math.inf
# Whole ends, so that the numbers that are asked about are often just there.
ENDS = st.integers(-4, 4).map(float)
INTERVALS = (
    st.builds(
        lambda a, b, low, high: Interval(min(a, b), max(a, b), low, high),
        ENDS,
        ENDS,
        st.booleans(),
        st.booleans(),
    )
    | st.builds(Interval.above, ENDS, st.booleans())
    | st.builds(Interval.below, ENDS, st.booleans())
)
SETS = st.lists(INTERVALS, max_size=4)
NUMBERS = st.integers(-10, 10).map(lambda n: n / 2)


@pytest.mark.parametrize(
    ("interval", "text", "inside", "outside"),
    [
        (Interval.above(3), "above 3", [3.1, 1e308], [3, 2, INF]),
        (Interval.above(3, inclusive=True), "at least 3", [3, 4], [2.9]),
        (Interval.below(0.5), "below 0.5", [0.4, -1e308], [0.5, -INF]),
        (Interval.below(0.5, inclusive=True), "at most 0.5", [0.5], [0.6]),
        (Interval.point(4), "exactly 4", [4], [3.9, 4.1]),
        (Interval(1, 2, True, False), "from 1 to below 2", [1, 1.9], [0.9, 2]),
        (Interval(1, 2, False, True), "above 1 to 2", [1.1, 2], [1, 2.1]),
        (Interval.closed(None, 2), "at most 2", [2, -9], [2.1]),
        (Interval(), "any value", [0, -1e308], [INF, math.nan]),
    ],
)
def test_what_is_inside_and_how_it_is_called(interval, text, inside, outside):
    assert interval.words() == text
    assert all(interval.holds(number) for number in inside)
    assert not any(interval.holds(number) for number in outside)


def test_ends_as_doubles():
    assert Interval(1, 2, True, False).first() == 1
    assert Interval(1, 2, True, False).last() == math.nextafter(2, 0)
    assert Interval().first() == -1.7976931348623157e308
    assert Interval(1, 1, True, False).is_empty
    assert Interval(2, math.nextafter(2, 3), False, False).is_empty
    assert not Interval.point(1).is_empty
    # Nothing is above infinity.
    assert Interval.above(INF).is_empty
    assert Interval.below(-INF, inclusive=True).is_empty


def test_words_of_sets():
    assert words((Interval.below(1), Interval.above(3))) == "below 1 or above 3"
    assert words(()) == "no value"


# [0, 1) and [1, 2] have nothing between them; [0, 1) and (1, 2] have 1.
def test_union_joins_what_touches():
    assert union([Interval(1, 2, True, True), Interval(0, 1, True, False)]) == (
        Interval(0, 2, True, True),
    )
    apart = (Interval(0, 1, True, False), Interval(1, 2, False, True))
    assert union(reversed(apart)) == apart
    assert gaps(apart) == (Interval.point(1),)


@given(SETS, NUMBERS)
def test_union_holds_what_one_of_them_holds(parts, number):
    assert holds(union(parts), number) == any(part.holds(number) for part in parts)


@given(SETS, SETS, NUMBERS)
def test_intersection_holds_what_both_hold(first, second, number):
    both = intersection(union(first), union(second))
    assert holds(both, number) == (holds(first, number) and holds(second, number))


@given(SETS)
def test_sets_are_in_order_and_apart(parts):
    found = union(parts)
    for before, after in pairwise(found):
        assert before.high <= after.low
        assert not gaps((before, after))[0].is_empty


@given(SETS, NUMBERS)
def test_everything_changes_nothing(parts, number):
    assert holds(intersection(parts, EVERYWHERE), number) == holds(parts, number)
