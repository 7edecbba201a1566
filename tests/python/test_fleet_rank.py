from __future__ import annotations

import math

import numpy as np
import pyarrow as pa
import pytest
from fleet_samples import Flight, digest, table
from mission_samples import key

from pytpc.base.errors import InputError
from pytpc.diagnosis.fleet.behaviour_evidence import MOST, differing, worth
from pytpc.diagnosis.fleet.fleet_importance import fleet_importance, most_frequent
from pytpc.diagnosis.fleet.mission_evidence import joined
from pytpc.diagnosis.fleet.ranking import rank_fleet
from pytpc.diagnosis.fleet.rows import Rows
from pytpc.diagnosis.fleet.value_evidence import EXPLAINED, Missions, value_evidence
from pytpc.diagnosis.ranking.known_good import BETWEEN, UNCHANGED


def by_values(*missions, ordered=True, robots=None):
    """The evidence of one parameter: (value, bad) of each mission, all of one robot if not said."""
    value, bad = (np.array(column) for column in zip(*missions, strict=True))
    robot = np.array(robots or [0] * len(missions), np.int32)
    known = np.flatnonzero(~np.isnan(value))
    codes = np.unique(value[known], return_inverse=True)[1].astype(np.int64)
    found = Missions.of(robot, bad.astype(np.bool_))
    several = len({*robot.tolist()}) > 1
    return value_evidence(found, known, codes, ordered=ordered, several=several)


# P(bad) is (1 + 4 * (1 + 0.5) / (2 + 1)) / (2 + 4) = 0.5. Of the sets {1}, {2}, {1, 2} one has the
# bad mission and leaves out the good one. In it: B(10, 1) / B(9, 1) = 0.9, by 0.5. The good one:
# (1 - 0.5 (1 - x)) / 0.5 = 1 + x, in the mean 5 / 3. Cuts: 1.8 * 5 / 3 / 3 = 1. Each by itself:
# 0.2 * 1.8 * 0.8 * 5 / 3 = 0.48, with exp(-3) = 0.0498 of it: 0.974 in all.
def test_one_bad_and_one_good_mission():
    mean = 1.0 + float(EXPLAINED.mean())
    assert mean == pytest.approx(5 / 3, abs=0.002)
    rest = 0.950213 * 1.8 * mean / 3 + 0.049787 * 0.16 * 1.8 * mean
    found = by_values((2, True), (1, False))
    assert found == pytest.approx(math.log(rest + math.exp(UNCHANGED)), abs=1e-5)
    assert found == pytest.approx(math.log(0.974), abs=0.005)
    as_text = by_values((2, True), (1, False), ordered=False)
    assert as_text == pytest.approx(math.log(0.16 * 1.8 * mean + math.exp(UNCHANGED)), abs=1e-5)


def test_a_value_that_always_went_right_is_no_cause():
    for ordered in (True, False):
        same = [(1, True), (1, True), (1, False), (1, False)]
        assert by_values(*same, ordered=ordered) == pytest.approx(UNCHANGED)


def test_a_value_between_two_good_ones_is_nearly_as_good():
    good = [(1, False), (3, False)] * 5
    beyond = by_values(*good, (4, True), (4, True))
    between = by_values(*good, (2, True), (2, True))
    same = by_values(*good, (3, True), (3, True))
    assert beyond > between > same
    assert beyond - between > -BETWEEN - 1
    # Nothing lies between two texts or the two states of a flag.
    assert by_values(*good, (4, True), ordered=False) == pytest.approx(
        by_values(*good, (2, True), ordered=False)
    )


def test_one_bad_mission_with_another_cause_vetoes_nothing():
    good = [(1, False)] * 20
    all_of_them = by_values(*good, *[(2, True)] * 10)
    but_one = by_values(*good, *[(2, True)] * 9, (1, True))
    half = by_values(*good, *[(2, True)] * 5, *[(1, True)] * 5)
    one = by_values(*good, (2, True), *[(1, True)] * 9)
    none = by_values(*good, *[(1, True)] * 10)
    assert all_of_them > but_one > half > 0 > one > none
    assert none == pytest.approx(UNCHANGED)


