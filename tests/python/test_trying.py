"""What tries say about suspects, and where the next value is, worked out by hand."""

from __future__ import annotations

import pytest

from pytpc.diagnosis.trying import (
    Odds,
    Try,
    after_tries,
    beyond,
    judged,
    mean_of,
    next_proposals,
    search_of,
    why_over,
)
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark

HALF = Odds({"~a": 0.5, "~b": 0.3}, 0.2)


def tried(verdict, new=2.0, basis="lasting", old=1.0, parameter="~a"):
    return Try(parameter, old, new, basis, verdict)


def rounded(odds):
    return {name: round(part, 4) for name, part in odds.suspects.items()}, round(odds.none, 4)


# 0.5 * 0.25 = 0.125 of 0.625; with a good value 0.5 * 0.02 = 0.01 of 0.51; better 1.5 of 2;
# another error 2 of 2.5; worse 0.25 of 0.75.
@pytest.mark.parametrize(
    ("one", "parts"),
    [
        (tried("same"), ({"~a": 0.2, "~b": 0.48}, 0.32)),
        (tried("same", basis="reference"), ({"~a": 0.0196, "~b": 0.5882}, 0.3922)),
        (tried("same", basis="default"), ({"~a": 0.0196, "~b": 0.5882}, 0.3922)),
        (tried("better"), ({"~a": 0.75, "~b": 0.15}, 0.1)),
        (tried("other"), ({"~a": 0.8, "~b": 0.12}, 0.08)),
        (tried("worse"), ({"~a": 0.3333, "~b": 0.4}, 0.2667)),
        (tried(None), ({"~a": 0.5, "~b": 0.3}, 0.2)),
        (tried("same", parameter="~unknown"), ({"~a": 0.5, "~b": 0.3}, 0.2)),
    ],
)
def test_a_verdict_changes_the_probabilities(one, parts):
    assert rounded(after_tries(HALF, [one])) == parts


def test_they_sum_to_1_after_several_tries():
    odds = after_tries(HALF, [tried("better"), tried("same"), tried("same", parameter="~b")])
    assert sum(odds.suspects.values()) + odds.none == pytest.approx(1)


# ~a: sqrt(0.5 * 0.02) = 0.1; ~b: sqrt(0.3 * 0.3) = 0.3; none: sqrt(0.2 * 0.8) = 0.4; of 0.8.
def test_two_missions_count_by_the_mean_of_their_logarithms():
    both = mean_of([HALF, Odds({"~a": 0.02, "~b": 0.3}, 0.8)])
    assert rounded(both) == ({"~a": 0.125, "~b": 0.375}, 0.5)


# ~a is not in the second: 0.001 for it, sqrt(0.5 * 0.001) = 0.02236; ~new is not of the question.
def test_a_parameter_that_a_mission_did_not_compare_is_not_ruled_out():
    both = mean_of([Odds({"~a": 0.5}, 0.5), Odds({"~new": 0.5}, 0.5)])
    assert rounded(both) == ({"~a": 0.0428}, 0.9572)


# As sure as an accusation has to be. Who wants to, goes on.
def test_it_is_over_when_it_is_likely_none_of_them():
    odds = Odds({"~a": 0.08, "~b": 0.12}, 0.8)
    assert "likely that it is none of the parameters (80 %)" in why_over(odds, [tried("same")], 3)
    assert why_over(odds, [tried("same")], 3, go_on=True) == ""
    assert why_over(odds, [], 3) == ""
    assert why_over(odds, [tried("better")], 3) == ""
    assert why_over(Odds({"~a": 0.21}, 0.79), [tried("same")], 3) == ""


def test_it_is_over_when_the_tries_are_used_up():
    assert why_over(HALF, [tried("same")] * 3, 3) == "3 tries are used up"
    assert why_over(HALF, [tried("same")] * 2, 3) == ""


def test_suspects_are_asked_in_their_order_and_the_unlikely_ones_not_at_all():
    asked = []

    def value_of(name):
        asked.append(name)
        return None if name == "~a" else name

    odds = Odds({"~c": 0.009, "~b": 0.3, "~a": 0.5}, 0.191)
    assert list(next_proposals(odds, value_of)) == ["~b"]
    assert asked == ["~a", "~b"]


