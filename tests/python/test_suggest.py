"""The smallest change: every suggestion is checked by evaluating the comparisons again with it."""

from __future__ import annotations

import math

import pytest
from asking import OPERATORS, ask, suggested
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mission_samples import SummaryBuilder, comparison, events, key, link_unit, ns

from pytpc.base.wording import exact, show, tidy
from pytpc.recording.summaries import Summary
from pytpc.static.link_unit import ParameterRead, Transform

NAN, INF = math.nan, math.inf


# What `edges` keeps of 0.25 at 0.5 s (the first), 0.5 and 0.375 later, all against 0.75 and False:
# one True needs a limit below 0.5. The summary lies within [1, 3]; the event does not.
def test_type2_from_summaries():
    builder = SummaryBuilder()
    builder.add(
        Summary(
            key=key(0), node="/node", begin_ns=ns(2), end_ns=ns(2.1), count=2, flops=0, far=2,
            odd=0, result=False, res=False, cmp=0.375, thresh=0.75, diff_min=-0.375,
            diff_max=-0.25, diff_mean=-0.3125, abs_mean=0.3125, low=0.375, high=0.75,
        )
    )  # fmt: skip
    kept = builder.build()
    table = events([(0.5, 0, 0, 0.25, 0.75)])
    limit = comparison(0, "limit", ">")
    found = suggested(table, limit, 3, "II", window_s=2, summaries=kept)
    assert (found.direction, found.boundary, found.inclusive) == ("lower", 0.5, False)
    # Where the mark cuts the only summary it may be that its evaluations were before.
    cut = suggested(table, limit, 2.05, "II", window_s=1, summaries=kept)
    assert cut.boundary == 0.5
    # Of the window before it nothing is known.
    none = suggested(table, limit, 9, "II", window_s=2, summaries=kept)
    assert none.reason == "it was not evaluated in the window before the mark"
    # No value between the ends is known.
    equal = suggested(table, comparison(0, "limit", "=="), 3, "II", window_s=2, summaries=kept)
    assert equal.reason == "summaries do not tell which values came near to the threshold"
    # A recorder that came late has no event of what never changes: the summary is enough.
    late = suggested(events([]), limit, 3, "II", window_s=2, summaries=kept)
    assert (late.direction, late.boundary, late.current) == ("lower", 0.5, 0.75)
    first = suggested(events([]), limit, 3, "I", summaries=kept)
    assert first.reason == "its result did not change before the mark"
    # The threshold was changed after the last event: the present one is in the summary.
    early = events([(0.5, 0, 0, 0.25, 0.9)])
    assert suggested(early, limit, 3, "II", window_s=2, summaries=kept).current == 0.75


# coverage > limit was False at 0.2 and 0.5, and flopped to True at 0.731 with limit 0.6: it stays
# False for a limit of at least 0.731. Three digits suffice and the end belongs to it.
def test_type1_greater():
    found = ask([(1, 0.2, 0.6), (2, 0.5, 0.6), (3, 0.731, 0.6)], "I")
    assert (found.direction, found.value, found.boundary, found.inclusive) == (
        "raise",
        0.731,
        0.731,
        True,
    )
    assert found.text == "raise limit from 0.6 to 0.731 (at least 0.731)"
    assert (found.current, found.reason) == (0.6, None)


# faces >= limit became True at 3 faces with limit 1 (0 faces before): a whole number above 3 is 4.
def test_type1_whole_numbers_and_strictness():
    rows = [(1, 0, 1), (2, 3, 1)]
    found = ask(rows, "I", ">=", default=1)
    assert (found.direction, found.value, found.boundary, found.inclusive) == ("raise", 4, 3, False)
    assert type(found.value) is int
    assert found.text == "raise limit from 1 to 4 (above 3)"
    # The same for a parameter that takes fractions: three digits, above 3.
    assert ask(rows, "I", ">=", default=1.0).value == 3.01
    # With > the limit 3 is enough.
    assert ask(rows, "I", ">", default=1).value == 3


# idle < limit was True and became False when idle reached 10 with limit 10: True again above 10.
def test_type1_back_to_true():
    found = ask([(1, 9.5, 10.0), (2, 10.0, 10.0)], "I", "<")
    assert (found.direction, found.value, found.inclusive) == ("raise", 10.1, False)
    assert ask([(1, 9.5, 10.0), (2, 10.5, 10.0)], "I", "<=").value == 10.5


