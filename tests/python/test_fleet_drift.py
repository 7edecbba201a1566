from __future__ import annotations

import numpy as np
import pytest
from fleet_samples import Flight, digest, table

from pytpc.base.errors import InputError
from pytpc.diagnosis.fleet.drifting import fleet_drift
from pytpc.diagnosis.fleet.group_medians import group_medians
from pytpc.diagnosis.fleet.rows import Rows
from pytpc.diagnosis.results.fleet import WHOLE_FLEET
from pytpc.diagnosis.trend import lines_of


def drifts(*rows):
    return fleet_drift(Rows.of(table(list(rows))))


def daily(least, *, robot="r1", first=1, number=0, **changes):
    """A mission a day with these least margins, and a steady median of 5."""
    changes = {"turns": 0, "median": 5.0, **changes}
    return [
        digest(Flight(f"{robot}-{first + n}", robot, first + n), number, least=one, **changes)
        for n, one in enumerate(least)
    ]


# 10, 9, ... 6 on March 1 to 5: a slope of -1 a day, 0 on March 11.
def test_the_day_on_which_a_falling_margin_turns():
    found = drifts(*daily([10.0, 9.0, 8.0, 7.0, 6.0]))
    one = found.drifts[0]
    assert (one.robot, one.measure, one.days) == ("r1", "least", 5)
    assert (one.since, one.until, one.turns_on) == ("2026-03-01", "2026-03-05", "2026-03-11")
    assert (one.earliest, one.latest) == ("2026-03-11", "2026-03-11")
    assert (one.now, one.per_day, one.threshold) == (6.0, -1.0, 0.5)
    assert one.chance == pytest.approx(2 / 120)
    assert one.is_clear
    # Least and median margin; the median has no trend. One robot alone is no fleet.
    assert (found.tested, found.short, len(found.drifts)) == (2, 0, 1)
    assert found.by_chance == pytest.approx(0.04)


def test_fewer_than_five_days_say_nothing():
    found = drifts(*daily([10.0, 9.0, 8.0, 7.0]))
    assert (found.drifts, found.tested, found.short) == ((), 0, 2)


# Two missions of one day have one median: 9 and 11 are 10.
def test_a_day_counts_once():
    rows = daily([9.0, 9.0, 8.0, 7.0, 6.0])
    rows += [digest(Flight("again", "r1", 1), least=11.0, turns=0, median=5.0)]
    assert drifts(*rows).drifts[0].now == 6.0
    assert drifts(*rows).drifts[0].days == 5
    assert [tuple(one) for one in drifts(*rows).drifts[0].margins] == [
        ("2026-03-01", 10.0), ("2026-03-02", 9.0), ("2026-03-03", 8.0),
        ("2026-03-04", 7.0), ("2026-03-05", 6.0),
    ]  # fmt: skip


def test_what_rises_does_not_turn_and_comes_last():
    rising = daily([5.0, 6.0, 7.0, 8.0, 9.0], number=0)
    falling = daily([40.0, 39.0, 38.0, 37.0, 36.0], number=1)
    found = drifts(*rising, *falling).drifts
    assert [(one.where.parameter, one.turns_on) for one in found] == [
        ("/nav/p1", "2026-04-10"),
        ("/nav/p0", None),
    ]
    assert (found[1].earliest, found[1].latest) == (None, None)


def test_the_earliest_turn_is_first():
    slow = daily([20.0, 19.0, 18.0, 17.0, 16.0], number=0)
    fast = daily([10.0, 8.0, 6.0, 4.0, 2.0], number=1)
    assert [one.turns_on for one in drifts(*slow, *fast).drifts] == ["2026-03-06", "2026-03-21"]


# It lost 0.001 of 10 a day: 10,000 days, far beyond ten times the four that were seen.
def test_a_day_that_is_too_far_off_is_not_said():
    one = drifts(*daily([10.0, 9.999, 9.998, 9.997, 9.996])).drifts[0]
    assert one.turns_on is None
    assert one.per_day == pytest.approx(-0.001)


# Another threshold from March 6 on: what fell before does not count, and three days are too few.
def test_another_setting_begins_a_new_series():
    old = daily([10.0, 9.0, 8.0, 7.0, 6.0])
    assert drifts(*old, *daily([9.0, 8.0, 7.0], first=6, thresh=0.7)).drifts == ()
    new = daily([30.0, 28.0, 26.0, 24.0, 22.0], first=6, thresh=0.7)
    one = drifts(*old, *new).drifts[0]
    # 22 on March 10, 2 a day.
    assert (one.since, one.threshold, one.turns_on) == ("2026-03-06", 0.7, "2026-03-21")


