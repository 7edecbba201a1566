from __future__ import annotations

import math

import numpy as np
import pytest
from fleet_samples import Flight, digest, table

from pytpc.diagnosis.fleet.outliers import FAR, MOST_SCORE, fleet_outliers
from pytpc.diagnosis.fleet.rank_sum import each_against_rest
from pytpc.diagnosis.fleet.rows import Rows


def fleet(settings, missions=3, **columns):
    """``missions`` of each robot with these thresholds; a column may be a function of robot, n."""
    rows = []
    for robot, thresh in settings.items():
        for n in range(missions):
            own = {name: of(robot, n) for name, of in columns.items()}
            rows.append(digest(Flight(f"{robot}{n}", robot, 1 + n), 0, thresh, **own))
    return fleet_outliers(Rows.of(table(rows)))


def test_a_value_that_no_sister_has_stands_out():
    found = fleet({"a": 0.5, "b": 0.5, "c": 0.5, "d": 0.9})
    assert found.decisions == ()
    one = found.settings[0]
    assert len(found.settings) == 1
    assert (one.robot, one.parameter, one.value, one.usual) == ("d", "/nav/p0", "0.9", "0.5")
    assert (one.sisters, one.share, one.score) == (3, 1.0, None)
    assert found.counts == (("d", 0, 1), ("a", 0, 0), ("b", 0, 0), ("c", 0, 0))


# Sisters of e: 1, 2, 3, 4: median 2.5, deviations 1.5, 0.5, 0.5, 1.5: 1 * 1.4826. (12 - 2.5) /
# 1.4826 = 6.41. Those of a (2, 3, 4, 12): median 3.5, deviations 0.5, 0.5, 1.5, 8.5: 1: 1.69.
def test_among_different_numbers_one_that_is_far_off_stands_out():
    found = fleet({"a": 1.0, "b": 2.0, "c": 3.0, "d": 4.0, "e": 12.0})
    assert [(one.robot, one.value) for one in found.settings] == [("e", "12")]
    assert found.settings[0].score == pytest.approx(9.5 / 1.4826)
    assert FAR > 2.5 / 1.4826


# Three of the five sisters of f have one value, so that their median absolute deviation is 0. The
# mean one is (0.02 + 0 + 0 + 0 + 0.03) / 5 = 0.01. (1 - 0.1) / (1.2533 * 0.01) = 71.8.
def test_a_value_far_off_sisters_that_mostly_have_one():
    found = fleet({"a": 0.98, "b": 1.0, "c": 1.0, "d": 1.0, "e": 1.03, "f": 0.1})
    assert [(one.robot, one.usual) for one in found.settings] == [("f", "1")]
    assert found.settings[0].score == pytest.approx(0.9 / (1.2533 * 0.01))


# A robot is a little off in p0 to p11, and has a tenth of the usual value in p12.
def test_what_is_furthest_off_is_first():
    rows = [
        digest(Flight(f"{robot}{n}", robot, 1 + n), number, thresh)
        for robot in "abcd"
        for n in range(3)
        for number in range(13)
        for thresh in [(0.1 if number == 12 else 0.98) if robot == "d" else 1.0]
    ]
    found = fleet_outliers(Rows.of(table(rows)))
    assert len(found.settings) == 13
    assert found.settings[0].parameter == "/nav/p12"
    # A small difference with which the robot decides otherwise matters more.
    for row in rows:
        if row["parameter"] == "/nav/p3":
            row["turns"] = 50 if row["robot"] == "d" else 5
    more = [row | {"mission": f"{row['mission']}-{n}"} for row in rows for n in range(4)]
    found = fleet_outliers(Rows.of(table(more)))
    assert [(one.robot, one.where.parameter) for one in found.decisions] == [("d", "/nav/p3")]
    assert [one.parameter for one in found.settings[:2]] == ["/nav/p3", "/nav/p12"]


# All have a value of their own, so that none stands out; that of d may be why it decides otherwise.
def test_a_decision_says_that_the_value_is_none_of_the_sisters():
    values = {"a": 0.5, "b": 0.6, "c": 0.7, "d": 0.8}
    found = fleet(values, 10, turns=lambda robot, n: (50 if robot == "d" else 5) + n)
    assert found.settings == ()
    assert [(one.robot, one.is_set_otherwise) for one in found.decisions] == [("d", True)]


def test_an_infinite_limit_has_no_distance():
    inf = {"thresholds": lambda robot, n: 0 if robot == "d" else 1}
    found = fleet({"a": 0.5, "b": 0.5, "c": 0.5, "d": math.inf}, **inf)
    assert [(one.value, one.usual, one.score) for one in found.settings] == [("inf", "0.5", None)]


def test_flags_have_no_distance():
    flag = {"kind": lambda robot, n: "flag", "relation": lambda robot, n: "flag"}
    found = fleet({"a": 1.0, "b": 1.0, "c": 0.0}, **flag)
    assert [(one.robot, one.value, one.usual) for one in found.settings] == [("c", "false", "true")]


