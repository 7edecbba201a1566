"""The value to try, on logs written out by hand; what is expected is worked out above each."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.suggestion.remedy import remedy
from pytpc.recording.declaration import Declared
from pytpc.recording.events import Events
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries, Summary
from pytpc.static.link_unit import Transform

HOLDS = {"<": float.__lt__, ">": float.__gt__, ">=": float.__ge__, "flag": lambda _, t: bool(t)}


def recording(rows=(), summaries=None) -> Recording:
    table = events(rows) if rows else Events.empty()
    return Recording("m", table, (), 0, ns(200), summaries=summaries or Summaries.empty())


def rows(relation, cmps, threshold, *, number=0, begin=90.0, step=1.0):
    """Evaluations every ``step`` seconds."""
    holds = HOLDS[relation]
    return [
        (begin + step * n, number, holds(float(cmp), float(threshold)), cmp, threshold)
        for n, cmp in enumerate(cmps)
    ]


def marks(*times, kind="I"):
    return [Mark(ns(time), kind) for time in times]


def ask(relation, cmps, threshold, marked, *, default=None, step=1.0, begin=90.0, **more):
    found = comparison(0, "limit", relation, default=default, **more.pop("kept", {}))
    log = recording(rows(relation, cmps, threshold, step=step, begin=begin))
    return remedy(log, static_info(found), "limit", marked, Question(**more))


# The program acts at 3, so the log ends there: 3 is the only peak, three times the way from 0 is
# 9. `9 >= T` is False for T > 9: the next whole number is 10. The smallest change is to 4.
def test_a_counter_is_stepped_beyond_where_the_program_acted():
    found = ask(">=", [0, 1, 2, 3], 3, marks(95), default=3)
    assert (found.value, found.basis, found.direction) == (10, "growth", "raise")
    assert type(found.value) is int
    assert found.smallest is not None
    assert found.smallest.value == 4
    assert "a first step" in found.text


# Flown with 7 and still wrong: 0 + 7 * 5 = 35, so 36. With 22: 0 + 22 * 7 = 154, so 155, although
# the lowest 5 % of the 22 values 0 to 21 end at 1.
def test_each_try_in_vain_steps_further():
    assert ask(">=", range(8), 7, marks(99), default=3, flown=[3]).value == 36
    assert ask(">=", range(23), 22, marks(99), default=3, flown=[3, 7], step=0.3).value == 155


# The way begins where the ramp did, before the window: of 0, 1, ... 20 from 80 s on the window
# before the mark at 101 s has those from 9 on. 0 + 20 * 3 = 60, so 61.
def test_a_ramp_that_is_longer_than_the_window():
    assert ask(">=", range(21), 20, marks(101), begin=80.0, default=3).value == 61


# Peaks 3, 5 and 4 that went back by themselves. The threshold is 2 and the step 1, so 3 may be the
# program's doing (3 - 2 is less than 1.5 steps beyond), 5 and 4 are not: n = 2, and the end is
# 0 + 5 * sqrt(3) = 8.66. The next whole number above is 9.
def test_a_counter_that_falls_back_by_itself_tells_how_far_it_gets():
    found = ask(">=", [0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 0], 2, marks(99), default=2,
                step=0.5)  # fmt: skip
    assert (found.value, found.basis) == (9, "lasting")


# 15.3 is the peak at which the program acted: 0 + 15.3 * 3 = 45.9; `45.9 >= T` is False above it,
# and the next of three digits is 46. The author's default lies beyond the smallest change.
def test_a_volume_that_grows_goes_to_the_default_where_it_may():
    asked = {"relation": ">=", "cmps": [0, 5, 10, 15.3], "threshold": 15, "marked": marks(95)}
    assert ask(**asked, default=41.0, sources=()).value == 46
    found = ask(**asked, default=41.0)
    assert (found.value, found.basis) == (41, "default")
    assert "the default in the source" in found.text
    # A default that lies the other way, or is the present value, is none.
    assert ask(**asked, default=10.0).value == 46
    assert ask(**asked, default=15.0).value == 46


# Noise about 5 crosses 10 three times, in one jump each, and goes back: peaks 11, 12, 11.5.
# The cube root of 3 is 1.44225, and 5 + (12 - 5) * 1.44225 = 15.096; the value itself times that
# would be 17.3, and the less counts. `15.096 > T` is False from 15.096 on: 15.1.
def test_noise_below_a_threshold():
    found = ask(">", [5, 5, 11, 5, 5, 12, 5, 11.5, 5], 10, marks(99))
    assert (found.value, found.basis, found.direction) == (15.1, "lasting", "raise")


# A distance that shrinks from 8 to the 2.8 at which the robot says that it is there (below 3). The
# way from 8 three times is 8 - 5.2 * 3 < 0, a third of the value 0.9333: the less of the two.
# `0.9333 < T` is False up to 0.9333: 0.933.
def test_a_distance_is_divided():
    found = ask("<", [8, 6, 4, 2.8], 3, marks(95))
    assert (found.value, found.direction) == (0.933, "lower")


# Within reach once (0.03 < 0.04), and else not: the robot stood because it was False. The median
# is (0.09 + 0.10) / 2 = 0.095, the deviations are 0.005 twice, 0.015 twice, 0.025, 0.065, their
# median 0.015, and 1.4826 * 0.015 = 0.02224 the standard deviation: none is an outlier. Beyond the
# largest by that: 0.14224, and 0.143 is the next of three digits. The smallest change is to turn
# the 0.03, downwards.
def test_both_outcomes_in_the_window():
    cmps = [0.08, 0.09, 0.10, 0.03, 0.11, 0.12]
    found = ask("<", cmps, 0.04, marks(96, kind="II"))
    assert (found.value, found.direction, found.basis) == (0.143, "raise", "lasting")
    assert found.smallest is not None
    assert found.smallest.direction == "lower"
    # Where that was in vain it is one standard deviation more: 0.16448.
    again = ask("<", cmps, 0.04, marks(96, kind="II"), flown=[0.02])
    assert again.value == 0.165


# The way there does not count: 5 and 3 are far from the others. The median of the nine is 0.11, the
# median deviation 0.01, so that 0.11 + 4 * 0.0148 holds the rest; 0.13 + 0.0148 = 0.1448.
def test_the_way_to_where_it_stood_does_not_count():
    cmps = [5, 3, 0.10, 0.11, 0.12, 0.09, 0.13, 0.10, 0.11]
    assert ask("<", cmps, 0.04, marks(99, kind="II")).value == 0.145


# True of 5 and 4, then False of 0, where it stays: three times the way from 5 would be -10, but a
# counter has no such values. `0 >= T` is True from 0 down.
def test_a_counter_does_not_get_below_0():
    found = ask(">=", [5, 5, 4, 0, 0], 2, marks(95), default=2)
    assert (found.direction, found.value) == ("lower", 0)
    assert "(at most 0: " in found.text


# A height that sinks from 2.4 to the 1.7 at which the program goes on to wait (below 1.75), and is
# not asked for again until the mark 9 s later. Waiting is by that decision: it comes too early, and
# of three times the way (2.4 - 0.7 * 3 = 0.3) and a third of the value (0.5667) that is less.
def test_a_decision_that_was_not_asked_for_again():
    cmps = [2.4, 2.2, 2.0, 1.8, 1.7]
    found = ask("<", cmps, 1.75, marks(103, 105, kind="II"))
    assert (found.direction, found.value, found.kind) == ("lower", 0.566, "II")
    # Asked for until the mark, most of the window's evaluations decide: above 1.8 they are no more.
    assert ask("<", cmps, 1.75, marks(95, kind="II")).direction == "raise"


# Ramps up to 4, 6 and 5 below a threshold of 30: half of them get to 5. In vain: three of four, of
# these three all: 4.
def test_ramps_that_do_not_get_there():
    cmps = [*range(5), *range(7), *range(6)]
    asked = {"relation": ">=", "cmps": cmps, "threshold": 30, "step": 0.5, "default": 30}
    found = ask(marked=marks(99, kind="II"), **asked)
    assert (found.value, found.direction) == (5, "lower")
    assert "3 ramps" in found.text
    assert ask(marked=marks(99, kind="II"), **asked, flown=[40]).value == 4


# 0.2 rad all the time where less than 5 degrees (0.0873 rad) is asked for: above 0.2 rad, which is
# 11.459 degrees.
def test_degrees():
    scale = math.pi / 180
    kept = {"type": "derived", "transform": Transform("affine", scale, 0.0, "x * pi / 180")}
    found = ask("<", [0.2] * 5, 5 * scale, marks(99, kind="II"), default=5.0, kept=kept)
    assert found.current == 5
    assert found.value == 11.5


def test_a_flag_is_switched():
    found = ask("flag", [0, 0, 0], 0, marks(95, kind="II"), default=False)
    assert (found.value, found.basis, found.direction) == (True, "smallest", "switch")


# One wants less than 0.5, the other more than 5 (median and all). The first has been at 1.6: it is
# 0.1 of 1.1 away; the other has always been 4.4 of 4.4 away.
def test_of_two_directions_the_nearer_comparison_decides():
    first, second = comparison(0, "limit", ">"), comparison(1, "limit", "<")
    log = recording(
        [
            *rows(">", [1.6], 0.6, begin=10),
            *rows(">", [0.5] * 5, 0.6),
            *rows("<", [5.0] * 5, 0.6, number=1),
        ]
    )
    found = remedy(log, static_info(first, second), "limit", marks(95, kind="II"))
    assert (found.direction, found.key) == ("lower", key(0))
    assert found.value == 0.499
    assert "other direction" in found.text


# One stands above 5 and the other above 7 with the same threshold of 9: below both. Without a
# deviation nothing is added: below 5 is 4.99.
def test_two_comparisons_of_one_mind_are_both_answered():
    log = recording([*rows(">", [7.0] * 5, 9), *rows(">", [5.0] * 5, 9, number=1)])
    static = static_info(comparison(0, "limit", ">"), comparison(1, "limit", ">"))
    assert remedy(log, static, "limit", marks(95, kind="II")).value == 4.99


# Five periods with ends 8 and 9: median 8.5, deviations all 0.5, 1.4826 * 0.5 = 0.7413. Below
# 8 - 0.7413 = 7.2587: 7.25.
def test_summaries():
    builder = SummaryBuilder()
    for second in range(90, 95):
        builder.add(
            Summary(
                key(0), "/node", ns(second), ns(second + 0.9), 10, 0, 10, 0, False, False,
                8.5, 10.0, -2.0, -1.0, -1.5, 1.5, 8.0, 10.0,
            )
        )  # fmt: skip
    log = recording(summaries=builder.build())
    found = remedy(log, static_info(comparison(0, "limit", ">")), "limit", marks(96, kind="II"))
    assert (found.value, found.direction) == (7.25, "lower")


# What lasts is above 0.1. The good run's 0.35 lies there; 0.02 would make stronger what the robot
# stood by, if the marks are of the type that was said. It went right with it all the same.
@pytest.mark.parametrize(
    ("flown", "direction", "words"),
    [
        (0.35, "raise", "(the value of the good run)"),
        (0.02, "lower", "(the value of the good run; the log alone points the other way)"),
    ],
)
def test_the_value_of_a_good_run_is_taken_whatever_the_log_says(flown, direction, words):
    static = static_info(comparison(0, "limit", "<"))
    log = recording(rows("<", [0.1] * 5, 0.04))
    typed = marks(95, kind="II")
    clean = recording(rows("<", [0.1] * 5, flown))
    found = remedy(log, static, "limit", typed, Question(references=[clean]))
    assert (found.value, found.basis, found.direction) == (flown, "reference", direction)
    assert found.text == f"{direction} limit from 0.04 to {flown} {words}"
    assert [(one.source, one.value) for one in found.known] == [("reference", flown)]
    # Where it may not be taken, or was tried in vain, the log has the word.
    assert (
        remedy(log, static, "limit", typed, Question(references=[clean], sources=())).value == 0.101
    )
    again = remedy(log, static, "limit", typed, Question(references=[clean], flown=[flown]))
    assert (again.direction, again.basis) == ("raise", "lasting")


def test_a_good_run_with_the_same_value_says_nothing():
    log = recording(rows("<", [0.1] * 5, 0.04))
    static = static_info(comparison(0, "limit", "<"))
    found = remedy(log, static, "limit", marks(95, kind="II"), Question(references=[log]))
    assert (found.value, found.basis) == (0.101, "lasting")


# A flag that never changed: to a mark of type I the log has no answer, but the good run has. The
# count of 3 is a whole number, and so is what is tried.
def test_a_good_run_answers_where_the_log_does_not():
    flag = static_info(comparison(0, "on", "flag", default=True))
    clean = recording(rows("flag", [1] * 5, 1))
    log = recording(rows("flag", [0] * 5, 0))
    found = remedy(log, flag, "on", marks(95), Question(references=[clean]))
    assert (found.value, found.direction, found.basis) == (True, "switch", "reference")
    assert found.text == "switch on from false to true (the value of the good run)"
    whole = static_info(comparison(0, "limit", ">=", default=3))
    clean = recording(rows(">=", [0] * 5, 8))
    log = recording(rows(">=", [0] * 5, 3))
    found = remedy(log, whole, "limit", marks(95), Question(references=[clean]))
    assert (found.value, type(found.value)) == (8, int)


# A default of 0.05 turns the 0.045 alone, so it does not last.
def test_a_default_that_does_not_last_is_not_taken():
    found = ask("<", [0.1] * 9 + [0.045], 0.04, marks(99, kind="II"), default=0.05)
    assert (found.value, found.basis) == (0.101, "lasting")


# The program acted at 61 of 60, and 15 and 92 were flown: 92 was too much, or nobody would have
# gone back. 0 + 61 * 7 is beyond it: the geometric mean of 60 and 92 is 74.297.
def test_between_values_that_were_flown():
    found = ask(">=", [0, 20, 40, 61], 60, marks(95), flown=[15, 92])
    assert (found.value, found.basis) == (74.3, "between")
    assert ask(">=", [0, 20, 40, 61], 60, marks(95), default=80.0, flown=[15, 92]).value == 80


# Declared up to 0.12: all that lasts is above 0.143, but the end of the range turns some.
def test_the_end_of_a_declared_range():
    declared = Declared("limit", "double", 0.0, 0.12, None, None, (), "", "x.cfg:1")
    found = ask(
        "<", [0.08, 0.09, 0.10, 0.03, 0.11, 0.12], 0.04, marks(96, kind="II"), declared=[declared]
    )
    assert found.value == 0.12


# What came first is the cause: the marks of the first 12 s decide.
def test_marks_of_both_types():
    cmps = [0, 1, 2, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
    both = [*marks(95), *marks(110, 112, 114, kind="II")]
    found = ask(">=", cmps, 3, both, default=3)
    assert (found.kind, found.direction) == ("I", "raise")


# Of marks without a type most tell: a change in the window before it.
@pytest.mark.parametrize(("times", "kind"), [((95, 96), "I"), ((94, 120, 125), "II")])
def test_marks_of_no_type(times, kind):
    cmps = [0, 1, 2, 3, *[0] * 36]
    assert ask(">=", cmps, 3, marks(*times, kind=None), default=3).kind == kind


# `0 >= 0` at once: nothing changed, but it was first evaluated within the window. What is above 0
# does: 1. Of one that was so long before nothing is known.
def test_a_first_evaluation_is_a_change():
    found = ask(">=", [0] * 4, 0, marks(95), default=3, sources=())
    assert (found.value, found.direction) == (1, "raise")
    assert ask(">=", [0] * 40, 0, marks(125), default=3).value is None


def test_nothing_is_said_where_nothing_was_evaluated():
    found = remedy(recording(), static_info(comparison(0, "limit")), "limit", marks(95))
    assert (found.value, found.basis) == (None, None)
    assert found.reason == "none of its comparisons was evaluated"


VALUES = st.lists(
    st.one_of(st.floats(-20, 20), st.integers(-5, 5).map(float)), min_size=1, max_size=30
)


# Whatever the log: what is wanted of type II is never what the robot stood by, so that no more
# evaluations have the outcome that most had; and of both types the value is another one, on the
# side that is said.
@settings(max_examples=300, deadline=None)
@given(
    VALUES, st.sampled_from(["<", ">", ">="]), st.floats(-20, 20), st.sampled_from(["I", "II"]),
    st.lists(st.floats(-30, 30), max_size=3),
)  # fmt: skip
def test_whatever_the_log(cmps, relation, threshold, kind, flown):
    found = ask(relation, cmps, threshold, marks(102, kind=kind), step=0.4, flown=flown)
    if found.value is None:
        assert found.reason
        return
    assert (found.value > threshold) == (found.direction == "raise")
    assert found.value != threshold
    assert not any(
        min(threshold, found.value) < value < max(threshold, found.value) for value in flown
    )
    if kind == "II" and found.basis == "lasting":
        holds = HOLDS[relation]
        before = [holds(cmp, threshold) for cmp in cmps]
        most = 2 * sum(before) >= len(before)
        after = [holds(cmp, float(found.value)) for cmp in cmps]
        assert after.count(most) < before.count(most)


# Type I at 100 s: `cmp < 0.5` became True at 99.5 s, and was at 10 s, where nobody complained. The
# default of 0.1 would stop both, so it comes after what lasts. The stay at 99.5 s was at 0.45 and
# went back to 0.9 by itself: three times the way from 0.9 is below 0, a third of the value is 0.15.
def test_a_default_that_stops_everything_comes_after_what_lasts():
    cmps = [(10, 0.12), (20, 0.9), (98, 0.9), (99.5, 0.45), (99.8, 0.9)]
    log = recording([(t, 0, cmp < 0.5, cmp, 0.5) for t, cmp in cmps])
    static = static_info(comparison(0, "limit", "<", default=0.1))
    found = remedy(log, static, "limit", marks(100))
    assert (found.value, found.basis) == (0.15, "lasting")
    # Without the one at 10 s it stops nothing but the error.
    log = recording([(t, 0, cmp < 0.5, cmp, 0.5) for t, cmp in cmps[1:]])
    found = remedy(log, static, "limit", marks(100))
    assert (found.value, found.basis) == (0.1, "default")
