from __future__ import annotations

import math
from dataclasses import dataclass

import pytest

from pytpc.study.case import Verdict
from pytpc.study.judge import place, position
from pytpc.study.metrics import accusations, brier, estimate, merit, reliability, top_share

NAMES = ("~a", "~b", "~c", "~d", "~e")


@dataclass(frozen=True)
class Row:
    treatment: str
    position: float | None
    confidence: float | None = None
    parameters: int = 10
    system: str = "robot"
    tied: int = 1


# b and c share the places 2 and 3; d and e, which are not named, the places 4 and 5.
def test_tied_parameters_have_the_mean_of_their_places():
    verdict = Verdict(("~a", "~b", "~c"), scores=(9.0, 4.0, 4.0))
    assert [place(verdict, name, 5) for name in NAMES] == [
        (1.0, 1),
        (2.5, 2),
        (2.5, 2),
        (4.5, 2),
        (4.5, 2),
    ]


def test_without_scores_only_the_unnamed_are_tied():
    verdict = Verdict(("~b", "~a"))
    assert [place(verdict, name, 5) for name in NAMES] == [
        (2.0, 1),
        (1.0, 1),
        (4.0, 3),
        (4.0, 3),
        (4.0, 3),
    ]
    assert [place(Verdict(()), name, 5) for name in NAMES] == [(3.0, 5)] * 5


def test_a_parameter_is_found_by_any_of_its_names_and_no_other():
    verdict = Verdict(("~b", "~a"))
    assert position(verdict, "/node/a", NAMES) == (2.0, 1)
    assert position(verdict, None, NAMES) is None
    assert position(verdict, "~unknown", NAMES) is None


def test_scores_have_to_fit():
    with pytest.raises(ValueError, match="1 scores for 2 parameters"):
        Verdict(("~a", "~b"), scores=(1.0,))


# Treatment x: places 1 and 3, y: no mark (the middle of ten places is 5.5, and a miss), z: 2.
# Top 1: x 1/2, y 0, z 0: 1/6. Top 3: 1, 0, 1: 2/3. Places: 2, 5.5, 2: 9.5/3.
# Ranks 1 - (place - 1)/10: x (1 + 0.8)/2 = 0.9, y 0.55, z 0.9: 2.35/3.
def test_merit_by_hand():
    found = merit([Row("x", 1.0), Row("x", 3.0), Row("y", None), Row("z", 2.0)])
    assert found.top1.value == pytest.approx(1 / 6)
    assert found.top3.value == pytest.approx(2 / 3)
    assert found.position.value == pytest.approx(9.5 / 3)
    assert found.rank.value == pytest.approx(2.35 / 3)
    assert found.top1.treatments == 3


# Two share 3 and 4, three share 2 to 4, two share 2 and 3; of ten that share all places three are
# among the first three.
@pytest.mark.parametrize(
    ("position", "tied", "first", "three"),
    [(3.5, 2, 0.0, 1 / 2), (3.0, 3, 0.0, 2 / 3), (2.5, 2, 0.0, 1.0), (5.5, 10, 0.1, 0.3)],
)
def test_of_a_tie_the_expected_share_is_among_the_first(position, tied, first, three):
    assert top_share(position, tied, 1) == pytest.approx(first)
    assert top_share(position, tied, 3) == pytest.approx(three)
    found = merit([Row("x", position, tied=tied)])
    assert (found.top1.value, found.top3.value) == pytest.approx((first, three))


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


# (0.1^2 + 0.6^2) / 2.
def test_brier_by_hand():
    assert brier([0.9, 0.6], [True, False]) == pytest.approx(0.185)
    assert math.isnan(brier([], []))


def test_a_mission_without_a_mark_is_no_accusation():
    rows = [Row("clean", None, 0.5), Row("clean", None), Row("fault", None, 0.49)]
    assert accusations(rows).value == pytest.approx(0.25)
    assert accusations(rows, limit=0.4).value == pytest.approx(0.75)
