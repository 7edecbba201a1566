"""Several causes in one fleet: each is judged without the missions that the others explain."""

from __future__ import annotations

import pyarrow as pa
import pytest
from fleet_samples import Flight, digest, table

from pytpc.diagnosis.fleet.ranking import rank_fleet
from pytpc.diagnosis.fleet.rows import Rows

ROBOTS = ("r0", "r1", "r2")


def fleet(*wrong: dict[int, float], good: int = 12, parameters: int = 6) -> list[dict[str, object]]:
    """Good missions with 0.5 everywhere, and a bad one for each of ``wrong``, with its values."""
    rows = []
    for number, values in enumerate([{}] * good + list(wrong)):
        verdict = "bad" if number >= good else "good"
        flight = Flight(f"m{number:02}", ROBOTS[number % 3], 1 + number, verdict)
        rows += [digest(flight, each, values.get(each, 0.5)) for each in range(parameters)]
    return rows


def causes(rows: list[dict[str, object]]) -> list[tuple[str, int, tuple[str, ...]]]:
    found = rank_fleet(Rows.of(table(rows)))
    return [(one.parameter, one.bad, one.robots) for one in found.causes]


def test_two_causes_of_which_none_is_sure_alone() -> None:
    found = rank_fleet(Rows.of(table(fleet(*[{0: 0.9}] * 5, *[{1: 0.1}] * 3))))
    assert [(one.parameter, one.bad) for one in found.causes] == [("/nav/p0", 5), ("/nav/p1", 3)]
    assert all(one.probability > 0.9 for one in found.causes)
    assert max(one.probability for one in found.suspects[1:]) < 0.8
    assert (found.accused, found.is_mixed) == ("/nav/p0", True)
    assert found.text.startswith("blame /nav/p0, ")
    assert " for 5 of 8 bad missions; /nav/p1, " in found.text
    assert found.text.endswith(" for 3")


def test_one_cause_is_told_as_before() -> None:
    found = rank_fleet(Rows.of(table(fleet(*[{0: 0.9}] * 4))))
    assert [(one.parameter, one.bad, one.robots) for one in found.causes] == [
        ("/nav/p0", 4, ROBOTS)
    ]
    assert not found.is_mixed
    assert found.text.startswith("blame /nav/p0: ")


def test_bad_missions_that_nothing_explains() -> None:
    rows = fleet(*[{0: 0.9}] * 6, *[{}] * 3, good=24)
    assert causes(rows) == [("/nav/p0", 6, ROBOTS)]


def test_a_mission_with_two_wrong_values_counts_for_the_likelier_cause() -> None:
    found = causes(fleet(*[{0: 0.9}] * 5, {0: 0.9, 1: 0.1}, *[{1: 0.1}] * 3))
    assert [(name, bad) for name, bad, _ in found] == [("/nav/p0", 6), ("/nav/p1", 3)]


@pytest.mark.parametrize("wrong", [{2: 0.51}, {3: 0.9}])
def test_a_value_of_one_bad_mission_among_many_is_no_cause(wrong: dict[int, float]) -> None:
    """It may be a setting that differs, as robots have them."""
    rows = fleet(*[{0: 0.9}] * 8, {0: 0.9, **wrong})
    assert [name for name, *_ in causes(rows)] == ["/nav/p0"]


def test_a_robot_that_never_went_right() -> None:
    """r3 has the usual p0, with which its sisters went right: p0 explains none of its missions."""
    rows = fleet(*[{0: 0.9}] * 6, *[{1: 0.1}] * 2, good=24)
    for n in range(4):
        flight = Flight(f"w{n}", "r3", 20 + n, "bad")
        rows += [digest(flight, each, 0.1 if each == 1 else 0.5) for each in range(6)]
    assert causes(rows) == [("/nav/p0", 6, ROBOTS), ("/nav/p1", 6, ("r0", "r1", "r3"))]


def test_what_no_comparison_reports_is_no_cause() -> None:
    rows = fleet(*[{}] * 4, *[{0: 0.9}] * 6, good=24)
    gain = {n: 2 if 24 <= n < 28 else 1 for n in range(34)}
    values = [
        {"mission": f"m{n:02}", "robot": ROBOTS[n % 3], "name": "/gain", "time_ns": None}
        | {"value": str(one), "number": float(one)}
        for n, one in gain.items()
    ]
    found = rank_fleet(Rows.of(table(rows)), values=pa.Table.from_pylist(values))
    assert "/gain" in [one.parameter for one in found.suspects]
    assert [one.parameter for one in found.causes] == ["/nav/p0"]


@pytest.mark.parametrize(("unseen", "explained"), [(1, 4), (2, 0)])
def test_a_mission_that_went_wrong_unseen(unseen: int, explained: int) -> None:
    """r0 went wrong with 0.9 in four missions, and one or two with it count as good."""
    rows = fleet(*[{1: 0.1}] * 4, good=24)
    for n in range(4 + unseen):
        flight = Flight(f"w{n}", "r0", 20 + n, "bad" if n < 4 else "good")
        rows += [digest(flight, each, 0.9 if each == 0 else 0.5) for each in range(6)]
    found = {name: bad for name, bad, _ in causes(rows)}
    assert found.get("/nav/p0", 0) == explained
    assert found["/nav/p1"] == 4


def test_nothing_is_wrong() -> None:
    assert causes(fleet(*[{}] * 4)) == []