# Robot 0 went wrong with the value that its sister has in all its good missions; then its sister
# has another one; then nobody flew with it before.
def test_good_missions_of_the_same_robot_say_more_than_those_of_sisters():
    def evidence(own_good, sisters):
        missions = [(2, True)] * 4 + [(own_good, False)] * 4 + [(sisters, False)] * 8
        return by_values(*missions, robots=[0] * 8 + [1] * 8)

    same, sister, nobody = evidence(2, 1), evidence(1, 2), evidence(1, 1)
    assert nobody > sister + 2
    assert sister > 0 > same
    assert sister > same + 3


# The right value of each robot is a wrong one of the other.
def test_robots_may_have_wrong_values_of_their_own():
    first = [(1, False)] * 6 + [(2, True)] * 3
    second = [(2, False)] * 6 + [(1, True)] * 3
    assert by_values(*first, *second, robots=[0] * 9 + [1] * 9) > 2


def test_a_robot_that_often_goes_wrong_does_not_make_its_settings_suspicious():
    own = [(2, True)] * 8
    sisters = [(1, False)] * 8
    by_one = by_values(*own, *sisters, robots=[0] * 8 + [1] * 8)
    by_all = by_values(*own, *sisters, robots=[0, 1] * 8)
    assert by_all > by_one + 2


def test_a_value_that_is_drawn_anew_for_each_mission_explains_nothing():
    drawn = [(value, value % 3 == 0) for value in range(30)]
    assert by_values(*drawn) < 0


# Half right and half wrong: log((1 + 1/3) / 2) = -0.41 each; not less than half of UNCHANGED.
def test_missions_without_a_known_value_say_little():
    assert by_values((math.nan, True), (1, False)) == pytest.approx(math.log(2 / 3))
    many = by_values(*[(math.nan, True)] * 100, (1, False))
    assert many == pytest.approx(UNCHANGED / 2)
    known = by_values((2, True), (1, False))
    assert by_values((2, True), (math.nan, True), (1, False)) < known


# What is compared only when something has gone wrong is known in bad missions alone.
def test_a_value_that_is_known_in_bad_missions_only_says_next_to_nothing():
    assert abs(by_values(*[(1, True)] * 10, *[(math.nan, False)] * 30)) < 1
    rows = fleet()
    recovery = [
        row | {"key": key(9), "parameter": "/nav/retry"}
        for row in rows
        if row["verdict"] == "bad" and row["parameter"] == "/nav/p3"
    ]
    rows = [row for row in rows if row["parameter"] != "/nav/p0"]
    found = rank_fleet(Rows.of(table(rows + recovery)))
    assert found.accused is None
    (one,) = [one for one in found.suspects if one.parameter == "/nav/retry"]
    assert one.reason == "its value is known in no good mission"
    assert one.probability < 0.5


def test_without_good_missions_values_say_next_to_nothing():
    assert abs(by_values((1, True), (1, True), (2, True))) < 1


def diagnoses(*rows):
    names = ("mission", "parameter", "log_probability", "log_none")
    made = [(m, p, math.log(probability), math.log(none)) for m, p, probability, none in rows]
    return pa.Table.from_pylist([dict(zip(names, row, strict=True)) for row in made])


def two_bad():
    flights = [Flight("m1", day=1, verdict="bad"), Flight("m2", day=2, verdict="bad")]
    return Rows.of(table([digest(one, number) for one in flights for number in (0, 1, 2)]))


# Two suspects: 0.4 each before, so R is 0.7 / 0.4 = 1.75 and 0.1 / 0.4; p2 was not compared. "None
# of them" is as likely as before.
def test_one_mission_says_what_its_diagnosis_says():
    one = [("m1", "/nav/p0", 0.7, 0.2), ("m1", "/nav/p1", 0.1, 0.2)]
    rows = two_bad()
    found = joined(rows, rows.parameters, diagnoses(*one))
    expected = [math.log(1.75), math.log(0.25), 0.0]
    assert found.evidence == pytest.approx(expected, abs=1e-4)
    assert (found.missions, found.none) == (1, pytest.approx(0.0, abs=1e-4))


