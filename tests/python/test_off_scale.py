"""Compared values that are no measurements, such as a time since the epoch, and those that are."""

from __future__ import annotations

import numpy as np
import pytest
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info

from pytpc.base.off_scale import off_scale
from pytpc.diagnosis.suggestion.plausible import Spread, spread_of
from pytpc.diagnosis.suggestion.remedy import remedy
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summary

# `now - last > 3` with `last = Time(0)`: the first compared value is the time since the epoch.
EPOCH = 1_795_763_972.0


# The robot acts at 80 s, as 1,795,763,972 is above 3, and wrongly again at 88 s, with 4 s.
# The climb to 4 ended as the robot acted. Its end is at most three times as far (Goodman): from 0
# that is 3 * 4 = 12 s, from the 5 % lowest False values, 0.1 s, it is 0.1 + 3.9 * 3 = 11.8 s.
def test_a_time_since_the_epoch_decides_no_value():
    rows = [(80, EPOCH), (81, 0.1), (83, 2.0), (84, 2.9), (88, 4.0), (89, 0.1), (90, 1.0)]
    table = events([(t, 0, cmp > 3, cmp, 3) for t, cmp in rows])
    log = Recording("m", table, (Mark(ns(89.5), "I"),), 0, ns(91))
    found = remedy(log, static_info(comparison(0, "cooldown", ">")), "cooldown", log.marks)
    assert (found.value, found.basis) == (11.8, "growth")


# Only the wait since the epoch was too long: no cooldown that anybody would set turns it.
def test_nobody_waits_since_the_epoch():
    rows = [(79, 0.5), (80, EPOCH), (81, EPOCH), (82, EPOCH + 1)]
    table = events([(t, 0, cmp > 3, cmp, 3) for t, cmp in rows])
    log = Recording("m", table, (Mark(ns(83), "I"),), 0, ns(83))
    found = remedy(log, static_info(comparison(0, "cooldown", ">")), "cooldown", log.marks)
    assert (found.value, found.direction) == (None, None)
    assert found.reason is not None
    assert found.reason.startswith(
        "only a value over a million times the present one would have prevented it: "
    )


def off(values, *thresholds):
    return off_scale(np.array(values, dtype=float), np.array(thresholds, dtype=float)).tolist()


# The higher median of 1, 2, 3 and 2e9, without the zeros, is 3; 2e9 is 667 million times that.
def test_what_is_off_the_scale():
    assert off([0, 1, 2, 3, -2e9], 3) == [False] * 4 + [True]
    assert off([0, 0], 3) == [False, False]
    assert off([], 3) == []
    # Where all are as large, they are what is measured.
    assert off([2e9, 2e9 + 1, 0.1], 3) == [False] * 3
    assert off([1e308, 5, 1e308], 3) == [False] * 3
    # The largest double is no distance.
    assert off([1, 1, 1.7976931348623157e308], 3) == [False, False, True]


# The median of the values is 1e-9, and 0.5 is 500 million times that, but nobody measures in 1e-9.
@pytest.mark.parametrize("threshold", [0.3, 1e-9, 0.0, -0.3])
def test_what_is_measured_seldom_beside_noise_is_on_the_scale(threshold):
    assert off([1e-9] * 7 + [0.5] * 3, threshold) == [False] * 10


# 5e6 ticks are 5e15 times the noise, 5 million times 1, and 1.25 times the threshold.
def test_the_threshold_sets_the_scale_of_large_values():
    assert off([1e-9] * 7 + [5e6] * 3, 4e6) == [False] * 10
    assert off([1e-9] * 7 + [5e6] * 3, -4e6) == [False] * 10
    assert off([1e-9] * 7 + [5e6] * 3, 3) == [False] * 7 + [True] * 3


# A tenth of a second, or the time since the epoch: 1.8e9 is 600 million times a threshold of 3, and
# more than a million times 1 where the threshold says nothing.
@pytest.mark.parametrize("threshold", [3.0, 1e-9, 0.0, np.nan, np.inf])
def test_a_time_since_the_epoch_is_off_the_scale_however_often_it_comes(threshold):
    assert off([0.1] * 6 + [EPOCH] * 4, threshold) == [False] * 6 + [True] * 4


# The median of the thresholds 3, 3 and 1e9 is 3: a timeout that was switched off for a while with a
# huge one does not make the time since the epoch a duration.
def test_one_threshold_of_many_sets_no_scale():
    assert off([0.1] * 6 + [EPOCH], 3, 1e9, 3) == [False] * 6 + [True]


# Noise of a standing robot that drives four times, 8 of 10 evaluations: `speed > 0.3`.
NOISE = [1e-9, 2e-9] * 4
DRIVES = [0.4, 0.2]


# Four times it drove 0.4 m/s and slowed down to 0.2 by itself, and at the fifth time somebody
# marked an error of type I. Four peaks of 0.4 end within 3 ** (1/4) = 1.316 times the way from 1e-9
# (Goodman): 0.4 * 1.31607 = 0.52643. The same in ticks of a tenth of a micrometre.
@pytest.mark.parametrize(("unit", "value"), [(1.0, 0.527), (1e7, 5.27e6)])
def test_a_value_to_try_for_a_robot_that_mostly_stands(unit, value):
    cmps = [unit * cmp for cmp in [*(NOISE + DRIVES) * 4, *NOISE, 0.4]]
    table = events([(n / 10, 0, cmp > 0.3 * unit, cmp, 0.3 * unit) for n, cmp in enumerate(cmps)])
    log = Recording("m", table, (Mark(ns(5), "I"),), 0, ns(5))
    found = remedy(log, static_info(comparison(0, "max_speed", ">")), "max_speed", log.marks)
    assert (found.value, found.basis) == (value, "lasting")


# Of 21 values in order, those at 5 % and 95 % are the second and the twentieth: 1e-9 and 0.5.
@pytest.mark.parametrize("threshold", [0.3, 0.0])
def test_the_spread_of_what_a_robot_measures_that_mostly_stands(threshold):
    cmps = [1e-9] * 11 + [0.5] * 10
    table = events([(n, 0, cmp > threshold, cmp, threshold) for n, cmp in enumerate(cmps)])
    log = Recording("m", table, (), 0, ns(30))
    assert spread_of(log, key(0)) == Spread(1e-9, 0.5, 1e-9, 0.5)


# Two evaluations of 1e-9 ticks against 0, and a summary of 1e-9 to 5e6 against 4e6: the differences
# are 1e-9 - 4e6, which is -4e6 as a double, and 1e6. So the values are 1e-9, 1e-9, 0 and 5e6. Of
# the three that are not 0, 5 % and 95 % lie at places 0.1 and 1.9: 1e-9 and nine tenths of 5e6.
def test_the_thresholds_of_summaries_set_the_scale_too():
    counts = (ns(3), ns(4), 9, 1, 9, 0)
    builder = SummaryBuilder()
    builder.add(
        Summary(key(0), "/node", *counts, False, False, 1e-9, 4e6, -4e6, 1e6, 0.0, 2e6, 0.0, 5e6)
    )
    table = events([(1, 0, True, 1e-9, 0.0), (2, 0, True, 1e-9, 0.0)])
    log = Recording("m", table, (), 0, ns(5), summaries=builder.build())
    found = spread_of(log, key(0))
    assert found is not None
    assert (found.small, found.large) == pytest.approx((1e-9, 4.5e6))