def test_the_value_of_most_missions_counts():
    rows = [digest(Flight(f"{robot}{n}", robot, 1 + n), 0, 0.5) for robot in "abc" for n in (0, 1)]
    rows += [digest(Flight("c9", "c", 9), 0, 0.9)]
    assert fleet_outliers(Rows.of(table(rows))).settings == ()
    rows += [digest(Flight(f"c{n}", "c", n), 0, 0.9) for n in (10, 11)]
    assert [one.value for one in fleet_outliers(Rows.of(table(rows))).settings] == ["0.9"]


def test_of_two_robots_nobody_knows_which_one_differs():
    found = fleet({"a": 0.5, "b": 0.9})
    assert (found.settings, found.decisions, found.tested) == ((), (), 0)
    assert found.notes == ("robots: a, b; it takes 3 to tell which one differs",)


# c is true for 0.2 to 0.29 of its time, the others for 0.8 to 0.89. Without ties all ten below all
# twenty: by the normal distribution as 10 * 20 <= 400 is exact: 2 / C(30, 10) = 6.7e-8. Three
# robots and four measures are twelve tests.
def test_a_decision_that_differs_stands_out():
    def share(robot, n):
        return (0.2 if robot == "c" else 0.8) + 0.01 * n + {"a": 0.0, "b": 0.005, "c": 0.0}[robot]

    found = fleet({"a": 0.5, "b": 0.5, "c": 0.5}, 10, true_share=share, median=lambda *_: math.nan)
    one = found.decisions[0]
    assert (one.robot, one.measure, one.sisters) == ("c", "true share", 2)
    assert (one.own, one.usual) == (pytest.approx(0.245), pytest.approx(0.8475))
    # The medians of the measured ones: true share, turns, least margin. The median margin is nan.
    assert found.tested == 9
    assert one.chance == pytest.approx(9 * 2 / math.comb(30, 10))
    assert not one.is_set_otherwise
    assert found.counts[0] == ("c", 1, 0)
    assert (found.counts[0].decisions, found.counts[0].settings) == (1, 0)
    # Its sisters' medians differ by 0.005, but their missions by more: 0.025 * 1.4826 / sqrt(10).
    assert one.score == pytest.approx(0.6025 / (1.4826 * 0.025 / math.sqrt(10)), rel=1e-6)


def test_the_same_with_another_setting_says_so():
    def turns(robot, n):
        return (50 if robot == "c" else 5) + n

    found = fleet({"a": 0.5, "b": 0.5, "c": 0.9}, 10, turns=turns)
    assert [one.robot for one in found.settings] == ["c"]
    assert [(one.robot, one.is_set_otherwise) for one in found.decisions] == [("c", True)]


def test_robots_that_behave_alike_do_not_stand_out():
    rng = np.random.default_rng(3)
    found = fleet(dict.fromkeys("abcde", 0.5), 20, true_share=lambda *_: float(rng.random()))
    assert found.decisions == ()
    assert found.tested == 20


def test_a_robot_with_few_missions_is_not_judged():
    rows = [
        digest(Flight(f"{robot}{n}", robot, 1 + n), true_share=0.5 + 0.01 * n)
        for robot in "ab"
        for n in range(20)
    ]
    rows += [digest(Flight(f"c{n}", "c", 1 + n), true_share=0.0) for n in range(2)]
    assert fleet_outliers(Rows.of(table(rows))).tested == 0


def test_robots_with_too_few_missions_are_named():
    found = fleet(dict.fromkeys("abcde", 0.5), 1)
    assert found.notes == (
        "fewer than 3 missions, so that no decision is judged: a, b, c and 2 more",
    )
    assert fleet(dict.fromkeys("abc", 0.5), 3).notes == ()


def test_what_differs_from_sisters_without_any_spread():
    found = fleet(dict.fromkeys("abc", 0.5), 12, true_share=lambda robot, n: float(robot == "c"))
    assert [(one.robot, one.score) for one in found.decisions] == [("c", MOST_SCORE)]


# One comparison, three members with 1, 2; 3, 4; 5, 6. The middle one has ranks 3 and 4 of 6, in
# the middle. The first has both lowest of six: 2 / 15.
def test_each_member_against_the_rest():
    which, member = np.zeros(6, np.int64), np.array([0, 0, 1, 1, 2, 2])
    found = each_against_rest(which, member, np.arange(1.0, 7.0), (2, 3))
    assert found[0].tolist() == [pytest.approx(2 / 15), 1.0, pytest.approx(2 / 15)]
    assert np.isnan(found[1]).all()


def test_an_empty_fleet_has_no_outliers():
    assert fleet_outliers(Rows.of(table([]))).notes[0].startswith("robots: none;")
