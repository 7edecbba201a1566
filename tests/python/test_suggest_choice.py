"""Which of the values that would do is suggested: range, step, whole numbers, choices, sign."""

from __future__ import annotations

import math

import pytest
from asking import suggested
from hypothesis import given
from hypothesis import strategies as st
from mission_samples import comparison, events, link_unit

from pytpc.diagnosis.suggestion.choice import Choice, Possible, choose, readable
from pytpc.diagnosis.suggestion.plausible import NOBODY, Doubt
from pytpc.diagnosis.thresholds.intervals import Interval, words
from pytpc.recording.declaration import Declared
from pytpc.static.link_unit import ParameterRead


def declared(type_="double", low=None, high=None, **changes):
    plain = {"step": None, "default": None, "choices": (), "description": "", "place": "a.cfg:1"}
    return Declared("limit", type_, low, high, **{**plain, **changes})


def ask(rows, kind="II", relation=">", about=None, **changes):
    """The suggestion at 100 s; rows are (s, cmp, thresh) and results follow from the relation."""
    unit = changes.pop("unit", None)
    found = comparison(0, "limit", relation, **changes)
    compare = {
        ">": float.__gt__, "<": float.__lt__, "==": float.__eq__, "!=": float.__ne__,
        "flag": lambda cmp, _: cmp != 0,
    }[relation]  # fmt: skip
    table = events([(t, 0, compare(float(c), float(thresh)), c, thresh) for t, c, thresh in rows])
    return suggested(table, found, 100, kind, unit=unit, declared=about)


# value > limit was False at 0.31274 with limit 0.6: below that it is True. 0..1 holds 0.312.
# From 0.3 on the first number is the last double below 0.31274; three digits (0.312) are in range.
# With 0.31273 as the lower end there is only a little left, which 6 digits do not tell apart:
# 0.31273 is the next shorter one inside.
def test_within_the_declared_range():
    rows = [(99, 0.31274, 0.6)]
    assert ask(rows, about=declared(low=0, high=1)).value == 0.312
    narrow = ask(rows, about=declared(low=0.31273, high=1))
    assert narrow.value == 0.31273
    none = ask(rows, about=declared(low=0.4, high=1))
    assert none.reason == "no value in the declared range 0.4..1 would do: below 0.31274"
    assert (none.direction, none.value, none.boundary) == (None, None, None)
    # What would do is said all the same.
    assert words(none.feasible) == "below 0.31274"
    assert none.current == 0.6


# 0.2 and 0.9 against 0.6: below 0.2 (0.4 away) or from 0.9 on (0.3 away); up to 0.8 the former.
def test_the_range_chooses_the_side():
    rows = [(98, 0.2, 0.6), (99, 0.9, 0.6)]
    assert ask(rows).value == 0.9
    found = ask(rows, about=declared(low=0, high=0.8))
    assert (found.value, found.direction) == (0.199, "lower")
    assert found.limited_by == "declared range 0..0.8"
    assert found.text == "lower limit from 0.6 to 0.199 (below 0.2; declared range 0..0.8)"
    assert words(found.feasible) == "below 0.2 or at least 0.9"
    # One end alone.
    assert ask(rows, about=declared(high=0.8)).limited_by == "declared range ..0.8"


