"""Values that a person would try: of the same sign and order of magnitude, and no check off.

The cases are those that were seen on robots, each with the smallest log that shows it.
"""

from __future__ import annotations

import math
import struct

import pytest
from asking import OPERATORS, ask, suggested
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_samples import comparison, events, ns, static_info

from pytpc.base.wording import exact
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.suggestion.choice import Possible
from pytpc.diagnosis.suggestion.kinds_by_name import is_check, kinds_by_name
from pytpc.diagnosis.suggestion.plausible import (
    NO_DOUBT,
    NOBODY,
    UNUSUAL,
    USUAL,
    ParameterKind,
    Shown,
    Spread,
)
from pytpc.diagnosis.suggestion.remedy import remedy
from pytpc.diagnosis.suggestion.smallest_change import At, smallest_change
from pytpc.diagnosis.thresholds.intervals import Interval, holds, words
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Transform

BEFORE = 100
"""So many evaluations long before the mark: the 5 % in the window are none of the bulk."""


def declared(low=None, high=None, default=None):
    return Declared("limit", "double", low, high, None, default, (), "", "a.cfg:1")


def rows(relation, usual, last, threshold, number=0):
    """A mission that mostly compares ``usual`` values, and ``last`` ones before a mark at 100 s."""
    holds_of = OPERATORS[relation]
    every = [(n / 2, usual[n % len(usual)]) for n in range(BEFORE)]
    every += [(95 + n, value) for n, value in enumerate(last)]
    return [(t, number, holds_of(cmp, threshold), cmp, threshold) for t, cmp in every]


def small(relation, usual, last, threshold, *, name="limit", about=None, **changes):
    """The smallest change for a mark of type II at 100 s."""
    found = comparison(0, name, relation, **changes)
    table = events(rows(relation, usual, last, threshold))
    return suggested(table, found, 100, "II", declared=about)


# `rate > 0.5` was False of 3.53e-06. Only below that it is True, and 0.5 / 3.52e-06 = 142,045.
def test_a_rate_of_a_millionth_is_no_suggestion():
    found = small(">", [10.0], [3.53e-06] * 3, 0.5, name="min_rate")
    assert (found.value, found.direction) == (None, None)
    assert found.reason == (
        "only a value 142,045 times smaller than the present one would have prevented it:"
        " below 3.53e-06"
    )
    assert words(found.feasible) == "below 3.53e-06"
    assert found.current == 0.5


# Compared all the time, such a value is of the parameter's own kind; the factor is said.
def test_an_order_of_magnitude_that_the_mission_shows():
    found = small(">", [3.53e-06], [3.53e-06] * 3, 0.5)
    assert found.value == 3.52e-06
    assert "only a value 142,045 times smaller than the present one would" in found.text


# 0.5 / 3.53e-7 is 1.4 million: so far off there is no unit in which both are meant.
def test_a_value_a_million_times_smaller_is_none_even_if_the_mission_shows_it():
    found = small(">", [3.53e-7], [3.53e-7] * 3, 0.5)
    assert found.value is None
    assert found.reason is not None
    assert "only a value over a million times smaller than the present one would" in found.reason


def remedy_for(relation, cmps, threshold, kind="I", *, step=0.05, name="limit", **changes):
    """The value to try for a mark behind the last of some values; ``usual`` come long before."""
    more = {one: changes.pop(one) for one in ("reference", "sources") if one in changes}
    usual = changes.pop("usual", [])
    about = changes.pop("about", None)
    holds_of = OPERATORS[relation]
    times = [*(n / 25 for n in range(len(usual))), *(80 + step * n for n in range(len(cmps)))]
    table = events(
        [
            (t, 0, holds_of(float(cmp), float(threshold)), cmp, threshold)
            for t, cmp in zip(times, [*usual, *cmps], strict=True)
        ]
    )
    end = 80 + step * len(cmps)
    log = Recording("m", table, (Mark(ns(end), kind),), 0, ns(end))
    static = static_info(comparison(0, name, relation, **changes))
    return remedy(log, static, name, log.marks, Question(**more).about(about))


# The count grew to 179 where 5 was asked for: three times that is 537. Ten times 5 is 50, which
# would have been enough at least once (above 5).
def test_a_count_of_a_hundred_times_the_present_one():
    found = remedy_for(">=", range(180), 5, default=5)
    assert (found.value, found.basis) == (50, "growth")
    assert "one order of magnitude; to last it would be above 537: " in found.text
    assert found.smallest is not None
    assert found.smallest.value == 6