# Two flops before the mark: 1 -> 5 at 3 s and 5 -> 2 at 4 s. The last one counts: value > limit was
# True at 5 and must stay True at 2, so the limit has to be below 2. A flop after the mark does not.
def test_type1_takes_the_last_flop_before_the_mark():
    rows = [(2, 1, 3), (3, 5, 3), (4, 2, 3), (5, 2, 3), (20, 9, 3)]
    found = ask(rows, "I", at=10)
    assert (found.direction, found.boundary, found.inclusive) == ("lower", 2, False)
    assert found.value == 1.99


# The limit rose from 1 to 6 between the evaluations: 2 > 1 and not 5 > 6. Both are True for limits
# below 2; below 5 alone would not do, for 2 > 4 is False.
def test_type1_when_the_threshold_itself_changed():
    found = ask([(1, 2, 1), (2, 5, 6)], "I", default=6)
    assert (found.direction, found.value, found.boundary) == ("lower", 1, 2)


# coverage 0.2, 0.31274, 0.3 against a limit of 0.6: one would have passed below 0.31274; the
# evaluation at 80 s (0.59) is outside the window of 12 s.
def test_type2_nearest_in_the_window():
    rows = [(80, 0.59, 0.6), (90, 0.2, 0.6), (95, 0.31274, 0.6), (99, 0.3, 0.6)]
    found = ask(rows, "II")
    assert (found.direction, found.value, found.boundary, found.inclusive) == (
        "lower",
        0.312,
        0.31274,
        False,
    )
    assert found.text == "lower limit from 0.6 to 0.312 (below 0.31274)"
    assert ask(rows, "II", window_s=20).value == 0.589


# distance < limit: 5 and 7 against 3: nearest is 5, above it the comparison is True.
def test_type2_raise():
    found = ask([(95, 7, 3), (96, 5, 3)], "II", "<", default=3)
    assert (found.direction, found.value) == ("raise", 6)


# Both outcomes in the window: 1 > 4 False, 6 > 4 True. Below 1 (3 away) or from 6 on (2 away).
def test_type2_smaller_change_of_two():
    found = ask([(95, 1, 4), (96, 6, 4)], "II", default=4)
    assert (found.direction, found.value) == ("raise", 6)
    # As far both ways (below 2: 1, three away; from 7 on: three away): as the last one went.
    assert ask([(95, 7, 4), (96, 2, 4)], "II", default=4).value == 1
    assert ask([(95, 2, 4), (96, 7, 4)], "II", default=4).value == 7


# threshold = -2 * limit + 10, now -2 * 1 + 10 = 8. value > 8 was False at 5; True for thresholds
# below 5, which are limits above 2.5: scale below 0 turns the direction.
def test_affine_with_negative_scale():
    transform = Transform("affine", -2.0, 10.0, "10 - 2 * limit")
    found = ask([(99, 5, 8)], "II", type="derived", transform=transform)
    assert (found.current, found.direction, found.boundary) == (1.0, "raise", 2.5)
    assert found.value == 2.51
    assert -2 * found.value + 10 < 5


# Degrees: threshold = pi/180 * limit. 45 degrees are 0.7853981633974483 rad; angle 0.9 rad is
# 51.566... degrees. angle > threshold flopped to True at 0.9: limit at least 51.566, whole: 52.
def test_affine_of_a_whole_parameter():
    transform = Transform("affine", math.pi / 180, 0.0, "limit * M_PI / 180")
    rows = [(1, 0.1, math.pi / 4), (2, 0.9, math.pi / 4)]
    found = ask(rows, "I", type="derived", transform=transform, default=45)
    assert (found.current, found.value) == (45, 52)
    fraction = ask(rows, "I", type="derived", transform=transform, default=45.0)
    assert fraction.value == 51.6
    assert fraction.boundary == pytest.approx(51.5662, rel=1e-6)


# A whole number reached through rounding: 1e6 + 1e-3 * limit moves only by steps of 1.2e-7 in the
# limit; the suggestion must still move the threshold past 1000000.5.
def test_affine_where_single_steps_are_swallowed():
    transform = Transform("affine", 1e-3, 1e6, "1e6 + limit / 1000")
    found = ask([(99, 1000000.5, 1000001)], "II", type="derived", transform=transform)
    assert found.direction == "lower"
    assert 1e-3 * found.value + 1e6 < 1000000.5