# Steps of 0.25 from 0: below 0.31274 is 0.25. From 0.1: 0.1 (0.35 is too much). Steps of 0.5: 0.
# Above 0.6 by steps of 0.3 from 0 up to 1: 0.9; of 0.45: 0.9; of 0.7 from 0: 0.7, and above 0.75
# nothing but the end of the range, 1, which is allowed by itself.
def test_steps():
    below = [(99, 0.31274, 0.6)]
    found = ask(below, about=declared(low=0, high=1, step=0.25))
    assert (found.value, found.limited_by) == (0.25, "step 0.25")
    assert ask(below, about=declared(low=0.1, high=1, step=0.25)).value == 0.1
    assert ask(below, about=declared(low=0, high=1, step=0.5)).value == 0
    above = [(99, 0.75, 0.6)]
    assert ask(above, relation="<", about=declared(low=0, high=1, step=0.3)).value == 0.9
    assert ask(above, relation="<", about=declared(low=0, high=1, step=0.7)).value == 1
    # Steps of 0.1 are counted as they are written, and so never give 0.30000000000000004.
    assert ask([(99, 0.25, 0.1)], relation="<", about=declared(step=0.1)).value == 0.3
    none = ask(below, about=declared(low=0.3, high=1, step=0.5))
    assert none.value == 0.3
    gone = ask([(99, 0.31274, 0.6)], about=declared(low=-9, high=9, step=0.0))
    assert gone.value == 0.312


# A step that leads to the very boundary limits nothing.
def test_a_step_that_costs_nothing():
    found = ask([(99, 0.75, 0.6), (98, 0.75, 0.6)], "II", "<", declared(low=0, high=1, step=0.25))
    assert (found.value, found.limited_by) == (1, "step 0.25")
    first = ask([(98, 0.5, 0.6), (99, 0.75, 0.6)], "I", ">", declared(low=0, high=1, step=0.25))
    assert (first.value, first.limited_by) == (0.75, "")


def test_whole_numbers_of_declared_ints():
    # The declaration knows better than a default that JSON may have written as an int.
    assert ask([(99, 2.5, 4)], default=4, about=declared("double", 0, 10)).value == 2.49
    found = ask([(99, 2.5, 4)], default=4.0, about=declared("int", 0, 10))
    assert (found.value, type(found.value), found.limited_by) == (2, int, "whole number")
    assert found.text == "lower limit from 4 to 2 (below 2.5)"
    none = ask([(99, 0.5, 4)], about=declared("int", 1, 10))
    assert none.reason == "no value in the declared range 1..10 would do: below 0.5"
    # 5 < 4 is False, 1 < 4 True: up to 1 or above 5; of 0, 3, 6 and 9 the 6 is nearest to 4.
    odd = ask([(98, 1, 4), (99, 5, 4)], "II", "<", declared("int", 0, 10, step=3))
    assert (odd.value, odd.limited_by) == (6, "step 3")


def read_as(type_):
    read = ParameterRead("limit", "ros::param::get", type_, None, "src/node.cpp", 3, 1, "")
    return link_unit([], [read])


# -3 > limit is False with 5 and True below -3, which an unsigned number cannot be.
def test_an_unsigned_number():
    minus = ask([(99, -3, 5)], unit=read_as("int"))
    assert minus.reason == "only a value of the other sign would have prevented it: below -3"
    none = ask([(99, -3, 5)], unit=read_as("unsigned int"))
    assert none.reason == (
        "no value of its type, which holds no negative number would do: below -3"
    )


# 0.1f is 0.100000001490116: `cmp > limit` with cmp 0.1f stays False only from 0.1f on, which a
# float of 0.1 is, and a double is not.
def test_a_float():
    single = 0.10000000149011612
    rows = [(98, 0, 0.0625), (99, single, 0.0625)]
    assert ask(rows, "I", unit=read_as("float")).value == 0.1
    assert ask(rows, "I", unit=read_as("double")).value == 0.101


CHOICES = (("Drop", 0), ("Hold", 1), ("Zero", 2))


# mode == 2 was never met (modes 0 and 1 were seen): 1 is nearer. mode == 1 was met: both others do.
def test_enumerations():
    about = declared("int", 0, 2, choices=CHOICES)
    found = ask([(98, 0, 2), (99, 1, 2)], "II", "==", about, default=2)
    assert found.reason == "another choice would do: Drop (0), Hold (1)"
    found = ask([(99, 1, 2)], "II", "==", about, default=2)
    assert (found.direction, found.value) == ("switch", 1)
    assert found.text == "switch limit from Zero (2) to Hold (1)"
    met = ask([(99, 1, 1)], "II", "==", about, default=1)
    assert met.reason == "another choice would do: Drop (0), Zero (2)"
    # Of an order the nearest one does: 1.5 > mode was False with 2.
    order = ask([(99, 1.5, 2)], "II", ">", about, default=2)
    assert (order.direction, order.value, order.boundary) == ("switch", 1, 1.5)
    none = ask([(99, 7, 2)], "II", "==", about, default=2)
    assert none.reason == "none of the declared choices would do: Drop (0), Hold (1), Zero (2)"
    # A value that has no name.
    assert ask([(99, 1, 7)], "II", "==", about, default=2).text == "switch limit from 7 to Hold (1)"


