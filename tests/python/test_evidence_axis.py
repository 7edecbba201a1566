"""The axis of the evidence chart: what it shows, and what lies beyond it."""

from __future__ import annotations

import numpy as np
import pytest

from pytpc.present.page.plots import EvidenceStyle, beyond_text, times_beyond, value_span
from pytpc.present.page.series import PlotData

STYLE = EvidenceStyle(mark=0.0, mark_type="I", window=None, suggested=None, culprit=False)
EPOCH = 1_795_763_972.0


def drawn(values, threshold, kept=((), ())):
    """Evaluations at 0, 1, 2... s, and summaries at 0 s, by their lowest and highest values."""
    time, nothing = np.arange(len(values), dtype=float), np.zeros(0)
    low, high = (np.array(one, dtype=float) for one in kept)
    return PlotData(
        time=time,
        cmp=np.array(values, dtype=float),
        thresh=np.full(time.size, float(threshold)),
        steps=nothing,
        outcome=np.zeros(0, dtype=np.bool_),
        ends=0.0,
        flops=nothing,
        evaluations=time.size,
        begin=0.0,
        end=float(time.size),
        kept=np.stack([np.zeros(low.size), np.zeros(low.size), low, high]),
        kept_results=np.zeros((4, 0)),
    )


def shows(data, low, high):
    """Whether the axis is for low to high: 0.08 of the way more at both ends, 0.16 above."""
    way = high - low
    return value_span(data, STYLE)[:2] == pytest.approx((low - 0.08 * way, high + 0.24 * way))


# At least a fifth of the values are 60 times the threshold. They are the robot in motion, and the
# axis shows them.
@pytest.mark.parametrize(
    ("rest", "motion", "level", "threshold"),
    [(80, 20, 6.0, 0.1), (800, 200, 6.0, 0.1), (79, 21, 300.0, 5.0), (800, 200, -6.0, -0.1)],
)
def test_a_signal_with_two_levels_sets_the_axis(rest, motion, level, threshold):
    data = drawn([0.0] * rest + [level] * motion, threshold)
    assert shows(data, min(0.0, level), max(0.0, level))
    assert beyond_text(data, STYLE) == ""


# Of 200 values, 2 % are 4. The threshold is 3, and 5000 is 2500 times the way from 1 to 3.
def test_one_in_fifty_values_may_lie_beyond_the_axis():
    few = drawn([1.0, 2.0] * 98 + [5000.0] * 4, 3)
    assert shows(few, 1, 3)
    assert beyond_text(few, STYLE) == "compared values beyond this plot, up to 5000"
    assert [one.tolist() for one in times_beyond(few, STYLE)] == [[], [196, 197, 198, 199]]
    more = drawn([1.0, 2.0] * 97 + [1.0] + [5000.0] * 5, 3)
    assert shows(more, 1, 5000)
    assert beyond_text(more, STYLE) == ""


# They may lie on both sides, and be 2 % together, not at each end.
def test_values_beyond_both_ends_of_the_axis_are_few_together():
    few = drawn([1.0, 2.0] * 98 + [-900.0, 5000.0] * 2, 3)
    assert shows(few, 1, 3)
    assert beyond_text(few, STYLE) == (
        "compared values beyond this plot, down to -900 and up to 5000"
    )
    assert shows(drawn([1.0, 2.0] * 97 + [-900.0, 5000.0] * 3, 3), -900, 5000)


# Two of a short series are few, but not half of it: one of four, and none of two.
@pytest.mark.parametrize(
    ("values", "high"),
    [
        ([1, 2, 1, 2] * 3 + [500, 500], 3),
        ([1, 2, 1, 2] * 3 + [500, 500, 500], 500),
        ([1, 2, 1, 500, 500], 3),
        ([1, 2, 1, 500], 3),
        ([1, 2, 500, 500], 500),
        ([1, 1, 500, 50_000], 500),
        ([1, 500], 500),
    ],
)
def test_one_or_two_of_a_short_series_may_lie_beyond_the_axis(values, high):
    assert shows(drawn(values, 3), 1, high)


# 1.8e9 is 600 million times the threshold of 3: off the scale, though it is 30 % of the values.
def test_a_time_since_the_epoch_flattens_nothing_however_often_it_comes():
    data = drawn([EPOCH] * 30 + [1.0, 2.0] * 35, 3)
    assert shows(data, 1, 3)
    assert beyond_text(data, STYLE) == "compared values beyond this plot, up to 1795763972"


# Beside noise of 1e-9 in 70 % of the time, 0.5 m/s is no time since the epoch. The threshold is 0.
def test_a_motion_beside_noise_sets_the_axis():
    assert shows(drawn([1e-9] * 70 + [0.5] * 30, 0), 0, 0.5)


# What is few, but not far, is shown: 8 lies within ten times the 2 from 1 to the threshold.
def test_a_few_values_nearby_are_shown_beside_an_outlier():
    data = drawn([1.0, 2.0] * 99 + [8.0, 5000.0], 3)
    assert shows(data, 1, 8)
    assert beyond_text(data, STYLE) == "compared values beyond this plot, up to 5000"


# The highest values of 20 of 100 summaries are 6: 20 of 200 ends are a tenth.
def test_the_ends_of_summaries_set_the_axis_too():
    data = drawn([], 0.1, kept=([0.0] * 100, [0.0] * 80 + [6.0] * 20))
    assert shows(data, 0, 6)
