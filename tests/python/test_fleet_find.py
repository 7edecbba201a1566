from __future__ import annotations

import math
from dataclasses import replace

import pytest
from fleet_samples import Flight, digest, table
from mission_samples import comparison, events, key, ns, static_info

from pytpc.base.errors import InputError
from pytpc.diagnosis.fleet.finding import TurnQuery, find_missions, turns_in
from pytpc.diagnosis.fleet.rows import Rows
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_values import ParameterValues, SetValue
from pytpc.static.link_unit import Transform


def found(query, *rows):
    return [one.mission for one in find_missions(Rows.of(table(list(rows))), query)]


def rows():
    return [
        digest(Flight("far", day=1), 0, least=0.2),
        digest(Flight("near", day=2), 0, least=0.01),
        digest(Flight("still", day=3), 0, least=0.001, turns=0),
        digest(Flight("high", day=4, verdict="bad"), 0, least=0.01, value_low=5.0, value_high=6.0),
        digest(Flight("other", day=5), 1, least=0.01),
        digest(Flight("flag", day=6), 2, least=math.nan),
    ]


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        (TurnQuery(), ["far", "near", "high", "other", "flag"]),
        (TurnQuery(within=0.01), ["near", "high", "other"]),
        (TurnQuery(place="nav.cpp:10"), ["far", "near", "high"]),
        (TurnQuery(place="src/nav.cpp"), ["far", "near", "high", "other", "flag"]),
        (TurnQuery(place="src/nav.cpp:11"), ["other"]),
        (TurnQuery(parameter="p1"), ["other"]),
        (TurnQuery(parameter="/nav/p0", within=0.1), ["near", "high"]),
        (TurnQuery(key=key(2)), ["flag"]),
        (TurnQuery(key=f"{key(2)}#1"), ["flag"]),
        (TurnQuery(low=5.5, high=9.0), ["high"]),
        (TurnQuery(parameter="p0", high=5.0), ["far", "near", "high"]),
    ],
)
def test_missions_are_found_by_their_digests(query, expected):
    assert found(query, *rows()) == expected


def test_a_mission_says_which_comparisons_fit():
    both = [digest(Flight("m"), 0, turns=2, least=0.3), digest(Flight("m"), 1, turns=3, least=0.1)]
    one = find_missions(Rows.of(table(both)), TurnQuery())[0]
    assert [where.place for where in one.where] == ["src/nav.cpp:10", "src/nav.cpp:11"]
    assert (one.turns, one.least, one.robot, one.day) == (5, 0.1, "r1", "2026-03-01")
    assert one.text == "r1 2026-03-01 m: 5 turns"


@pytest.mark.parametrize(
    "query",
    [TurnQuery(place="av.cpp:10"), TurnQuery(place="nav.cpp:1"), TurnQuery(parameter="speed")],
)
def test_a_place_that_is_nowhere_is_an_error(query):
    with pytest.raises(InputError, match="no comparison of the fleet is of"):
        found(query, *rows())


# `value > ~a` in node.cpp:10: 1 and 3 with 2 is a turn whose nearer side is 1 off; 2.1 and 1.5 turn
# back, 0.1 off. `value > 2 * ~b` in line 11: 5 and 7.5 with 6, 1 off, so 0.5 of the parameter.
STATIC = static_info(
    comparison(0, "~a"),
    comparison(1, "~b", type="derived", transform=Transform("affine", 2.0, 0.0)),
)
LOG = events(
    [
        (1, 0, 0, 1.0, 2.0),
        (2, 0, 1, 3.0, 2.0),
        (3, 0, 1, 2.1, 2.0),
        (4, 0, 0, 1.5, 2.0),
        (5, 1, 0, 5.0, 6.0),
        (6, 1, 1, 7.5, 6.0),
    ]
)
MISSION = Recording("m", LOG, (), 0, ns(10))