@pytest.mark.parametrize("verdict", ["same", "better"])
def test_the_next_value_is_further(verdict):
    search = search_of([tried(verdict)])
    assert search.goes_further
    assert (search.near, search.far) == (2.0, None)
    assert search.allows(3.0)
    assert not search.allows(1.5)
    assert not search.allows(0.5)


def test_after_another_error_the_next_value_is_between():
    search = search_of([tried("other", new=4.0)])
    assert not search.goes_further
    # The geometric mean of 1 and 4.
    assert search.between(whole=False) == 2.0


def test_between_the_last_that_helped_not_and_the_first_that_was_too_much():
    search = search_of([tried("same", new=4.0), tried("other", new=16.0)])
    assert search.between(whole=False) == 8.0


# By the factor of the step that helped: 2 / 1, 3 / 4; from 0 by its distance.
@pytest.mark.parametrize(("old", "new", "next_one"), [(1.0, 2.0, 4.0), (4.0, 3.0, 2.25), (0, 2, 4)])
def test_after_a_step_that_helped_it_may_go_as_far_again(old, new, next_one):
    assert search_of([tried("better", old=old, new=new)]).onward(whole=False) == next_one


def test_after_a_step_that_did_not_help_only_the_log_leads_further():
    assert search_of([tried("same")]).onward(whole=False) is None


def test_no_whole_number_is_between_neighbours():
    assert search_of([tried("other", old=3, new=4)]).between(whole=True) is None
    assert search_of([tried("other", old=3, new=5)]).between(whole=True) == 4


def test_what_made_it_worse_closes_its_direction():
    search = search_of([tried("worse")])
    assert not search.goes_further
    assert not search.allows(3.0)
    assert search.allows(0.5)


def test_a_switch_has_no_further_value():
    assert search_of([tried("same", old=True, new=False)]) is None


RANGE = Declared("a", "double", 0.0, 5.0, None, None, (), "", "robot.cfg:1")


@pytest.mark.parametrize(
    ("value", "known", "declared", "doubt", "why"),
    [
        (9.0, [1.0], None, "", ""),
        (10.0, [1.0], None, "", ""),
        (11.0, [1.0], None, "", "a factor of 11 from what is known"),
        (11.0, [1.0, 4.0], None, "", ""),
        (11.0, [1.0, 11.0], None, "", ""),
        (6.0, [1.0, 6.0], RANGE, "", "outside of the declared range 0..5"),
        (-1.0, [1.0], None, "", "a value of another sign than all that are known"),
        (0.0, [1.0], None, "0, which often switches a check off", "0, which often switches a"),
        (True, [0.0], None, "", ""),
    ],
)
def test_beyond_the_known_range(value, known, declared, doubt, why):
    found = beyond(value, known, declared, doubt)
    assert found.startswith(why)
    assert bool(found) == bool(why)


def marks(*kinds, note=""):
    return [Mark(at, kind, "", note) for at, kind in enumerate(kinds)]


@pytest.mark.parametrize(
    ("after", "verdict"),
    [
        (marks(), "fixed"),
        (marks("I", "I"), "same"),
        (marks("I"), "better"),
        (marks("II", "II", "I"), "same"),
        (marks("I", "I", note="@/arm stuck"), "other"),
    ],
)
def test_the_marks_of_a_mission_say_what_came_of_it(after, verdict):
    assert judged(marks("I", "I", "II"), after) == verdict


# A coin has four and two marks as they are in one of 32 cases, three and two in one of 16.
@pytest.mark.parametrize(("before", "verdict"), [("IIII", "other"), ("III", "same")])
def test_a_type_is_believed_where_all_marks_say_it(before, verdict):
    assert judged(marks(*before), marks("II", "II")) == verdict
    assert judged(marks(*before), marks("II", "I")) == "same"
    assert judged(marks(*before), marks(None, None)) == "same"