# value < limit^2, limit = 2 (the default): 5 and 7 are not below 4. 5 is below limit^2 for limits
# above sqrt(5) = 2.23606...; three digits above that are 2.24. For type I, the value fell from 5 to
# 3.5: False again for squares of at most 3.5, limits of at most 1.8708...: 1.87.
def test_an_expression():
    how = Transform("expression", text="x^2", tree=("pow", "x", 2.0))
    changes = {"type": "derived", "transform": how, "default": 2.0}
    found = ask([(98, 5, 4), (99, 7, 4)], "II", "<", **changes)
    assert (found.current, found.direction, found.value) == (2.0, "raise", 2.24)
    assert found.boundary == pytest.approx(math.sqrt(5))
    found = ask([(1, 5, 4), (2, 3.5, 4)], "I", "<", **changes)
    assert (found.direction, found.value) == ("lower", 1.87)
    # 100 div n <= 20 is a condition on whole numbers: 100 div 4 = 25 and 100 div 5 = 20.
    how = Transform("expression", text="100 div x", tree=("div", 100.0, "x"))
    found = ask([(99, 20, 25)], "II", ">=", type="derived", transform=how, default=4)
    assert (found.current, found.direction, found.value) == (4, "raise", 5)
    # -1 is no square, whatever the limit.
    how = Transform("expression", text="x^2", tree=("pow", "x", 2.0))
    found = ask([(99, -1, 4)], "II", ">", type="derived", transform=how, default=2.0)
    assert found.reason == "no value of the parameter gives such a threshold"
    found = ask([(99, 3, -4)], "II", "<", type="derived", transform=how, default=2.0)
    assert found.reason == "no value of the parameter gives the threshold x^2"


# A parameter that a switch chooses by: the case before it changed; which others there are is not
# known.
def test_a_switch():
    table = events([(1, 0, False, 1, 1), (2, 0, True, 3, 3)])
    found = suggested(table, comparison(0, "limit", "flag", default=3), 9, "I")
    assert (found.current, found.direction, found.value) == (3, "switch", 1)
    how = Transform("affine", 1.0, 1.0, "x + 1")
    derived = comparison(0, "limit", "flag", type="derived", transform=how, default=2)
    found = suggested(table, derived, 9, "I")
    assert (found.current, found.direction, found.value) == (2, "switch", 0)
    assert "chooses between cases" in str(suggested(table, derived, 9, "II").reason)


# is_on == wanted: the other value of a truth value is the only one.
def test_equality_of_truth_values():
    found = ask([(99, 0, 1)], "II", "==", default=True)
    assert (found.current, found.direction, found.value) == (True, "switch", False)


# Text without a default is known by the type of its read.
def test_text_by_its_type():
    read = ParameterRead("limit", "ros::param::get", "std::string", None, "src/node.cpp", 3, 1, "")
    assert ask([(99, 1, 1)], "II", "==", unit=link_unit([], [read])).reason == (
        "the parameter is text"
    )


def test_flags_are_switched():
    found = ask([(99, 1, 1)], "II", "flag", default=True)
    assert (found.current, found.direction, found.value) == (True, "switch", False)
    assert found.text == "switch limit from true to false"
    assert ask([(99, 0, 0)], "II", "flag").value is True
    # Type I: the flag was switched on during the mission; before that it was off.
    changed = ask([(1, 0, 0), (2, 1, 1), (3, 1, 1)], "I", "flag", default=False)
    assert (changed.current, changed.value) == (True, False)
    # A number used as a flag.
    number = ask([(1, 0, 0), (2, 7, 7)], "I", "flag", default=7)
    assert (number.current, number.value) == (7, 0)


# The read's C++ type decides about whole numbers, also where the default is not known; a default
# that JSON writes as 10 may be a double's.
@pytest.mark.parametrize(
    ("type_", "default", "value"),
    [("int", None, 3), ("unsigned int", None, 3), ("double", 10, 2.51), ("other", 10, 3)],
)
def test_the_type_of_the_read_decides(type_, default, value):
    read = ParameterRead(
        "limit", "ros::NodeHandle::param", type_, default, "src/node.cpp", 3, 1, ""
    )
    unit = link_unit([], [read])
    assert ask([(1, 1, 2), (2, 2.5, 2)], "I", ">=", default=default, unit=unit).value == value


# mode == limit was never met with limit 2; the nearest mode seen is 4.
def test_equality_that_was_never_met():
    found = ask([(98, 9, 2), (99, 4, 2)], "II", "==", default=2)
    assert (found.direction, found.value, found.boundary, found.inclusive) == ("raise", 4, 4, True)
    assert found.text == "raise limit from 2 to 4 (exactly 4)"
    assert ask([(98, 9, 12), (99, 4, 12)], "II", "!=", default=12).value == 9