# Of two missions with R = 1.75: ((1 + 0.75 x)^2 - (1 - x)^2) / (1 - (1 - x)^2) = (3.5 - 0.4375 x) /
# (2 - x). Both count as 2 / (1 + 0.25) = 1.6 missions: 0.8 of the log. "None of them", which is
# likely in one mission and not in the other (R = 4 and 0.25), is "apart" in 0.25.
def test_diagnoses_of_missions_are_joined():
    rows = two_bad()
    both = [(mission, "/nav/p0", 0.7, none) for mission, none in (("m1", 0.8), ("m2", 0.05))]
    # One suspect each: R is 0.7 / 0.8 = 0.875.
    found = joined(rows, rows.parameters, diagnoses(*both))
    x = EXPLAINED
    ratio = ((1 - 0.125 * x) ** 2 - (1 - x) ** 2) / (1 - (1 - x) ** 2)
    assert found.evidence[0] == pytest.approx(0.8 * math.log(ratio.mean()), abs=1e-4)
    ratio = ((1 + 3 * x) * (1 - 0.75 * x) - (1 - x) ** 2) / (1 - (1 - x) ** 2)
    expected = math.log(0.25 + 0.75 * ratio.mean() ** 0.8)
    assert found.none == pytest.approx(expected, abs=1e-4)
    four = [(m, f"/nav/p{k}", (0.7, 0.1)[k], 0.2) for m in ("m1", "m2") for k in (0, 1)]
    found = joined(rows, rows.parameters, diagnoses(*four))
    ratio = (3.5 - 0.4375 * x) / (2 - x)
    assert found.evidence[0] == pytest.approx(0.8 * math.log(ratio.mean()), abs=1e-4)


# R is 1.75 in m1 and 0 in m2: (1 + 0.75 x) (1 - x) - (1 - x)^2 = 1.75 x (1 - x), by x (2 - x).
def test_one_diagnosis_vetoes_nothing():
    rows = two_bad()
    given = [("m1", "/nav/p0", 0.7, 0.2), ("m1", "/nav/p1", 0.1, 0.2)]
    given += [("m2", "/nav/p0", 1e-300, 0.01), ("m2", "/nav/p1", 0.99, 0.01)]
    found = joined(rows, rows.parameters, diagnoses(*given))
    ratio = 1.75 * (1 - EXPLAINED) / (2 - EXPLAINED)
    assert found.evidence[0] == pytest.approx(0.8 * math.log(ratio.mean()), abs=1e-4)
    assert found.evidence[0] > -1


# Twelve missions, four of each cause. With R = 10.5 in four and 0.15 in eight, x = 1 / 3 alone has
# 4 log(4.17) + 8 log(0.72) = 3.1.
def test_three_causes_in_one_fleet_are_all_found():
    flights = [Flight(f"m{n:02}", day=1 + n, verdict="bad") for n in range(12)]
    rows = Rows.of(table([digest(one, k) for one in flights for k in range(12)]))
    given = [
        (f"m{n:02}", f"/nav/p{k}", 0.7 if n % 3 == k else 0.01, 0.19)
        for n in range(12)
        for k in range(12)
    ]
    found = joined(rows, rows.parameters, diagnoses(*given)).evidence.tolist()
    positive = [name for name, one in zip(rows.parameters, found, strict=True) if one > 0]
    assert positive == ["/nav/p0", "/nav/p1", "/nav/p2"]


def test_diagnoses_of_good_and_unknown_missions_do_not_count():
    rows = Rows.of(table([digest(Flight("m1", verdict="bad")), digest(Flight("m2", day=2))]))
    found = joined(
        rows, rows.parameters, diagnoses(("m2", "/nav/p0", 0.9, 0.1), ("m3", "/nav/p0", 0.9, 0.1))
    )
    assert (found.missions, found.evidence.tolist()) == (0, [0.0])