def times(query, **more):
    return [one.time_ns / 1e9 for one in turns_in(MISSION, STATIC, query, **more)]


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        (TurnQuery(), [2, 4, 6]),
        (TurnQuery(within=0.6), [4, 6]),
        (TurnQuery(within=0.2), [4]),
        (TurnQuery(place="node.cpp:11"), [6]),
        (TurnQuery(parameter="a"), [2, 4]),
        (TurnQuery(key=key(1)), [6]),
        (TurnQuery(low=2.0), [2, 6]),
        (TurnQuery(low=2.0, high=3.0), [2]),
        (TurnQuery(parameter="speed"), []),
    ],
)
def test_turns_of_a_mission(query, expected):
    assert times(query) == expected


# Two objects of one class, of which the second turns at 4 s.
def test_turns_of_one_instance():
    def turned(asked):
        return [one.time_ns / 1e9 for one in turns_in(mission, static, TurnQuery(key=asked))]

    own = [f"{key(0)}#{number}" for number in (1, 2)]
    static = static_info(*(replace(comparison(0, "~a"), key=one) for one in own))
    log = events([(1, 0, 0, 1, 2), (2, 0, 1, 3, 2), (3, 1, 0, 1, 2), (4, 1, 1, 3, 2)])
    mission = Recording("m", replace(log, keys=tuple(own)), (), 0, ns(10))
    assert turned(own[1]) == [4]
    assert turned(key(0)) == [2, 4]


def test_a_turn_has_its_values():
    first, second, third = turns_in(MISSION, STATIC, TurnQuery())
    assert (first.value, first.threshold, first.margin, first.result) == (3.0, 2.0, 1.0, True)
    assert (second.margin, second.result) == (pytest.approx(0.1), False)
    assert (third.margin, third.parameter, third.place) == (0.5, "~b", "src/node.cpp:11")


def test_only_turns_at_which_a_parameter_had_a_value():
    known = ParameterValues(
        [SetValue(0, "/n/mode", 1), SetValue(ns(3), "/n/mode", 2), SetValue(0, "/n/on", True)]
    )
    assert times(TurnQuery(had=(("mode", 1),)), values=known) == [2]
    assert times(TurnQuery(had=(("/n/mode", 2), ("on", True))), values=known) == [4, 6]
    assert times(TurnQuery(had=(("on", 1),)), values=known) == []
    assert times(TurnQuery(had=(("nobody", 1),)), values=known) == []
    assert times(TurnQuery(had=(("mode", 1),))) == []


def test_the_node_of_a_turn_is_without_the_robots_namespace():
    log = events([(1, 0, 0, 1, 2), (2, 0, 1, 3, 2)], "/r_1/nav")
    mission = Recording("m", log, (), 0, ns(10))
    for robot, node in (("r-1", "/nav"), ("r-2", "/r_1/nav")):
        assert [one.node for one in turns_in(mission, STATIC, TurnQuery(), robot=robot)] == [node]


# Answers call /r-1's parameter /n/speed, and print 0.30000001192092896 as 0.3.
def test_a_value_is_asked_for_as_answers_print_it():
    known = ParameterValues(
        [SetValue(0, "/r_1/n/speed", 0.30000001192092896), SetValue(0, "/r_1/n/big", 10**400)]
    )
    asked = TurnQuery(had=(("/n/speed", 0.3),))
    assert times(asked, values=known, robot="r-1") == [2, 4, 6]
    assert times(asked, values=known, robot="r-2") == []
    assert times(TurnQuery(had=(("speed", 0.3001),)), values=known, robot="r-1") == []
    assert times(TurnQuery(had=(("big", 1.0),)), values=known, robot="r-1") == []


def test_a_turn_to_what_is_no_number():
    log = events([(1, 0, 0, 1.0, 2.0), (2, 0, 1, math.nan, 2.0), (3, 0, 0, math.nan, 2.0)])
    mission = Recording("m", log, (), 0, ns(10))
    first, second = turns_in(mission, STATIC, TurnQuery())
    assert (first.margin, second.margin) == (1.0, None)
    assert len(turns_in(mission, STATIC, TurnQuery(within=5.0))) == 1
    assert turns_in(mission, STATIC, TurnQuery(low=0.0)) == ()