def test_next_to_zero():
    # Not 0 > 10; True below 0, where nobody goes from 10.
    found = ask([(99, 0, 10)], "II")
    assert found.value is None
    assert found.reason == "only a value of the other sign would have prevented it: below 0"
    # Compared values of both signs make it a position: a hundredth of the way beyond 0, not 5e-324.
    assert ask([*[(t, -3, 10) for t in range(50, 60)], (99, 0, 10)], "II").value is None
    assert ask([*[(t, 12 - 15 * (t % 2), 10) for t in range(50, 60)], (99, 0, 10)], "II").value == (
        -0.1
    )
    # 1e-12 > 10 is True from 0 on; 0 is the readable number, and it is said what 0 often means.
    found = ask([(99, 1e-12, 10)], "II")
    assert found.value == 0.0
    assert "only 0, which often switches a check off, would have prevented it" in found.text
    # Nothing but zeros: some small number.
    assert ask([(99, 0, 0)], "II", ">=").value == 0.01


# Numbers near each other need more digits: 1000.4 of 1000.5, not 1000.
def test_digits_follow_the_change():
    assert ask([(99, 1000.4, 1000.5)], "II", ">=").value == 1000.4
    assert ask([(99, 0.1 + 0.2, 0.4)], "II").value == 0.3


@pytest.mark.parametrize(
    ("value", "shown", "whole"),
    [
        (0.6000000238418579, "0.6", "0.6000000238418579"),
        (3, "3", "3"),
        (True, "true", "true"),
        (None, "?", "?"),
        (1e300, "1e+300", "1e+300"),
        (10**18, "1e+18", "1e+18"),
    ],
)
def test_numbers_as_text(value, shown, whole):
    assert (show(value), exact(value)) == (shown, whole)


NUMBERS = st.one_of(
    st.floats(-1e6, 1e6), st.integers(-5, 5).map(float), st.sampled_from([1e-300, 1e300, 0.0])
)
WHOLE = st.integers(-20, 20).map(float)
UNITS = st.sampled_from([(1.0, 0.0), (-3.0, 2.0), (0.25, -8.0), (math.pi / 180, 0.0)])
RELATIONS = st.sampled_from(["<", "<=", ">", ">="])


@settings(max_examples=400, deadline=None)
@given(
    st.lists(NUMBERS, min_size=2, max_size=8),
    NUMBERS,
    RELATIONS,
    UNITS,
    st.sampled_from(["I", "II"]),
)
def test_every_suggestion_holds_and_is_the_smallest(cmps, limit, relation, unit, kind):
    scale, offset = unit
    thresh = scale * limit + offset
    # One within 1e-12 of a rounder number is shown as that, which the value to try may be, too.
    assume(tidy(limit) == limit)
    check(cmps, thresh, relation, unit, kind, default=0.5)


@settings(max_examples=300, deadline=None)
@given(
    st.lists(st.one_of(WHOLE, st.floats(-1e9, 1e9)), min_size=2, max_size=8),
    WHOLE,
    RELATIONS,
    st.sampled_from([(1.0, 0.0), (-3.0, 2.0), (0.25, -8.0)]),
    st.sampled_from(["I", "II"]),
)
def test_every_whole_suggestion_holds_and_is_the_smallest(cmps, limit, relation, unit, kind):
    scale, offset = unit
    found = check(cmps, scale * limit + offset, relation, unit, kind, default=1)
    assert type(found.value) is int
    # One whole number less of a change would not do.
    step = 1 if found.direction == "raise" else -1
    if found.value - step != found.current:
        assert not does(
            cmps, scale * limit + offset, relation, unit, kind, value=found.value - step
        )


def check(cmps, thresh, relation, unit, kind, *, default):
    transform = Transform("affine", *unit, "")
    rows = [(90 + index, cmp, thresh) for index, cmp in enumerate(cmps)]
    found = ask(rows, kind, relation, type="derived", transform=transform, default=default)
    assume(found.reason is None)
    assert does(cmps, thresh, relation, unit, kind, value=found.value)
    assert (found.value > found.current) == (found.direction == "raise")
    # Half of the way to the end would not do, except where the two are all but one.
    half = found.current + (found.boundary - found.current) / 2
    if abs(found.boundary - found.current) > 1e-6 * max(1, abs(found.boundary)):
        assert not does(cmps, thresh, relation, unit, kind, value=half)
    return found


def does(cmps, thresh, relation, unit, kind, *, value):
    """Whether a value of the parameter does what the smallest change has to."""
    compare = OPERATORS[relation]
    now = [compare(cmp, thresh) for cmp in cmps]
    then = [compare(cmp, unit[0] * value + unit[1]) for cmp in cmps]
    if kind == "II":
        return any(a != b for a, b in zip(now, then, strict=True))
    flop = max(i for i in range(1, len(now)) if now[i] != now[i - 1])
    return then[flop] == then[flop - 1] == now[flop - 1]