def test_a_declared_truth_value():
    found = ask([(99, 1, 1)], "II", "flag", declared("bool"), default=None)
    assert (found.current, found.value) == (True, False)
    number = ask([(99, 1, 1)], "II", "flag", declared("int", 0, 5), default=None)
    assert (number.current, number.value, type(number.value)) == (1, 0, int)


# From 5, below -1 (6 away) and above 20 (15 away) would do: 20.1 keeps the sign. With a range that
# has both signs the nearer one is taken; where nothing else would do, too.
def test_the_sign():
    both = (Interval.below(-1), Interval.above(20))
    assert choose(both, 5, Possible()) == Choice(20.1, Interval.above(20), "sign")
    wide = choose(both, 5, Possible(declared=declared(low=-50, high=50)))
    assert wide == Choice(-1.01, Interval.below(-1), "")
    doubt = Doubt(NOBODY, "a value of the other sign", "sign")
    assert choose(both[:1], 5, Possible()) == Choice(-1.01, Interval.below(-1), "", doubt)
    # From 0 no sign is lost.
    assert choose((Interval.below(-1), Interval.above(20)), 0, Possible()).value == -1.01


# As far to both sides: the side that was asked for.
def test_both_sides_alike():
    both = (Interval.below(3, True), Interval.above(7, True))
    assert choose(both, 5, Possible(), up_first=True).value == 7
    assert choose(both, 5, Possible(), up_first=False).value == 3


def test_a_range_that_makes_no_sense_is_none():
    assert not Possible(declared=declared(low=3, high=1)).is_limited
    assert Possible(declared=declared(low=1, high=1)).is_limited


# Above 4 to 4.0001 there is no number of three or four digits; 4.0001 is one of five.
def test_readable_in_a_narrow_interval():
    first = math.nextafter(4, 5)
    assert readable(Interval(4, 4.0001, False, True), first, 3) == 4.0001
    assert readable(Interval(4, first, False, True), first, 3) == first
    assert readable(Interval(4, 4.02, False, True), first, 3) == 4.01
    assert readable(Interval.below(-2), math.nextafter(-2, -3), 5) == -2.01


@given(
    st.floats(-100, 100),
    st.tuples(st.floats(-100, 100), st.floats(0, 50)),
    st.one_of(st.none(), st.integers(-20, 20)),
    st.one_of(st.none(), st.sampled_from([0.1, 0.25, 1.0, 3.0])),
    st.booleans(),
)
def test_what_is_chosen_is_possible(current, span, end, step, whole):
    inside = Interval(span[0], sum(span), True, True)
    if inside.holds(current):
        return
    about = declared(low=end, high=None if end is None else end + 30, step=step)
    found = choose((inside,), current, Possible(whole, declared=about))
    if isinstance(found, str):
        assert "would do" in found
        return
    value = found.value
    assert inside.holds(value)
    assert end is None or end <= value <= end + 30
    assert not whole or value == round(value)
    if step is not None and end is not None:
        count = (value - end) / step
        assert math.isclose(count, round(count), abs_tol=1e-6) or value == end + 30


@pytest.mark.parametrize("kind", ["I", "II"])
def test_a_suggestion_without_a_declaration_has_no_limit(kind):
    found = ask([(98, 1, 5), (99, 6, 5)], kind)
    assert found.limited_by == ""
    assert found.feasible