def test_the_least_margin_of_what_turns_already_does_not_count():
    rows = daily([0.5, 0.4, 0.3, 0.2, 0.1], turns=3)
    assert drifts(*rows).drifts == ()
    rows = [row | {"median": 10.0 - n} for n, row in enumerate(rows)]
    one = drifts(*rows).drifts[0]
    assert (one.measure, one.turned, one.turns_on) == ("median", 15, "2026-03-11")


# Two robots, which fly by turns and fall by 1 a day: from 22 to 12 on March 11, and from 111 to 101
# on March 12. In the middle of both: 56 on March 12.
def test_over_the_fleet_only_days_of_one_robot_are_compared():
    rows = []
    for day in range(12):
        robot = "ab"[day % 2]
        level = 10.0 if robot == "a" else 100.0
        rows += daily([level + 12.0 - day], robot=robot, first=1 + day)
    found = [one for one in drifts(*rows).drifts if one.robot == WHOLE_FLEET]
    assert [(one.days, one.per_day) for one in found] == [(12, -1.0)]
    assert found[0].now == pytest.approx(56.0)
    # No day is 90 above the one before: both robots are moved to the level of 67 on March 1.
    assert [one.margin for one in found[0].margins] == [67.0 - day for day in range(12)]
    assert found[0].is_clear


# Three robots fall by 1 a day from 10 on March 20 to 6 on March 24; a fourth one does the same by a
# clock that is behind. Ten times four days ahead is May 3: p1, which would be 0 on May 23, is too
# far off, whatever that clock says.
def test_a_robot_whose_clock_is_off_does_not_widen_the_fleets_series():
    rows = []
    for robot, first in (("a", 20), ("b", 20), ("c", 20), ("d", 1)):
        for number, level, step in ((0, 10.0, 1.0), (1, 12.8, 0.2)):
            least = [level - step * n for n in range(5)]
            rows += daily(least, robot=robot, first=first, number=number)
    first, second = (one for one in drifts(*rows).drifts if one.robot == WHOLE_FLEET)
    assert (first.since, first.until, first.days) == ("2026-03-20", "2026-03-24", 5)
    assert (first.now, first.turns_on) == (pytest.approx(6.0), "2026-03-30")
    assert (second.where.parameter, second.turns_on) == ("/nav/p1", None)


# A robot flew in the first week at 10, its sister in the second at 5: nothing fell.
def test_another_level_of_another_robot_is_no_drift():
    rng = np.random.default_rng(5)
    rows = daily((10 + rng.random(7)).tolist(), robot="a")
    rows += daily((5 + rng.random(7)).tolist(), robot="b", first=8)
    assert [one for one in drifts(*rows).drifts if one.robot == WHOLE_FLEET] == []


# 200 series without a trend: a drift that chance brings once in fifty is not clear.
def test_among_many_series_a_weak_trend_is_not_clear():
    rng = np.random.default_rng(7)
    rows = []
    for number in range(200):
        rows += daily((10 + rng.random(5)).tolist(), number=number)
    found = drifts(*rows, *daily([10.0, 9.0, 8.0, 7.0, 6.0], number=200))
    weak = [one for one in found.drifts if one.where.parameter == "/nav/p200"]
    assert [one.is_clear for one in weak] == [False]
    long = daily([30.0 - n for n in range(20)], number=201)
    found = drifts(*rows, *long)
    assert [one.where.parameter for one in found.drifts if one.is_clear] == ["/nav/p201"]


def test_a_day_that_is_none_is_refused():
    with pytest.raises(InputError, match="the day 'today' of a mission"):
        drifts(digest(Flight("m")) | {"day": "today"})


def test_nothing_drifts_in_an_empty_fleet():
    assert drifts().drifts == ()


# Slopes of the pairs of 0, 1, 2, 3, 10: 1 six times, 10/4, 9/3, 8/2, 7. For five points 1.96 *
# sqrt(5 * 4 * 15 / 18) = 8.0: from the first of ten to the last. The middle one of ten is 1.
def test_the_interval_of_a_slope():
    line, low, high = lines_of([(np.arange(5.0), np.array([0.0, 1.0, 2.0, 3.0, 10.0]))])
    assert (line.slope, low.slope, high.slope) == (1.0, 1.0, 7.0)
    assert (line.at(4.0), line.zero) == (4.0, None)
    falling, steep, flat = lines_of([(np.arange(5.0), np.array([10.0, 9.0, 8.0, 7.0, 0.0]))])
    assert (falling.zero, steep.slope, flat.slope) == (10.0, -7.0, -1.0)


def test_medians_of_groups():
    found = group_medians(np.array([5, 2, 5, 2, 5, 9]), np.array([1.0, 4.0, 9.0, 2.0, 3.0, np.nan]))
    assert found.group.tolist() == [2, 5]
    assert found.median.tolist() == [3.0, 3.0]
    assert found.size.tolist() == [2, 3]
