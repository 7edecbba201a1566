"""What another value would have changed: the recorded comparisons evaluated again."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_samples import SummaryBuilder, comparison, events, key, link_unit, ns, static_info

from pytpc.base.errors import InputError
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.suggestion.smallest_change import At, smallest_change
from pytpc.diagnosis.suggestion.what_if import CLOSED_LOOP, what_if
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries, Summary
from pytpc.static.link_unit import ParameterRead, Transform
from pytpc.static.static_info import StaticInfo

NAN, INF = math.nan, math.inf

# value > limit with limit 5. The windows of 12 s before the marks at 3.5 and 21 s are [-8.5, 3.5]
# and [9, 21]: near are 1, 2, 3 and 20 s; away are 4, 30 and 31 s. Flops at 3, 4 and 30 s.
ROWS = [(1, 2), (2, 4), (3, 6), (4, 3), (20, 4.5), (30, 8), (31, 7)]
MARKS = (Mark(ns(3.5), "I"), Mark(ns(21), "II"))


def mission(rows, marks=MARKS, summaries=None):
    """A recording of rows (s, key, result, cmp, thresh[, node])."""
    kept = Summaries.empty() if summaries is None else summaries
    return Recording("mission", events(rows), tuple(marks), 0, ns(40), summaries=kept)


def greater(rows, limit=5, number=0):
    return [(t, number, cmp > limit, cmp, limit) for t, cmp in rows]


LIMIT = static_info(comparison(0, "~limit"))
RECORDED = mission(greater(ROWS))


def counts(found):
    return found.answered, found.flipped_near, found.flipped_away


# With 4 only 4.5 > 4 is new (20 s): the second mark is answered; at 3 s it still flops, 4 > 4 being
# False. With 7 the 6 at 3 s is False, as 4 before it: the first mark; 7 > 7 at 31 s is lost, too.
# With 1 all are True: 2, 4 and 4.5 near, 3 away; the flop at 3 s is gone, but because it was True
# before, which is no answer to "it should not have". With 5 nothing changes.
@pytest.mark.parametrize(
    ("value", "answered", "near", "away"), [(4, 1, 1, 0), (7, 1, 1, 1), (1, 1, 3, 1), (5, 0, 0, 0)]
)
def test_by_hand(value, answered, near, away):
    found = what_if(RECORDED, LIMIT, "~limit", value)
    assert (found.parameter, found.value, found.marks) == ("~limit", value, 2)
    assert found.evaluations == 7
    assert counts(found) == (answered, near, away)
    assert found.unsure == 0
    assert found.caveats == (CLOSED_LOOP,)


def test_which_marks_are_asked():
    assert what_if(RECORDED, LIMIT, "limit", 7, Question(kind="I")).answered == 1
    assert what_if(RECORDED, LIMIT, "limit", 7, Question(kind="I")).marks == 1
    assert what_if(RECORDED, LIMIT, "limit", 7, Question(kind="II")).answered == 0
    assert what_if(RECORDED, LIMIT, "limit", 4, Question(kind="II")).answered == 1
    # Which windows are near does not depend on the question.
    assert what_if(RECORDED, LIMIT, "limit", 7, Question(kind="II")).flipped_near == 1
    # Other marks than the recording's have windows, too: [18.5, 30.5].
    other = what_if(RECORDED, LIMIT, "limit", 7.5, Question(kind="II", marks=[Mark(ns(31), "I")]))
    assert (other.marks, other.answered) == (1, 1)
    # 6 at 3 s and now 7 at 31 s are near.
    assert (other.flipped_near, other.flipped_away) == (2, 0)
    # A mark without a type is answered by either, and asked about with both.
    untyped = mission(greater(ROWS), [Mark(ns(3.5), None)])
    assert what_if(untyped, LIMIT, "limit", 7).answered == 1
    assert what_if(untyped, LIMIT, "limit", 1).answered == 1
    assert what_if(untyped, LIMIT, "limit", 1, Question(kind="I")).answered == 0
    assert what_if(untyped, LIMIT, "limit", 5).answered == 0


def test_the_sentence():
    found = what_if(RECORDED, LIMIT, "limit", 7, Question(kind="I"))
    # 1 of 7 is 14.3 %.
    assert found.text == (
        "7 answers 1 of 1 mark of type I; away from marks it turns 1 of 7 decisions (14 %)"
    )
    # A mark without a type, or of the other one, is not called one of type I.
    for other in (None, "II"):
        asked = what_if(
            RECORDED,
            LIMIT,
            "limit",
            7,
            Question(kind="I", marks=[*RECORDED.marks[:1], Mark(ns(31), other)]),
        )
        assert re.match("7 answers [0-2] of 2 marks; away", asked.text)
    none = what_if(mission(greater(ROWS), []), LIMIT, "limit", 5)
    assert none.text == "5 is replayed without a mark; away from marks it turns 0 of 7 decisions"
    nothing = what_if(mission([]), LIMIT, "limit", 5)
    assert nothing.text == "it was not evaluated, so nothing is known of other values"
    assert nothing.caveats == ("none of its comparisons was evaluated",)


# With a threshold that is no number nothing is greater: the three that were True turn.
@pytest.mark.parametrize(
    ("value", "answered", "near", "away"),
    [(4, 1, 1, 0), (7, 1, 1, 1), (1, 1, 3, 1), (5, 0, 0, 0), (NAN, 1, 1, 2)],
)
def test_other_values(value, answered, near, away):
    found = what_if(RECORDED, LIMIT, "limit", value)
    assert counts(found) == (answered, near, away)
    assert (found.marks, found.evaluations) == (2, 7)


def test_a_negative_window():
    with pytest.raises(ValueError, match="window_s is negative"):
        what_if(RECORDED, LIMIT, "limit", 1, Question(window_s=-1))


# faces >= limit of 3 at 0 s (2), 5 s (4): the flop before the mark at 6 s. A second comparison,
# limit < height, of the same parameter flops at 5.5 s (limit 3, heights 5 and 2), so that is the
# last one: False from the height 2 on, True before; it stays True for limits below 2, which makes
# `faces >= limit` True at 0 s, too.
def test_the_last_flop_of_all_comparisons_counts():
    both = static_info(comparison(0, "~limit", ">="), comparison(1, "~limit"))
    rows = [(0, 0, 0, 2, 3), (5, 0, 1, 4, 3), (4, 1, 1, 5, 3), (5.5, 1, 0, 2, 3)]
    recorded = mission(rows, [Mark(ns(6), "I")])
    assert counts(what_if(recorded, both, "~limit", 5)) == (0, 2, 0)
    assert counts(what_if(recorded, both, "~limit", 1)) == (1, 2, 0)
    assert what_if(recorded, both, "~limit", 5).evaluations == 4


# In two nodes: /a goes 1, 1; /b goes 9, 9. Nobody flops, though the log alternates.
def test_nodes_are_apart():
    rows = [
        (1, 0, 0, 1, 5, "/a"),
        (2, 0, 1, 9, 5, "/b"),
        (3, 0, 0, 1, 5, "/a"),
        (4, 0, 1, 9, 5, "/b"),
    ]
    recorded = mission(rows, [Mark(ns(5), "I")])
    found = what_if(recorded, LIMIT, "limit", 10)
    assert counts(found) == (0, 2, 0)
    assert found.caveats[1] == (
        "several nodes read it, and all are replayed with the value: /a, /b"
    )
    # /b flops at 6 s; its evaluation before is the one at 4 s.
    recorded = mission([*rows, (5, 0, 0, 1, 5, "/a"), (6, 0, 0, 3, 5, "/b")], [Mark(ns(7), "I")])
    assert what_if(recorded, LIMIT, "limit", 2).answered == 1
    assert what_if(recorded, LIMIT, "limit", 4).answered == 0


# 45 degrees are 0.785 rad: 0.7 rad is 40.1 degrees.
def test_through_the_arithmetic():
    how = Transform("affine", math.pi / 180, 0.0, "x * pi / 180")
    turned = static_info(comparison(0, "~angle", type="derived", transform=how, default=45.0))
    recorded = mission(
        [(1, 0, 0, 0.7, math.pi / 4), (2, 0, 1, 0.9, math.pi / 4)], [Mark(ns(3), "II")]
    )
    assert counts(what_if(recorded, turned, "angle", 40)) == (1, 1, 0)
    assert counts(what_if(recorded, turned, "angle", 41)) == (0, 0, 0)
    # The square root of a negative number is none: no comparison holds.
    root = static_info(
        comparison(
            0,
            "~angle",
            type="derived",
            transform=Transform("expression", text="", tree=("sqrt", "x")),
        )
    )
    assert what_if(recorded, root, "angle", -1).flipped_near == 1


# A float keeps 0.6 as 0.60000002384...: 0.6 is not greater than that, and with 0.6 still is not.
def test_a_parameter_kept_in_a_float():
    read = ParameterRead("~limit", "x", "float", None, "src/node.cpp", 3, 1, "")
    static = StaticInfo.of([link_unit([comparison(0, "~limit")], [read])])
    single = 0.6000000238418579
    recorded = mission([(1, 0, 0, single, single)], [Mark(ns(2), "II")])
    assert counts(what_if(recorded, static, "limit", 0.6)) == (0, 0, 0)
    assert counts(what_if(recorded, LIMIT, "limit", 0.6)) == (1, 1, 0)


def test_flags_and_switches():
    flag = static_info(comparison(0, "~on", "flag"))
    rows = [(1, 0, 0, 0, 0), (2, 0, 1, 1, 1), (3, 0, 1, 1, 1)]
    recorded = mission(rows, [Mark(ns(4), "I")])
    # Off it would not have been switched on at 2 s; on it would have been on at 1 s.
    assert counts(what_if(recorded, flag, "on", False)) == (1, 2, 0)
    assert counts(what_if(recorded, flag, "on", True)) == (0, 1, 0)
    assert counts(what_if(recorded, flag, "on", 7)) == (0, 1, 0)
    # A switch takes a case at 2, and none at 0 and 1; of 5 the log does not tell.
    switch = [(1, 0, 0, 0, 0), (2, 0, 1, 2, 2), (3, 0, 0, 1, 1), (4, 0, 1, 2, 2)]
    recorded = mission(switch, [Mark(ns(4), "II")])
    assert counts(what_if(recorded, flag, "on", 1)) == (1, 2, 0)
    assert counts(what_if(recorded, flag, "on", 2)) == (1, 2, 0)
    found = what_if(recorded, flag, "on", 5)
    assert counts(found) == (0, 0, 0)
    assert "it selects a case of a switch" in found.caveats[-1]


# NaN is greater than nothing, infinity than all: neither turns, nor does a mark that has no other.
def test_what_is_not_finite():
    rows = [(1, 0, 0, NAN, 5), (2, 0, 1, INF, 5), (3, 0, 0, -INF, 5)]
    recorded = mission(rows, [Mark(ns(4), "II")])
    for value in (-1e308, 0, 1e308):
        assert counts(what_if(recorded, LIMIT, "limit", value)) == (0, 0, 0)
    assert what_if(recorded, LIMIT, "limit", 0).evaluations == 3


def test_marks_outside_of_the_log():
    recorded = mission(greater(ROWS), [Mark(ns(0.5), "I"), Mark(ns(900), "II"), Mark(0, "II")])
    for value in (-100, 100):
        assert what_if(recorded, LIMIT, "limit", value).answered == 0


# Equality: mode == 5 is met at 3 s (6 is not): another value turns the one that met and those that
# meet it.
def test_equality():
    static = static_info(comparison(0, "~mode", "=="))
    rows = [(1, 0, 0, 6, 5), (2, 0, 0, 7, 5), (3, 0, 1, 5, 5), (4, 0, 0, 6, 5)]
    recorded = mission(rows, [Mark(ns(3), "I")])
    # At 3 s 5 == 6 is not met, and 7 before it neither; 6 is met at 1 and 4 s.
    assert counts(what_if(recorded, static, "mode", 6)) == (1, 2, 1)
    # With 7 it is met at 2 s, so the earlier outcome is not kept.
    assert counts(what_if(recorded, static, "mode", 7)) == (0, 2, 0)


def test_names():
    two = static_info(comparison(0, "/a/limit"), comparison(1, "/b/limit"))
    with pytest.raises(InputError, match="no comparison with a parameter speed is known"):
        what_if(RECORDED, two, "speed", 1)
    with pytest.raises(InputError, match="/limit may be any of limit, ~limit"):
        what_if(RECORDED, static_info(comparison(0, "~limit"), comparison(1, "limit")), "/limit", 1)
    assert what_if(RECORDED, two, "/b/limit", 1).evaluations == 0
    assert what_if(RECORDED, two, "/a/limit", 1).evaluations == 7


def test_caveats():
    joined = static_info(comparison(0, "~limit", other_thresholds=1))
    found = what_if(RECORDED, joined, "limit", 1)
    assert found.caveats[1] == (
        "other comparisons share a condition with 1 of its comparisons and may decide the outcome"
    )
    changed = mission([*greater(ROWS), (35, 0, 0, 1, 2)])
    assert "was changed during the mission" in what_if(changed, LIMIT, "limit", 1).caveats[1]
    text = static_info(comparison(0, "~limit", default="a"), comparison(1, "~limit"))
    assert what_if(RECORDED, text, "limit", 1).caveats[-1] == "src/node.cpp:10 compares text"
    unknown = Transform("expression", text="x * y")
    dark = static_info(comparison(0, "~limit", type="derived", transform=unknown))
    assert "computed from the parameter: x * y" in what_if(RECORDED, dark, "limit", 1).caveats[-1]


def summary(begin, end, **changes):
    """0.5 and 0.375 against 0.75, both False."""
    plain = Summary(
        key=key(0), node="/node", begin_ns=ns(begin), end_ns=ns(end), count=2, flops=0, far=2,
        odd=0, result=False, res=False, cmp=0.375, thresh=0.75, diff_min=-0.375, diff_max=-0.25,
        diff_mean=-0.3125, abs_mean=0.3125, low=0.375, high=0.75,
    )  # fmt: skip
    return replace(plain, **changes)


def kept(*summaries):
    builder = SummaryBuilder()
    for one in summaries:
        builder.add(one)
    return builder.build()


# 0.25 at 0.5 s is an event (the first); 0.5 and 0.375 are summed up at [2, 2.1], three of 0.375 to
# 0.5 at [30, 31], away from the mark at 3 s. Below 0.375 all turn, which are 2 and 3; with 0.4 one
# of the two turns (one end each), and 1 or 2 of the three; with 0.5 none.
def test_summaries():
    table = kept(summary(2, 2.1), summary(30, 31, count=3))
    recorded = mission([(0.5, 0, 0, 0.25, 0.75)], [Mark(ns(3), "II")], table)
    found = what_if(recorded, LIMIT, "limit", 0.3)
    assert (found.evaluations, *counts(found), found.unsure) == (6, 1, 2, 3, 0)
    found = what_if(recorded, LIMIT, "limit", 0.4)
    assert (*counts(found), found.unsure) == (1, 1, 1, 1)
    assert found.text.endswith("1 of 6 decisions (17 %), perhaps 1 more")
    assert found.caveats[-1] == "only the extreme values of each summary are known"
    found = what_if(recorded, LIMIT, "limit", 0.5)
    assert (*counts(found), found.unsure) == (0, 0, 0, 0)
    # The summary has counted what was reported within it.
    inside = mission([(2.05, 0, 0, 0.5, 0.75)], [Mark(ns(3), "II")], kept(summary(2, 2.1)))
    assert what_if(inside, LIMIT, "limit", 0.3).evaluations == 2
    # Of equality nothing is known in between.
    equal = static_info(comparison(0, "~limit", "=="))
    assert what_if(recorded, equal, "limit", 0.4).unsure == 5
    # What was not finite counts as nothing that could turn.
    odd = mission([], [Mark(ns(3), "II")], kept(summary(2, 2.1, count=3, odd=1)))
    assert what_if(odd, LIMIT, "limit", 0.3).flipped_near == 2


def flags(begin, end, low, high, **changes):
    """Three evaluations of a flag, the last of which was ``high``."""
    same = {"far": 0, "diff_min": 0, "diff_max": 0, "diff_mean": 0, "abs_mean": 0, "count": 3}
    outcome = {"result": high != 0, "res": high != 0, "cmp": high, "thresh": high}
    return summary(begin, end, low=low, high=high, **same, **outcome, **changes)


# A flag of 1 that is summed up: with 0 all of it turn, with 2 none; near the mark at 3 s are 3, and
# 3 away. Where it went from 0 to 1 within one, at least one of its three turns and one does not.
# Between -1 and 1 there may have been a 0: with 0 two turn for certain, and perhaps the third.
@pytest.mark.parametrize(
    ("low", "value", "expected"),
    [(1, 0, (1, 3, 3, 0)), (1, 2, (0, 0, 0, 0)), (0, 0, (1, 3, 1, 1)), (0, 1, (0, 0, 1, 1)),
     (-1, 0, (1, 3, 2, 1)), (-1, 1, (0, 0, 0, 1))],
)  # fmt: skip
def test_summaries_of_a_flag(low, value, expected):
    static = static_info(comparison(0, "~use", "flag"))
    table = kept(flags(2, 2.1, 1, 1), flags(30, 31, low, 1))
    found = what_if(mission([], [Mark(ns(3), "II")], table), static, "use", value)
    assert (found.evaluations, *counts(found), found.unsure) == (6, *expected)


def test_summaries_of_a_switch():
    static = static_info(comparison(0, "~mode", "flag"))
    table = kept(flags(2, 2.1, 1, 1), replace(flags(30, 31, 2, 2), res=False, result=False))
    found = what_if(mission([], [Mark(ns(3), "II")], table), static, "mode", 0)
    assert (*counts(found), found.unsure) == (0, 0, 0, 0)
    assert found.caveats[-1].startswith("it selects a case of a switch")


# From 10 s on 7 > 5: with 7 the mark at 30 s is answered, and [10, 30] turns, of which [18, 30] is
# its window.
def test_a_change_long_before_the_mark():
    rows = greater([(t, 7 if t >= 10 else 1) for t in range(31)])
    found = what_if(mission(rows, [Mark(ns(30), "I")]), LIMIT, "limit", 7)
    assert counts(found) == (1, 13, 8)
    said = "the last change was up to 20 s before the mark; what turns more than 12 s before it"
    assert found.caveats == (CLOSED_LOOP, f"{said} counts as away from marks")
    # Type II asks about no change.
    found = what_if(mission(rows, [Mark(ns(30), "II")]), LIMIT, "limit", 7)
    assert found.caveats == (CLOSED_LOOP,)


CMPS = st.sampled_from([*map(float, range(-3, 4)), 0.5, NAN, INF, -INF])
RELATIONS = st.sampled_from(["<", "<=", ">", ">=", "==", "!="])
COMPARE = {
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
    "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b,
}


@settings(max_examples=150, deadline=None)
@given(
    st.lists(st.tuples(CMPS, st.sampled_from([0.0, 1.0])), max_size=12),
    RELATIONS,
    st.lists(st.integers(-4, 4).map(float), min_size=4, max_size=6),
    st.integers(0, 14),
)
def test_against_the_definition(pairs, relation, values, at):
    compare = COMPARE[relation]
    rows = [(t, 0, compare(cmp, thresh), cmp, thresh) for t, (cmp, thresh) in enumerate(pairs)]
    recorded = mission(rows, [Mark(ns(at), "II")])
    static = static_info(comparison(0, "~limit", relation))
    for value in values:
        turned = [t for t, _, held, cmp, _ in rows if compare(cmp, value) != held]
        near = [t for t in turned if at - 3 <= t <= at]
        expected = (int(bool(near)), len(near), len(turned) - len(near))
        assert counts(what_if(recorded, static, "limit", value, Question(window_s=3))) == expected


# What is suggested for a mark answers that mark.
@settings(max_examples=150, deadline=None)
@given(
    st.lists(st.integers(-5, 5).map(float), min_size=2, max_size=8),
    st.sampled_from(["<", "<=", ">", ">="]),
    st.sampled_from(["I", "II"]),
)
def test_a_suggestion_answers_its_mark(cmps, relation, kind):
    compare = COMPARE[relation]
    rows = [(t, 0, compare(cmp, 0.5), cmp, 0.5) for t, cmp in enumerate(cmps)]
    recorded = mission(rows, [Mark(ns(len(cmps)), kind)])
    found = comparison(0, "~limit", relation)
    said = smallest_change(recorded, static_info(found), found, At(recorded.marks[0].time_ns, kind))
    if said.value is None:
        assert kind == "I" or "the other sign" in said.reason
        return
    assert (
        what_if(recorded, static_info(found), "limit", said.value, Question(kind=kind)).answered
        == 1
    )


# `cmp < limit` was True at 10, 40 and 99.5 s, and False else. At 0.1 it is never True: 3 of 6 turn,
# two of them where nobody complained. At 0.45 the one at 99.5 s alone turns.
def test_a_value_that_stops_everything_says_so():
    cmps = [(10, 0.4), (20, 0.9), (40, 0.4), (60, 0.9), (99, 0.9), (99.5, 0.48)]
    recorded = mission([(t, 0, cmp < 0.5, cmp, 0.5) for t, cmp in cmps], [Mark(ns(100), "I")])
    static = static_info(comparison(0, "~limit", "<"))
    found = what_if(recorded, static, "limit", 0.1, Question(kind="I"))
    assert (found.stops, found.answered, found.flipped_away) == (True, 1, 2)
    assert found.text.endswith(
        "; it would stop what src/node.cpp:10 decides altogether: all 6 evaluations would go the"
        " same way"
    )
    less = what_if(recorded, static, "limit", 0.45, Question(kind="I"))
    assert (less.stops, less.answered, less.flipped_away) == (False, 1, 0)
    # A mark of type II asks for another outcome, and not for less.
    assert not what_if(recorded, static, "limit", 0.1, Question(kind="II")).stops


# The two changes near the marks are all that happened: nothing but the errors would go away.
def test_a_value_that_only_prevents_the_errors_stops_nothing():
    cmps = [(10, 0.9), (20, 0.9), (95, 0.4), (96, 0.9), (99, 0.4)]
    recorded = mission([(t, 0, cmp < 0.5, cmp, 0.5) for t, cmp in cmps], [Mark(ns(100), "I")])
    static = static_info(comparison(0, "~limit", "<"))
    found = what_if(recorded, static, "limit", 0.1, Question(kind="I"))
    assert (found.stops, found.answered, found.flipped_near) == (False, 1, 2)