def test_diagnoses_of_two_robots_with_missions_of_one_name():
    rows = Rows.of(
        table([digest(Flight("m", robot, verdict="bad"), parameter="/p") for robot in "ab"])
    )
    given = diagnoses(("m", "/a/p", 0.7, 0.2))
    with pytest.raises(InputError, match="two robots have a mission m"):
        joined(rows, rows.parameters, given)
    given = given.append_column("robot", pa.array(["a"])).append_column("position", pa.array([3]))
    found = joined(rows, rows.parameters, given)
    assert (found.missions, found.position.tolist()) == (1, [3.0])


def test_a_diagnosis_may_use_the_name_in_the_source():
    rows = Rows.of(table([digest(Flight("m1", "r1", verdict="bad"), parameter="/r1/nav/p")]))
    names = ("/nav/p", "/arm/gain", "/a/x", "/b/x")
    given = [("m1", name, 0.3, 0.1) for name in ("~p", "/r1/arm/gain", "~x")]
    found = joined(rows, names, diagnoses(*given)).evidence
    # ~x may be either.
    assert found[0] == found[1] != 0
    assert found[2:].tolist() == [0.0, 0.0]


# -1 / (e p log p): e * 0.05 * 2.9957 = 0.4072. For 0.001 it is -log(0.0188) = 3.98, above the most.
def test_what_a_chance_is_worth():
    assert worth(0.05) == pytest.approx(-math.log(0.40717), abs=1e-4)
    assert [worth(chance) for chance in (1.0, 0.4, 0.001, 0.0)] == [0.0, 0.0, MOST, MOST]


# p0 turns 10 times in each of five bad missions, once in each of five good ones: all five beyond
# all five, 2 / 252, with ties by the normal distribution: excess 12.5, variance 25 / 12 * (11 -
# 2 * 120 / 90) = 17.36, z = 12 / 4.167 = 2.88, p = 0.00398; times four tests. p1 does not differ.
def test_a_comparison_that_turns_more_often_in_bad_missions():
    rows = []
    for number in range(10):
        flight = Flight(f"m{number}", day=1 + number, verdict="bad" if number < 5 else "good")
        rows += [digest(flight, 0, turns=10 if number < 5 else 1), digest(flight, 1)]
    found = differing(Rows.of(table(rows)))
    assert found.chance.tolist() == [pytest.approx(4 * 0.00398, rel=0.01), 1.0]
    assert (found.shows[0], found.measure[0], found.side[0]) == (0, 1, 1.0)
    assert found.evidence[1] == 0.0


# No robot has both: the chance of the difference between the robots is the square root.
def test_missions_of_other_robots_say_less():
    def chance(robots):
        flights = [
            Flight(f"m{n}", robots[n % 2], 1 + n, "bad" if n % 2 else "good") for n in range(10)
        ]
        rows = [digest(one, turns=10 if one.verdict == "bad" else 1) for one in flights]
        return float(differing(Rows.of(table(rows))).chance[0])

    assert chance("ab") == pytest.approx(4 * math.sqrt(chance("aa") / 4))


# Two bad, three good. p0 turned in both bad ones and in one good one: Increase = 2/3 - 2/5,
# Importance 8/19 as in the study's test. Its threshold 0.7 in one bad mission is unusual: F = 1 of
# 2, log(1) = 0, so nothing. p1 has an unusual threshold in both: Increase = 1 - 2/5 = 3/5,
# Importance = 2 / (5/3 + 1) = 0.75.
def test_importance_with_missions_as_runs():
    rows = []
    for number in range(5):
        bad = number < 2
        flight = Flight(f"m{number}", day=1 + number, verdict="bad" if bad else "good")
        rows.append(digest(flight, 0, 0.7 if number == 0 else 0.5, turns=int(number < 3)))
        rows.append(digest(flight, 1, 0.9 if bad else 0.5, turns=0))
    assert fleet_importance(Rows.of(table(rows))) == pytest.approx([8 / 19, 0.75])


