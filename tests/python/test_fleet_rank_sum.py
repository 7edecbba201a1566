from __future__ import annotations

import math

import numpy as np
import pytest

from pytpc.diagnosis.fleet.rank_sum import exact_chance, rank_sums


def sums(*rows, count=1):
    """Rows of comparison, stratum, value, group."""
    which, stratum, values, group = zip(*rows, strict=True)
    return rank_sums(
        np.array(which, np.int64),
        np.array(stratum, np.int64),
        np.array(values, np.float64),
        np.array(group, np.bool_),
        count,
    )


# Two of five: of the 10 choices one has both largest, one both smallest.
def test_the_exact_chance_of_the_two_largest():
    rows = [(0, 0, value, value > 3) for value in (1.0, 2.0, 3.0, 4.0, 5.0)]
    found = sums(*rows)
    assert found.chance.tolist() == [pytest.approx(2 / 10)]
    assert found.side.tolist() == [1.0]


# The group has places 1 and 3: sums of at most 4 are {1, 2} and {1, 3}: 2 of 10, on both sides 4.
def test_the_exact_chance_of_places_one_and_three():
    assert exact_chance(-2.0, 2, 3) == pytest.approx(4 / 10)
    assert exact_chance(0.0, 2, 3) == 1.0


# All 8 before all 16: 1 of 735,471 choices, and as many on the other side.
def test_the_exact_chance_of_a_robot_beyond_all_others():
    assert exact_chance(-64.0, 8, 16) == pytest.approx(2 / math.comb(24, 8))


# Values 1, 1, 2, 2 with the group at 2, 2: ranks 1.5, 1.5, 3.5, 3.5. Excess 7 - 2 * 2.5 = 2.
# Variance 2 * 2 / 12 * (5 - (6 + 6) / (4 * 3)) = 4 / 3. With half a step: 1.5 / 1.1547 = 1.299.
def test_ties_have_their_mean_rank():
    found = sums((0, 0, 1.0, 0), (0, 0, 1.0, 0), (0, 0, 2.0, 1), (0, 0, 2.0, 1))
    assert found.chance.tolist() == [pytest.approx(math.erfc(1.299038 / math.sqrt(2)), rel=1e-6)]


# In each of two strata of 2 the one of the group is the larger: excess 0.5, variance 1 / 4, weight
# 1 / 3. Sum 1 / 3, half a step 1 / 6; deviation sqrt(2 / 36) = 0.2357: z = 0.7071.
# Without strata it would be 1, 2, 11, 12 with the group at 2 and 12: the same order says less.
def test_strata_compare_only_their_own():
    rows = [(0, 0, 1.0, 0), (0, 0, 2.0, 1), (0, 1, 11.0, 0), (0, 1, 12.0, 1)]
    found = sums(*rows)
    assert found.chance.tolist() == [pytest.approx(math.erfc(0.5), rel=1e-9)]


def test_what_cannot_be_compared_has_no_chance():
    rows = [(0, 0, 1.0, 0), (0, 1, 2.0, 1), (1, 0, math.nan, 0), (1, 0, 1.0, 1), (2, 0, 1.0, 0)]
    found = sums(*rows, count=4)
    assert np.isnan(found.chance).all()


def test_equal_values_are_no_difference():
    found = sums((0, 0, 1.0, 0), (0, 0, 1.0, 1))
    assert found.chance.tolist() == [1.0]
    assert found.side.tolist() == [0.0]
