from __future__ import annotations

import math

import pytest

from pytpc_evaluation.study.case import Verdict
from pytpc_evaluation.study.judge import place, position
from pytpc_evaluation.study.metrics import (
    calibration_error,
    estimate,
    exact_share,
    reliability,
    share,
    upper_limit,
    within,
)

NAMES = ("~a", "~b", "~c", "~d", "~e")


# b and c share the places 2 and 3; d and e, which are not named, the places 4 and 5.
def test_tied_parameters_have_the_mean_of_their_places():
    verdict = Verdict(("~a", "~b", "~c"), scores=(9.0, 4.0, 4.0))
    assert [place(verdict, name, 5) for name in NAMES] == [
        (1.0, 1), (2.5, 2), (2.5, 2), (4.5, 2), (4.5, 2)
    ]  # fmt: skip


def test_without_scores_only_the_unnamed_are_tied():
    verdict = Verdict(("~b", "~a"))
    assert [place(verdict, name, 5) for name in NAMES] == [(2, 1), (1, 1), (4, 3), (4, 3), (4, 3)]
    assert [place(Verdict(()), name, 5) for name in NAMES] == [(3.0, 5)] * 5


def test_a_parameter_is_found_by_any_of_its_names_and_no_other():
    verdict = Verdict(("~b", "~a"))
    assert position(verdict, "/node/a", NAMES) == (2.0, 1)
    assert position(verdict, None, NAMES) is None
    assert position(verdict, "~unknown", NAMES) is None


def test_scores_have_to_fit():
    with pytest.raises(ValueError, match="1 scores for 2 parameters"):
        Verdict(("~a", "~b"), scores=(1.0,))


# Alone at 2 it is there or not. Of three that share the places 2 to 4 (mean 3) each is second with
# 1/3, and among the first three with 2/3. All of five tied (mean 3) is chance: k / 5.
@pytest.mark.parametrize(
    ("mean", "tied", "shares"),
    [
        (2.0, 1, [0, 1, 1, 1, 1]),
        (3.0, 3, [0, 1 / 3, 2 / 3, 1, 1]),
        (3.0, 5, [0.2, 0.4, 0.6, 0.8, 1.0]),
    ],
)
def test_of_tied_parameters_each_is_as_likely_before_the_others(mean, tied, shares):
    assert [within(k, mean, tied) for k in range(1, 6)] == pytest.approx(shares)


# Of two treatments with 0 and 1 a draw has mean 0 or 1 with 1/4 each: both 95 % ends are outside
# of 2.5 %, so the interval is all. Of one value there is nothing to draw.
def test_the_bootstrap_draws_treatments():
    assert estimate([0.0, 0.0, 1.0], ["x", "x", "y"])[:3] == (0.5, 0.0, 1.0)
    assert estimate([0.3, 0.5], ["x", "x"])[:3] == (0.4, 0.4, 0.4)
    nothing = estimate([], [])
    assert math.isnan(nothing.value) and nothing.treatments == 0


# 100 treatments, 50 of them 1: the mean of a draw has a standard deviation of 0.05, so 95 % lie
# within about 0.1 of 0.5.
def test_the_interval_has_the_width_of_the_binomial():
    found = estimate([0.0, 1.0] * 50, list(range(100)))
    assert found.value == 0.5
    assert found.low == pytest.approx(0.402, abs=0.02)
    assert found.high == pytest.approx(0.598, abs=0.02)
    assert found == estimate([0.0, 1.0] * 50, list(range(100)))