def test_the_usual_threshold_is_that_of_the_robot():
    rows = [digest(Flight(f"a{n}", "a", 1 + n), 0, 0.5) for n in range(3)]
    rows += [digest(Flight(f"b{n}", "b", 1 + n), 0, 0.9) for n in range(2)]
    rows += [digest(Flight(f"w{n}", "b", 9, "bad"), 0, 0.9) for n in range(2)]
    assert fleet_importance(Rows.of(table(rows))).tolist() == [0.0]
    rows += [digest(Flight(f"v{n}", "b", 9, "bad"), 0, 0.5) for n in range(2)]
    assert fleet_importance(Rows.of(table(rows)))[0] > 0


def test_the_most_frequent_value_is_of_equals_the_smallest():
    groups = np.array([0, 0, 0, 2, 2])
    found = most_frequent(groups, np.array([3.0, 1.0, 3.0, 8.0, 7.0]), 3)
    assert found.tolist()[::2] == [3.0, 7.0]
    assert math.isnan(found[1])


def fleet(bad=4, good=12, wrong=0.9, numbers=4):
    """Three robots, each with its own settings; p0 is wrong in bad missions, p1 differs in one."""
    rows = []
    for n in range(bad + good):
        robot = n % 3
        flight = Flight(f"m{n:02}", f"r{robot}", 1 + n, "bad" if n < bad else "good")
        for number in range(numbers):
            thresh = 0.5 + 0.1 * robot if number % 2 else 0.5
            if n < bad and number == 0:
                thresh = wrong
            if n == 0 and number == 1:
                thresh = 0.55
            rows.append(digest(flight, number, thresh))
    return rows


def test_the_parameter_whose_value_only_bad_missions_have_is_first():
    found = rank_fleet(Rows.of(table(fleet())))
    first, second, *rest = found.suspects
    assert (first.parameter, first.position, first.tied) == ("/nav/p0", 1, False)
    assert found.accused == "/nav/p0"
    assert (found.bad, found.good, found.robots, found.diagnosed) == (4, 12, 3, 0)
    assert (first.differs, second.differs) == (1.0, 0.25)
    assert (first.robots, second.robots) == (("r0", "r1", "r2"), ("r0",))
    shown = [(one.text, one.bad, one.good, one.fresh) for one in first.values]
    assert shown == [("0.9", 4, 0, 4), ("0.5", 0, 12, 0)]
    assert first.reason == (
        "4 of 4 bad missions have a value that no good mission of the robot has: 0.9"
    )
    assert first.shows.place == "src/nav.cpp:10"
    assert first.importance_position == 1
    assert (first.margin_bad, first.margin_good) == (0.2, 0.2)
    assert second.reason == (
        "1 of 4 bad missions has a value that no good mission of the robot has: 0.55"
    )
    # Settings of the robots are a little likelier than what all of them have.
    assert [one.parameter for one in rest] == ["/nav/p3", "/nav/p2"]
    assert sum(one.probability for one in found.suspects) + found.none == pytest.approx(1)
    assert rest[1].reason == "each robot flew well with what it had in bad missions: 0.5"


def test_the_answer_does_not_depend_on_the_order_of_the_rows():
    rows = fleet()
    assert rank_fleet(Rows.of(table(rows))) == rank_fleet(Rows.of(table(rows[::-1])))


def test_without_a_difference_it_is_none_of_the_parameters():
    rows = [digest(Flight(f"m{n}", day=1 + n, verdict="good" if n else "bad")) for n in range(6)]
    found = rank_fleet(Rows.of(table(rows)))
    assert found.accused is None
    assert found.none > 0.9
    assert "most likely none of the parameters" in found.text


def test_probabilities_by_hand():
    rows = [digest(Flight("m1", verdict="bad"), 0, 0.9), digest(Flight("m2", day=2), 0, 0.5)]
    found = rank_fleet(Rows.of(table(rows)))
    # One parameter: 0.8 against 0.2 before; the evidence of its values is log(0.974).
    odds = 4 * 0.974
    assert found.suspects[0].evidence.values == pytest.approx(math.log(0.974), abs=0.003)
    assert found.none == pytest.approx(1 / (1 + odds), abs=0.001)


