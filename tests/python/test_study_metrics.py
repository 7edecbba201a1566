from __future__ import annotations

import math

import pytest

from pytpc.study.case import Verdict
from pytpc.study.judge import place, position
from pytpc.study.metrics import estimate, reliability, within

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


def test_reliability_by_hand():
    found = reliability([0.05, 0.15, 0.95, 1.0, 0.9], [False, True, True, True, False])
    assert [(round(b.low, 9), round(b.high, 9), b.verdicts) for b in found] == [
        (0.0, 0.2, 2),
        (0.8, 1.0, 3),
    ]
    assert [b.confidence for b in found] == pytest.approx([0.1, 0.95])
    assert [b.right for b in found] == pytest.approx([0.5, 2 / 3])