# Where nothing was seen in n, a share p leaves it so with (1 - p)^n, which is 0.025 at the end of
# the interval: of 1 at p = 0.975; of 2 at 1 - 0.158; of 6 at 1 - 0.541; of 18 at 1 - 0.815.
@pytest.mark.parametrize(
    ("treatments", "end"), [(1, 0.025), (2, 0.1581), (6, 0.5407), (18, 0.8147)]
)
def test_a_share_of_all_or_nothing_has_an_interval(treatments, end):
    units = [place // 2 for place in range(2 * treatments)]
    every, nothing = share([1.0] * len(units), units), share([0.0] * len(units), units)
    assert (every.value, every.high, every.treatments) == (1.0, 1.0, treatments)
    assert (nothing.value, nothing.low, nothing.treatments) == (0.0, 0.0, treatments)
    assert every.low == pytest.approx(end, abs=5e-5)
    assert nothing.high == pytest.approx(1 - end, abs=5e-5)


# A difference that is 0 in all treatments is no share.
def test_other_shares_and_differences_are_drawn():
    assert share([0.0, 0.0, 1.0], ["x", "x", "y"]) == estimate([0.0, 0.0, 1.0], ["x", "x", "y"])
    assert estimate([0.0, 0.0], ["x", "y"])[:3] == (0.0, 0.0, 0.0)
    assert share([], []).treatments == 0


# 0 of 3: (1 - p)^3 = 0.025. 1 of 2: p^2 = 0.975, for at most one has to be as rare as 0.025. 1 of
# 10 is 0.4450 in the tables of Clopper and Pearson.
@pytest.mark.parametrize(
    ("count", "of", "limit"),
    [(0, 3, 0.70760), (0, 6, 0.45926), (1, 2, 0.98742), (1, 10, 0.44502), (2, 2, 1.0)],
)
def test_what_cannot_be_ruled_out(count, of, limit):
    assert upper_limit(count, of) == pytest.approx(limit, abs=5e-6)


def test_reliability_by_hand():
    found = reliability(
        [0.05, 0.15, 0.95, 1.0, 0.9], [False, True, True, True, False], ["a", "a", "a", "b", "c"]
    )
    assert [(round(b.low, 9), round(b.high, 9), b.verdicts, b.treatments) for b in found] == [
        (0.0, 0.2, 2, 1),
        (0.8, 1.0, 3, 3),
    ]
    assert [b.confidence for b in found] == pytest.approx([0.1, 0.95])
    assert [b.right for b in found] == pytest.approx([0.5, 2 / 3])


# In the bin below 0.2 the confidences are 0.1 too high in sum, in the one from 0.8 on 0.8: 0.9 of
# four verdicts. Of treatment a alone the gaps are 0.1 of two, of b alone 0.8 of two; of both 0.9 of
# four. Each alone is a quarter of the draws, so that they are the ends.
def test_the_error_of_calibration_and_its_interval():
    found = calibration_error([0.05, 0.05, 0.9, 0.9], [0, 0, 1, 0], ["a", "a", "b", "b"])
    assert found == pytest.approx((0.9 / 4, 0.05, 0.4, 2))
    assert calibration_error([], [], []).treatments == 0


# In one bin too much here and too little there make up for each other, in two they do not.
def test_the_error_of_calibration_is_that_of_bins():
    assert calibration_error([0.5, 0.5], [0, 1], "ab").value == 0.0
    assert calibration_error([0.3, 0.7], [1, 0], "ab").value == pytest.approx(0.7)


# Of 10 treatments 9.5 are right: between 9 of 10 (0.555, 0.997) and 10 of 10 (0.692, 1).
def test_an_exact_share_lies_between_whole_numbers():
    whole = exact_share([1.0] * 9 + [0.0], list(range(10)))
    assert (whole.low, whole.high) == pytest.approx((0.555, 0.997), abs=0.001)
    every = exact_share([1.0] * 10, list(range(10)))
    assert (every.low, every.high) == pytest.approx((0.692, 1.0), abs=0.001)
    # The last treatment has two missions.
    between = exact_share([1.0] * 10 + [0.0], [*range(10), 9])
    assert between.value == pytest.approx(0.95)
    assert whole.low < between.low < every.low
    assert whole.high < between.high < every.high
    assert exact_share([0.0] * 10, list(range(10))).high == pytest.approx(1 - every.low)