# The speed was -0.26 m/s before the mark, and 0.3 else: `speed > 0.5` is True only below -0.26.
def test_a_velocity_limit_stays_on_its_side_of_zero():
    found = small(">", [0.3], [-0.26] * 3, 0.5, name="max_vel_x")
    assert found.value is None
    assert found.reason == "only a value of the other sign would have prevented it: below -0.26"
    # So is it with the value to try.
    tried = remedy_for(">", [-0.26] * 40, 0.5, "II", usual=[0.3] * 1500)
    assert (tried.value, tried.direction) == (None, None)
    assert tried.reason is not None
    assert tried.reason.startswith("only a value of the other sign would have prevented it: ")
    assert tried.current == 0.5


# The sensor's noise of 0.01 around 0 is a hundredth of what it measures: nothing is negative.
def test_noise_around_zero_is_not_the_other_sign():
    found = small("<", [1.0, -0.01], [-0.01] * 3, 0.6)
    assert found.value is None
    assert found.reason == "only a value of the other sign would have prevented it: at most -0.01"
    assert not Spread(-0.01, 0.84, 0.01, 0.84).is_both_sides_of_zero
    assert not Spread(-0.84, 0.01, 0.01, 0.84).is_both_sides_of_zero
    # A tenth of the other side is no noise any more.
    assert Spread(-0.1, 1.0, 0.1, 1.0).is_both_sides_of_zero
    assert not Spread(0.0, 1.0, 0.1, 1.0).is_both_sides_of_zero


# A limit of a speed is not negative, however often the robot drives backwards.
def test_a_velocity_limit_of_a_robot_that_drives_both_ways():
    found = small(">", [0.3, -0.3], [-0.26] * 3, 0.5, name="max_vel_x")
    assert found.reason == "only a negative value would have prevented it: below -0.26"


# A robot that is as often on the one side as on the other has a position, which may be negative.
def test_a_position_may_cross_zero_and_it_is_said():
    found = small(">", [3.0, -3.0], [-0.26] * 3, 0.5)
    assert found.value == -0.261
    assert "only a value of the other sign would have prevented it" in found.text
    # A range with both signs says so by itself; one that ends at 0 refuses.
    wide = small(">", [0.3], [-0.26] * 3, 0.5, about=declared(-2, 2))
    assert wide.value == -0.261
    assert "only" not in wide.text
    narrow = small(">", [0.3], [-0.26] * 3, 0.5, about=declared(0, 2))
    assert narrow.reason == "no value in the declared range 0..2 would do: below -0.26"


# An angle is never 5.35 rad off. Of a length, 5.36 / 0.2 = 26.8 times is unusual, and said.
def test_a_tolerance_beyond_half_a_turn():
    found = small("<", [0.5], [5.35] * 3, 0.2, name="~planner/yaw_goal_tolerance")
    assert found.value is None
    assert found.reason == (
        "only a value beyond 3.14159, which is unusual for a tolerance of an angle, would have"
        " prevented it: above 5.35"
    )
    length = small("<", [0.5], [5.35] * 3, 0.2, name="~planner/xy_goal_tolerance")
    assert length.value == 5.36
    assert "only a value 27 times the present one would have prevented it" in length.text


# 8 degrees, and 200 would have been needed: 200 * pi / 180 = 3.49 rad.
def test_a_tolerance_in_degrees():
    scale = math.pi / 180
    way = {"type": "derived", "transform": Transform("affine", scale, 0.0, "x * pi / 180")}
    kept = {"name": "~yaw_tolerance_deg", "default": 8.0, **way}
    found = small("<", [0.1], [200 * scale] * 3, 8 * scale, **kept)
    assert found.current == 8
    assert found.reason is not None
    assert "only a value beyond 180, which is unusual for a tolerance of an angle in degrees" in (
        found.reason
    )
    # 50 degrees, twice the size of nothing odd.
    assert small("<", [0.1], [50 * scale] * 3, 8 * scale, **kept).value == 50.1


# `count >= 5` was False of 0. Only with 0 it is True, always.
def test_a_check_is_switched_off_only_if_nothing_else_does():
    found = small(">=", [2.0], [0.0] * 3, 5, default=5)
    assert found.value == 0
    assert "only 0, which often switches a check off, would have prevented it" in found.text
    # Where a 1 was seen, too, that is enough once.
    assert small(">=", [2.0], [0.0, 1.0, 0.0], 5, default=5).value == 1
    tried = remedy_for(">=", [0] * 30 + [1], 5, "II", default=5)
    assert tried.value == 1
    assert "to last it would be at most 0" in tried.text