def test_diagnoses_decide_where_values_do_not():
    rows = [
        digest(Flight(f"m{n}", day=1 + n, verdict="bad" if n < 3 else "good"), number)
        | {"thresh_last": 0.9 if n < 3 else 0.5}
        for n in range(9)
        for number in (0, 1)
    ]
    found = rank_fleet(Rows.of(table(rows)))
    assert [(one.position, one.tied) for one in found.suspects] == [(1, True), (1, True)]
    given = [(f"m{n}", f"/nav/p{k}", 0.8 if k else 0.1, 0.1) for n in range(2) for k in (0, 1)]
    found = rank_fleet(Rows.of(table(rows)), diagnoses=diagnoses(*given))
    assert [one.parameter for one in found.suspects] == ["/nav/p1", "/nav/p0"]
    assert found.diagnosed == 2
    assert found.notes == ("1 bad mission without a diagnosis",)


def recorded(flights, name, of):
    return [
        {
            "mission": one.mission,
            "robot": one.robot,
            "name": name,
            "time_ns": None,
            "value": str(of(n)),
            "number": float(of(n)),
        }
        for n, one in enumerate(flights)
    ]


def test_a_gain_that_no_comparison_reports_may_be_the_cause():
    flights = [Flight(f"m{n}", day=1 + n, verdict="bad" if n < 4 else "good") for n in range(12)]
    rows = Rows.of(table([digest(one, number) for one in flights for number in (0, 1)]))
    values = recorded(flights, "/gain", lambda n: 2 if n < 4 else 1)
    values += recorded(flights, "/rate", lambda n: 9)
    # The seed of each mission is its number: those of the bad ones are the lowest.
    values += recorded(flights, "/seed", lambda n: n)
    found = rank_fleet(rows, values=pa.Table.from_pylist(values))
    first = found.suspects[0]
    assert (first.parameter, first.shows, first.unit) == ("/gain", None, "")
    assert first.reason.endswith("; no comparison reports it")
    # The log says nothing of it: it is not blamed. What never changed is no suspect, nor is what
    # only names a mission.
    assert found.accused is None
    assert [one.parameter for one in found.suspects[1:]] == ["/nav/p0", "/nav/p1"]


# A limit that is switched off in the bad missions is a number above all others.
@pytest.mark.parametrize("is_recorded", [True, False])
def test_an_infinite_limit_may_be_the_cause(is_recorded):
    flights = [Flight(f"m{n}", day=1 + n, verdict="bad" if n < 4 else "good") for n in range(12)]
    off = {} if is_recorded else {"thresh_last": math.inf, "thresholds": 0}
    rows = [
        digest(one, number) | (off if number == 0 and one.verdict == "bad" else {})
        for one in flights
        for number in (0, 1)
    ]
    values = recorded(flights, "/nav/p0", lambda n: math.inf if n < 4 else 5)
    for one in values:
        one["value"] = one["value"].replace("inf", "Infinity")
    given = pa.Table.from_pylist(values) if is_recorded else None
    found = rank_fleet(Rows.of(table(rows)), values=given)
    assert found.accused == "/nav/p0"
    assert [one.text for one in found.suspects[0].values] == ["inf", "5" if is_recorded else "0.5"]


def test_notes_say_what_is_missing():
    rows = [digest(Flight("m1", "r1", verdict="bad")), digest(Flight("m2", "r2", 2))]
    rows.append(digest(Flight("m3", "r2", 3, "unknown")))
    assert rank_fleet(Rows.of(table(rows))).notes == (
        "robots with bad missions and no good one: r1",
        "1 mission neither good nor bad, not counted",
    )
    alone = rank_fleet(Rows.of(table(rows[:1])))
    assert alone.notes == ("no mission is good, so that values say little: add good missions",)


def test_without_a_bad_mission_nothing_is_ranked():
    with pytest.raises(InputError, match="no mission is bad: add"):
        rank_fleet(Rows.of(table([digest(Flight("m1"))])))
