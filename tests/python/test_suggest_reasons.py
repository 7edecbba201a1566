"""Where nothing, or hardly anything, can be suggested: the reason is the answer."""

from __future__ import annotations

import math

import pytest
from asking import ask, suggested
from mission_samples import comparison, events, ns, static_info

from pytpc.diagnosis.suggestion.remedy import remedy
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Transform

NAN, INF = math.nan, math.inf


@pytest.mark.parametrize(
    ("rows", "kind", "relation", "changes", "reason"),
    [
        ([(99, 1, 2)], "II", ">", {"type": "constant"}, "a constant in the source"),
        ([(99, 1, 2)], "II", ">", {"default": "abc"}, "the parameter is text"),
        ([(99, 1, 2)], "I", ">", {}, "its result did not change before the mark"),
        ([], "I", ">", {}, "it was not evaluated before the mark"),
        ([(101, 1, 2)], "II", ">", {}, "it was not evaluated before the mark"),
        ([(50, 1, 2)], "II", ">", {}, "not evaluated in the window before the mark"),
        ([(1, 1, 2), (2, 2, 2)], "I", "==", {}, "any value but 1 and 2 would do"),
        ([(1, 1, 2), (2, 2, 2)], "I", "!=", {}, "any value but 1 and 2 would do"),
        ([(99, 2, 2)], "II", "==", {}, "any value but 2 would do"),
        ([(1, 3, 2), (2, NAN, 2)], "I", ">", {}, "the compared value was not a number"),
        ([(1, 1, 2), (2, INF, 2)], "I", ">", {}, "no finite threshold"),
        ([(99, NAN, 2)], "II", ">", {}, "the compared value was not a finite number"),
        ([(99, 1, NAN)], "II", ">", {}, "the threshold is not a finite number"),
        ([(1, 0, 0), (2, 1, 1), (3, 0, 0), (4, 0, 1)], "II", "flag", {"at": 3.5}, None),
        ([(1, 1, 2), (2, 3, 2), (3, 3, 5)], "I", ">", {"at": 2.5}, None),
        (
            [(99, 1, 2)],
            "II",
            ">",
            {"type": "derived", "transform": Transform("expression", text="limit * limit")},
            "computed from the parameter: limit \\* limit",
        ),
        (
            [(99, 1, 0)],
            "II",
            ">",
            {"type": "derived", "transform": Transform("affine", 0.0, 0.0, "0 * limit")},
            "multiplied by 0",
        ),
    ],
)
def test_where_nothing_can_be_suggested(rows, kind, relation, changes, reason):
    found = ask(rows, kind, relation, **changes)
    if reason is None:
        assert found.reason is None
        return
    assert found.direction is None
    assert found.value is None
    with pytest.raises(AssertionError, match=reason):
        raise AssertionError(found.reason)


# 1 < 2 = limit, then 3 > 2, then the limit became 5 (dynamic_reconfigure), and 3 > 5 is no more:
# the last flop before 9 s is at 3 s, where limits below 3 keep it True; 5 is not one of them. If
# the limit is 1 by then, nothing needs to be done.
def test_a_threshold_that_would_do_by_now():
    rows = [(1, 1, 2), (2, 3, 2), (3, 3, 5)]
    assert ask(rows, "I", at=9).boundary == 3
    late = ask([*rows, (4, 3, 5), (5, 0.5, 1)], "I", at=9)
    assert late.reason == "the threshold has changed since; its present value would do"


# Both parts of "a > A && b > B" report when the condition flops; only the second one changed.
def test_a_flop_of_another_comparison_in_the_condition():
    found = comparison(0, "limit", other_thresholds=1)
    table = events([(1, 0, 0, 5, 3), (2, 0, 1, 5, 3)])
    answer = suggested(table, found, 9, "I")
    assert answer.reason == "another comparison of the same condition changed, not this one"


# mode == 5 was True of 5, and is False of 7: no mode is both. floor(x) is never 2.5.
def test_equality_that_nothing_meets():
    found = ask([(1, 5, 5), (2, 7, 5)], "I", "==", default=5)
    assert found.reason == "no value is equal to both compared values of the last change"
    how = Transform("expression", text="floor(x)", tree=("floor", "x"))
    found = ask([(99, 2.5, 3)], "II", "==", type="derived", transform=how)
    assert found.reason == "no value of the parameter gives the compared value exactly"


# 3 > 2 was True; with the limit of 5 by now it is False, and what came since was no number.
def test_a_window_that_would_do_by_now():
    found = ask([(95, 3, 2), (99, NAN, 5)], "II")
    assert found.reason == "the threshold has changed since; its present value would do"


# 1e-300 * limit is at most 1.8e8 of doubles: never 1e10.
def test_a_threshold_out_of_reach():
    how = Transform("affine", 1e-300, 0.0, "1e-300 * x")
    found = ask([(1, 0, 1), (2, 1e10, 1)], "I", type="derived", transform=how)
    assert found.reason == "no finite threshold would change the outcome"


# a || flag: a alone changed at 2 s; the flag was switched on at 2 s and off again at 3 s.
def test_flags_that_are_not_to_blame():
    flag = comparison(0, "limit", "flag")
    alone = events([(1, 0, False, 1, 1), (2, 0, True, 1, 1)])
    found = suggested(alone, flag, 9, "I")
    assert found.reason == "another comparison of the same condition changed, not the flag"
    back = events([(1, 0, False, 0, 0), (2, 0, True, 1, 1), (3, 0, True, 0, 0)])
    assert suggested(back, flag, 9, "I").reason == "the flag has changed back since"
    how = Transform("expression", text="floor(x)", tree=("floor", "x"))
    odd = comparison(0, "limit", "flag", type="derived", transform=how, default=3)
    table = events([(1, 0, False, 2.5, 2.5), (2, 0, True, 3, 3)])
    found = suggested(table, odd, 9, "I")
    assert found.reason == "no value of the parameter gives the threshold before the change"


# The default 5 is taken for the parameter, though 5 * 0.2 is not just the threshold that was logged
# (another compiler's rounding); 1 > 1.0000000000000002 is False, and True with 1. "Leave it at 5"
# is no suggestion: a little less is.
def test_rounding_leaves_something_to_do():
    how = Transform("affine", 0.2, 0.0, "0.2 * x")
    logged = math.nextafter(1, 2)
    found = ask([(1, 1, logged)], "II", ">=", at=2, type="derived", transform=how, default=5.0)
    assert found.current == 5
    assert found.direction == "lower"
    assert 4.99 <= found.value < 5


# Five comparisons compute what they compare; the two first ones are named.
def test_many_comparisons_without_an_answer_are_told_in_short():
    own = Transform("expression", text="limit * limit")
    found = [comparison(n, "limit", type="derived", transform=own) for n in range(5)]
    log = Recording("m", events([(n, n, 0, 1, 2) for n in range(5)]), (), 0, ns(9))
    answer = remedy(log, static_info(*found), "limit", [Mark(ns(8), "I")])
    why = "the threshold is computed from the parameter: limit * limit"
    assert answer.reason == f"src/node.cpp:10: {why}; src/node.cpp:11: {why}; and 3 more"