def test_a_flag_that_is_a_number_or_a_check():
    number = ask([(98, 1, 7), (99, 1, 7)], "II", "flag", type="flag", default=7)
    assert number.value == 0
    assert "only 0 would have prevented it, which often switches a check off" in number.text
    found = comparison(0, "~check_battery", "flag", default=True)
    check = suggested(events([(99, 0, True, 1, 1)]), found, 100, "II")
    assert check.text == (
        "switch ~check_battery from true to false (only this would have prevented it;"
        " it switches the check off)"
    )
    assert is_check("~safety_enabled")
    assert not is_check("~use_map")


# The good run's -0.6499999999999926 is -0.65 with the noise of its arithmetic.
def test_the_value_of_a_good_run_is_written_without_noise():
    static = static_info(comparison(0, "limit", "<"))

    def log(threshold, cmp=0.1):
        table = events([(90 + n, 0, cmp < threshold, cmp, threshold) for n in range(5)])
        return Recording("m", table, (Mark(ns(95), "II"),), 0, ns(95))

    found = remedy(log(-0.9), static, "limit", log(-0.9).marks,
                   Question(references=[log(-0.6499999999999926)]))  # fmt: skip
    assert found.value == -0.65
    assert found.text == "raise limit from -0.9 to -0.65 (the value of the good run)"
    # A difference that is noise alone is none.
    same = remedy(log(-0.65), static, "limit", log(-0.65).marks,
                  Question(references=[log(-0.6499999999999926)]))  # fmt: skip
    assert same.basis != "reference"


# 0.2 in a 32-bit float is 0.200000003.
def test_a_present_value_in_a_32_bit_float():
    single = struct.unpack("f", struct.pack("f", 0.2))[0]
    found = small("<", [0.3], [0.25] * 3, single)
    assert found.current == 0.2
    assert found.text == "raise limit from 0.2 to 0.251 (above 0.25)"


# 15 is 30 times 0.5. A good run that compared up to 20 shows that it is of the parameter's kind.
def test_what_a_good_run_compared_is_usual():
    found = comparison(0, "limit", "<")
    log = Recording("m", events(rows("<", [0.7], [15.0] * 3, 0.5)), (), 0, ns(200))
    good = Recording("g", events(rows("<", [5.0, 20.0], [5.0], 0.5)), (), 0, ns(200))
    static, at = static_info(found), At(ns(100), "II")
    plain = smallest_change(log, static, found, at)
    assert plain.value == 15.1
    assert "only a value 30 times the present one" in plain.text
    shown = smallest_change(log, static, found, at, Question(references=[good]))
    assert shown.text == "raise limit from 0.5 to 15.1 (above 15)"
    # A good run that may not be used shows nothing.
    unused = smallest_change(log, static, found, at, Question(references=[good], sources=()))
    assert unused.text == plain.text


# The default of 12 is near to 15.1.
def test_a_default_shows_the_order_of_magnitude():
    found = small("<", [0.7], [15.0] * 3, 0.5, default=12.0)
    assert found.text == "raise limit from 0.5 to 15.1 (above 15)"


# Without a comparison in the window nothing is suggested; 3 turns are 18.85 rad all the same.
def test_the_present_value_is_that_of_the_parameter():
    way = {"type": "derived", "transform": Transform("affine", 2 * math.pi, 0.0, "x * 2 * pi")}
    table = events([(1, 0, False, 2.0, 6 * math.pi)])
    static = static_info(comparison(0, "turns", ">", default=3.0, **way))
    log = Recording("m", table, (Mark(ns(90), "II"),), 0, ns(90))
    found = remedy(log, static, "turns", log.marks)
    assert (found.value, found.current) == (None, 3)


@pytest.mark.parametrize(
    ("value", "grade"),
    [
        (50.0, USUAL), (0.5, USUAL), (51.0, UNUSUAL), (0.049, NOBODY), (0.051, UNUSUAL),
        (501.0, NOBODY), (-5.0, NOBODY), (0.0, UNUSUAL), (5.0, USUAL),
    ],
)  # fmt: skip
def test_grades_around_a_present_value_of_5(value, grade):
    assert ParameterKind(5.0).doubt(value).grade == grade


# A range says which values there are: nothing in it is out of the question.
def test_a_declared_range_takes_the_edge_off():
    ranged = ParameterKind(5.0, Interval.closed(0, 1000))
    assert ranged.doubt(537).grade == UNUSUAL
    assert ranged.doubt(0).grade == UNUSUAL
    assert ParameterKind(5.0, Interval.closed(-10, 1000)).doubt(0) == NO_DOUBT


# Ten times 5 towards a range that only begins at 100 is not in it.
def test_no_value_outside_the_declared_range():
    assert Possible(declared=declared(100, 200)).toward(50.0, 5.0) is None
    assert Possible(declared=declared(0, 200)).toward(50.0, 5.0) == 50


