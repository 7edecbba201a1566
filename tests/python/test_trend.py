"""The median of slopes, and how likely chance is to order points so."""

from __future__ import annotations

import numpy as np
import pytest

from pytpc.diagnosis.trend import joint_trend, trend_of


def trend(*values):
    return trend_of(np.arange(len(values), dtype=np.float64), np.array(values, np.float64))


def test_one_point_has_no_trend():
    assert trend(1) is None


def test_the_slope_is_the_median_of_all_pairs():
    # Pairs: 1, 5, 2 (0 to 1, 1 to 2, 0 to 2 halved is 3): 1, 5, 3. One point off changes little.
    found = trend(0, 1, 6)
    assert found.slope == 3


def test_chance_of_a_rising_series_is_two_orders_of_all():
    # Five points: of the 120 orders one rises and one falls.
    assert trend(1, 2, 3, 4, 5).chance == pytest.approx(2 / 120)
    assert not trend(1, 2, 3, 4, 5).is_clear
    # Six points: 2 / 720 = 0.003.
    assert trend(1, 2, 3, 4, 5, 6).is_clear
    assert trend(6, 5, 4, 3, 2, 1).slope == -1


def test_one_pair_in_the_wrong_order():
    # Four points with one pair swapped: 1 + 3 of 24 orders have at most one pair in the wrong
    # order, and as many at most one in the right one.
    assert trend(1, 2, 4, 3).chance == pytest.approx(8 / 24)


def test_a_flat_series_has_none():
    found = trend(2, 2, 2, 2)
    assert (found.slope, found.chance, found.is_clear) == (0, 1, False)


def test_many_points_and_ties_by_the_normal_distribution():
    # 50 points: variance 50 * 49 * 105 / 18 = 14291.7, S = 1225, z = 1224 / 119.5 = 10.2.
    rising = trend(*range(50))
    assert rising.is_clear
    assert rising.chance < 1e-20
    # Ties: 1, 1, 2: S = 2, variance (3*2*11 - 2*1*9) / 18 = 2.667, z = 1 / 1.633 = 0.6124.
    assert trend(1, 1, 2).chance == pytest.approx(0.5403, abs=1e-4)


# Two series of three points that rise: S = 3 + 3, variance 2 * 3 * 2 * 11 / 18 = 7.33, z = 5 / 2.71
# = 1.846. Their levels and times do not matter.
def test_several_series_have_one_trend():
    first = np.array([0.0, 1.0, 2.0]), np.array([1.0, 2.0, 3.0])
    second = np.array([100.0, 101.0, 102.0]), np.array([-9.0, -8.0, -7.0])
    found = joint_trend([first, second])
    assert found.slope == 1.0
    assert found.chance == pytest.approx(0.0649, abs=1e-4)
    assert joint_trend([first]) == trend_of(*first)
    one_point = np.array([0.0]), np.array([1.0])
    assert joint_trend([one_point, one_point]) is None
    assert joint_trend([]) is None