def test_what_is_known_of_a_parameter_that_is_0():
    spread = Spread(1.0, 9.0, 1.0, 9.0)
    nothing = ParameterKind(0.0)
    assert nothing.doubt(1e6) == NO_DOUBT
    seen = ParameterKind(0.0, look=lambda: Shown(seen=spread))
    assert seen.doubt(50) == NO_DOUBT
    assert seen.doubt(500).words == "a value of another order of magnitude"
    good = ParameterKind(0.0, look=lambda: Shown(good=(3.0,)))
    assert good.doubt(-1).grade == NOBODY
    assert good.furthest(up=True) is None
    # A rate is not negative, even where it is 0 now.
    assert ParameterKind(0.0, named=kinds_by_name("~rate")).doubt(-1).grade == NOBODY
    # -1 is no rate: a rate is no other sign.
    assert ParameterKind(-1.0, named=kinds_by_name("~rate")).doubt(1) == NO_DOUBT


# 10 times the largest and a tenth of the smallest good value of the same sign.
def test_how_far_a_person_would_go():
    kind = ParameterKind(0.35, look=lambda: Shown(good=(0.7, -9.0)))
    assert kind.furthest(up=True) == 7
    assert kind.furthest(up=False) == 0.035
    minus = ParameterKind(-2.0)
    assert (minus.furthest(up=True), minus.furthest(up=False)) == (-0.2, -20)


@pytest.mark.parametrize(
    ("name", "value", "present", "grade"),
    [
        ("~detection_probability", 1.2, 0.6, UNUSUAL),
        ("~detection_probability", 3.0, 2.0, USUAL),
        ("~battery_percent", 130.0, 20.0, UNUSUAL),
        ("~yawTolerance", 4.0, 0.5, NOBODY),
        ("~max_yaw_rate", 4.0, 0.5, USUAL),
        ("~heading_tolerance_deg", 6.0, 1.0, USUAL),
        ("~heading_tolerance_deg", 200.0, 90.0, NOBODY),
        ("~start_angle", 7.0, 1.0, UNUSUAL),
        ("~HTTPTimeout", 3.0, 1.0, USUAL),
    ],
)
def test_what_a_name_says(name, value, present, grade):
    assert ParameterKind(present, named=kinds_by_name(name)).doubt(value).grade == grade


# A known good value beyond the kind's limit: the name says nothing.
def test_a_good_value_is_stronger_than_a_name():
    kind = ParameterKind(0.6, named=kinds_by_name("~ratio"), look=lambda: Shown(good=(1.5,)))
    assert kind.doubt(1.3) == NO_DOUBT


CMPS = st.lists(
    st.one_of(st.integers(-6, 6).map(float), st.floats(-1e3, 1e3, width=32)), min_size=2, max_size=8
)


@settings(max_examples=150, deadline=None)
@given(
    CMPS,
    st.one_of(st.integers(-5, 5).map(float), st.floats(-100, 100, width=32)),
    st.sampled_from(["<", "<=", ">", ">="]),
    st.sampled_from(["I", "II"]),
    st.one_of(st.none(), st.tuples(st.integers(-50, 50), st.integers(0, 100))),
)
def test_what_is_suggested_is_possible_and_said(cmps, threshold, relation, kind, span):
    whole = threshold == round(threshold)
    about = None if span is None else declared(span[0], sum(span))
    found = comparison(0, "limit", relation, default=round(threshold) if whole else None)
    table = events(
        [(90 + n, 0, OPERATORS[relation](cmp, threshold), cmp, threshold)
         for n, cmp in enumerate(cmps)]
    )  # fmt: skip
    end = ns(90 + len(cmps))
    log = Recording("m", table, (Mark(end, kind),), 0, end)
    asked = Question().about(about)
    least = smallest_change(log, static_info(found), found, At(end, kind), asked)
    tried = remedy(log, static_info(found), "limit", log.marks, asked)
    if least.value is not None:
        assert holds(least.feasible, float(exact(least.value)))
    for one in (least, tried):
        if one.value is None:
            assert one.reason
            continue
        value = float(exact(one.value))
        assert value == one.value
        assert f" to {exact(one.value)} " in one.text
        if about is not None:
            assert about.low <= value <= about.high
        crosses = value * threshold < 0
        ranged = about is not None and max(about.low * value, about.high * value) > 0
        assert not crosses or ranged or "other sign" in one.text
        if value == 0 != threshold and about is None:
            assert "0, which often" in one.text or min(cmps) < 0 < max(cmps)
