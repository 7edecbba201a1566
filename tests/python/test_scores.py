"""The scores by hand, and against a slow implementation of docs/reference/scores.md."""

from __future__ import annotations

import math
import time
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_samples import events, key, ns

from pytpc.diagnosis.scores.scores import NONE, Formula, by_parameter, combined, ranks, type1, type2
from pytpc.recording.events import Events

NAN, INF = math.nan, math.inf


# Results F T T F T at 1, 2, 3, 4, 6 s: flops at 2, 4 and 6 s.
#   m = 1.5: no flop yet                                  -> none
#   m = 5:   last flop at 4, two flops: (5-4) * (1+2)      = 3
#   m = 6:   the flop at 6 counts, its age is 0            = 0
#   m = 10:  (10-6) * (1+3)                                = 16
def test_type1_by_hand():
    table = events(
        [(1, 0, 0, 0, 1), (2, 0, 1, 2, 1), (3, 0, 1, 2, 1), (4, 0, 0, 0, 1), (6, 0, 1, 2, 1)]
    )
    scores = type1(table, [ns(m) for m in (1.5, 5, 6, 10)], [4])
    assert scores[:, 0].tolist() == [NONE, 3.0, 0.0, 16.0]


# At m = 10 as above: (10-6)^2 * (1+3)^0.5 * 4^1 = 16 * 2 * 4 = 128.
def test_type1_exponents_by_hand():
    table = events(
        [(1, 0, 0, 0, 1), (2, 0, 1, 2, 1), (3, 0, 1, 2, 1), (4, 0, 0, 0, 1), (6, 0, 1, 2, 1)]
    )
    scores = type1(table, [ns(10)], [4], Formula(alpha=2, beta=0.5, gamma=1))
    assert scores.tolist() == [[128.0]]


# Two nodes run the same code, one always True and one always False: taken together the results
# alternate, but neither has changed its mind.
def test_nodes_do_not_flop_each_other():
    table = events([(n, 0, n % 2, 1, 0, f"/node{n % 2}") for n in range(6)])
    assert type1(table, [ns(9)], [1]).tolist() == [[NONE]]


# Evaluations (s, cmp, thresh): (0, 10, 4) (5, 6, 4) (8, 5, 4) (20, 4.5, 4); always True, no flop.
#   m = 20, w = 12:   window [8, 20] holds 8: differences 1 and 0.5, mean 0.75; max 10, min 4
#                     -> 0.75 / 6                          = 0.125
#   m = 20, w = 11.9: 0.5 / 6                              = 1/12
#   m = 8,  w = 12:   (6 + 2 + 1) / 3 / 6                  = 0.5
#   m = 33, w = 12:   nothing in [21, 33]                  -> none
def test_type2_by_hand():
    table = events([(0, 0, 1, 10, 4), (5, 0, 1, 6, 4), (8, 0, 1, 5, 4), (20, 0, 1, 4.5, 4)])
    assert type2(table, [ns(20)], [1])[0, 0] == pytest.approx(0.125, rel=1e-12)
    assert type2(table, [ns(20)], [1], Formula(window_s=11.9))[0, 0] == pytest.approx(
        1 / 12, rel=1e-12
    )
    assert type2(table, [ns(8), ns(33)], [1])[:, 0].tolist() == [0.5, NONE]


# (0, cmp 1) (1, cmp 3) (2, cmp 1), threshold 2: at m = 1 max 3 and min 1, so D = 1 / 2. The value 9
# at 5 s lies after the mark and must not widen the span.
def test_type2_knows_nothing_of_the_future():
    table = events([(0, 0, 0, 1, 2), (1, 0, 1, 3, 2), (2, 0, 0, 1, 2), (5, 0, 1, 9, 2)])
    assert type2(table, [ns(1)], [1], Formula(beta=0)).tolist() == [[0.5]]


# Results F T F T at 1, 2, 3, 4 s; threshold 0; cmp 1, 1, 0.00005, 2.
#   m = 4, w = 2: window [2, 4]. The flops at 2, 3 and 4 belong to it, also the one at 2 whose
#   earlier evaluation is outside: 3. Differences 1, 0.00005, 2: n = 2 of them above 1e-4, mean
#   3.00005/3; max 2, min 0. D = 1.000016667/2 = 0.500008333.
#   beta = 1, gamma = 2, delta = 1, d = 3, d_max = 6: D * 3 * 2^2 * (3/6) = 6 D = 3.00005
def test_type2_exponents_by_hand():
    table = events(
        [
            (1, 0, 0, 1, 0),
            (2, 0, 1, 1, 0),
            (3, 0, 0, 0.00005, 0),
            (4, 0, 1, 2, 0),
            (4, 1, 1, 2, 0),
        ]
    )
    scores = type2(table, [ns(4)], [3, 6], Formula(window_s=2, beta=1, gamma=2, delta=1))
    assert scores[0, 0] == pytest.approx(3.00005, rel=1e-12)


# A flag has cmp = thresh = its value: max = min, so there is no D.
def test_type2_needs_two_values():
    table = events([(0, 0, 1, 1, 1), (1, 0, 1, 1, 1)])
    assert type2(table, [ns(1)], [1]).tolist() == [[NONE]]


# NaN and infinity at 1, 2 and 3 s count for the flops (F T F T F: four of them by 4 s) but not for
# D: (0, cmp 1) and (4, cmp 2) against 0: (1 + 2) / 2 / (2 - 0) = 0.75, times 4 flops = 3.
def test_values_that_are_no_numbers():
    table = events(
        [(0, 0, 0, 1, 0), (1, 0, 1, NAN, 0), (2, 0, 0, INF, 0), (3, 0, 1, 1, -INF), (4, 0, 0, 2, 0)]
    )
    assert type2(table, [ns(4)], [1]).tolist() == [[3.0]]
    assert type1(table, [ns(5)], [1]).tolist() == [[5.0]]
    # Only such values in the window [1, 3]: no D, whatever was there before.
    assert type2(table, [ns(3)], [1], Formula(window_s=2)).tolist() == [[NONE]]


# After 1e16 a window of differences 1 and 3 has mean 2; 2 / (1e16 - 0). A difference of prefix sums
# would see 1e16 + 1 + 3 - 1e16 = 4 or 2, depending on rounding of odd numbers above 2^53.
def test_small_window_after_large_values():
    table = events([(0, 0, 1, 1e16, 0), (100, 0, 1, 1, 0), (101, 0, 1, 3, 0)])
    assert type2(table, [ns(101)], [1])[0, 0] == pytest.approx(2e-16, rel=1e-12)


# |1e308 - -1e308| is beyond a double, and so is max - min; their ratio is 1.
def test_largest_doubles():
    table = events([(0, 0, 1, 1e308, -1e308), (1, 0, 1, 1e308, -1e308)])
    assert type2(table, [ns(1)], [1]).tolist() == [[1.0]]


# At 0 s the smallest double against 0: their difference is all of max - min, so D is 1. The largest
# double comes later and must not make that difference vanish.
def test_smallest_double_before_the_largest():
    table = events([(0, 0, 1, 5e-324, 0), (1, 0, 1, 1e308, 0)])
    assert type2(table, [0], [1]).tolist() == [[1.0]]


# Scores 5, none, 1, 5 of n = 4. Smaller than 1 is none: 1 - 0/4. Smaller than either 5 is the 1
# alone: 1 - 1/4 for both. Then 7 of [7, 5, 1, 5] has three that are smaller: 1 - 3/4.
def test_ranks_by_hand():
    scores = np.array([[5.0, NONE, 1.0, 5.0], [5.0, 7.0, 1.0, 5.0]])
    assert ranks(scores).tolist() == [[0.75, 0.0, 1.0, 0.75], [0.75, 0.25, 1.0, 0.75]]


# A flop 1,000,000 s ago has a score far above 9999.9. It is a score all the same: before "none".
def test_scores_above_none_are_scores():
    scores = np.array([[NONE, 1e6]])
    assert ranks(scores).tolist() == [[0.0, 1.0]]


# One flop 4999.95 s ago: 4999.95 * 2 = 9999.9, the number that means none.
def test_a_score_of_9999_9_is_not_none():
    table = events([(0, 0, 0, 0, 1), (1, 0, 1, 2, 1)])
    scores = type1(table, [ns(5000.95)], [1])
    assert scores[0, 0] == pytest.approx(NONE)
    assert ranks(scores).tolist() == [[1.0]]


# Parameters p (columns 0, 2) and q (1, 3). First mark: p has 7 and 3, best 3 of column 2; q has
# none and 4. Second mark: p has none at all, q has 2 and 2, of which column 3 is nearer.
def test_by_parameter_by_hand():
    scores = np.array([[7.0, NONE, 3.0, 4.0], [NONE, 2.0, NONE, 2.0]])
    found = by_parameter(scores, ["p", "q", "p", "q"], [1, 2, 1, 1], "abcd")
    assert found.names == ("p", "q")
    assert found.scores.tolist() == [[3.0, 4.0], [NONE, 2.0]]
    assert found.best[:, 1].tolist() == [3, 3]
    assert int(found.best[0, 0]) == 2


# The better of 1 and 0.5, 0.5 and 1, 0 and 0, 0.5 and 0. With half a weight the second 1 is 0.5.
def test_combined_by_hand():
    first = np.array([[1.0, 0.5, 0.0, 0.5]])
    second = np.array([[0.5, 1.0, 0.0, 0.0]])
    assert combined(first, second).tolist() == [[1.0, 1.0, 0.0, 0.5]]
    assert combined(second, first, 0.5).tolist() == [[0.5, 1.0, 0.0, 0.25]]


def test_wrong_arguments():
    table = events([(0, 0, 1, 1, 1)])
    with pytest.raises(ValueError, match="one distance for each key"):
        type1(table, [0], [1, 2])
    with pytest.raises(ValueError, match="alpha is negative"):
        type1(table, [0], [1], Formula(alpha=-1))
    with pytest.raises(ValueError, match="window_s is negative"):
        type2(table, [0], [1], Formula(window_s=-1))


def test_nothing_to_score():
    nothing = Events.empty([key(0)])
    assert type1(nothing, [5], [1]).tolist() == [[NONE]]
    assert type2(nothing, [5], [1]).tolist() == [[NONE]]
    assert type1(Events.empty(), [5], []).shape == (1, 0)
    assert ranks(np.empty((0, 3))).shape == (0, 3)


VALUES = st.one_of(
    st.sampled_from([NAN, INF, -INF, 0.0, 1e16, -1e16, 1e308, -1e308, 5e-324]),
    st.floats(-1e3, 1e3),
)
ROWS = st.lists(
    st.tuples(
        st.integers(0, 40),
        st.integers(0, 2),
        st.booleans(),
        VALUES,
        VALUES,
        st.sampled_from(["/a", "/b"]),
    ),
    max_size=40,
)


def slow_flops(rows, number):
    """Times of the flops of one key: for each node, neighbours with different results."""
    times = []
    for node in ("/a", "/b"):
        mine = [row for row in rows if row[1] == number and row[5] == node]
        times += [b[0] for a, b in pairwise(mine) if a[2] != b[2]]
    return times


def slow_type1(rows, number, m, distance):
    flops = [t for t in slow_flops(rows, number) if t <= m]
    if not flops:
        return NONE
    return (m - max(flops)) * (1 + len(flops)) * distance**0.5


def slow_type2(rows, number, m, w, nearness):
    mine = [
        row
        for row in rows
        if row[1] == number and row[0] <= m and math.isfinite(row[3]) and math.isfinite(row[4])
    ]
    window = [(cmp, thresh) for t, _, _, cmp, thresh, _ in mine if t >= m - w]
    values = [value for row in mine for value in row[3:5]]
    if not window or max(values) == min(values):
        return NONE
    # Fractions: no rounding, and no number is too large.
    spread = Fraction(max(values)) - Fraction(min(values))
    differences = [abs(Fraction(cmp) - Fraction(thresh)) for cmp, thresh in window]
    flops = [t for t in slow_flops(rows, number) if m - w <= t <= m]
    # A difference of doubles, as a reader of the page would write it.
    unequal = sum(abs(cmp - thresh) > 1e-4 for cmp, thresh in window)
    mean = sum(differences) / spread / len(window)
    return float(mean * max(1, len(flops)) * unequal * Fraction(nearness) ** 2)


@settings(max_examples=300, deadline=None)
@given(ROWS, st.lists(st.integers(-3, 45), min_size=1, max_size=5), st.integers(0, 20))
def test_against_the_slow_way(rows, marks, window):
    rows = sorted(rows, key=lambda row: row[0])
    table = events(rows).with_keys([key(0), key(1), key(2)])
    distance = [1, 2, 5]
    first = type1(table, [ns(m) for m in marks], distance, Formula(gamma=0.5))
    second = type2(
        table, [ns(m) for m in marks], distance, Formula(window_s=window, gamma=1, delta=2)
    )
    for row, m in enumerate(marks):
        for code in range(3):
            slow1 = slow_type1(rows, code, m, distance[code])
            slow2 = slow_type2(rows, code, m, window, distance[code] / 5)
            assert first[row, code] == pytest.approx(slow1, rel=1e-9, abs=0)
            # Below the normal doubles there are not nine digits to compare.
            assert second[row, code] == pytest.approx(slow2, rel=1e-9, abs=1e-300)


# A million reports on a 10 Hz grid over 1000 s take 0.5 s on one core of the machine that this was
# written on; the bound is wide, for a quadratic slip would take minutes.
def test_a_million_reports_are_fast():
    random = np.random.default_rng(1)
    n = 1_000_000
    table = Events.of(
        time_ns=random.integers(0, ns(1000), n),
        key=random.integers(0, 60, n),
        result=random.random(n) < 0.5,
        cmp=random.normal(size=n),
        thresh=np.zeros(n),
        res=np.ones(n, bool),
        node=np.zeros(n, int),
        keys=[key(i) for i in range(60)],
        nodes=["/node"],
    )
    grid = np.arange(0, ns(1000), ns(0.1))
    started = time.process_time()
    type1(table, grid, np.ones(60))
    type2(table, grid, np.ones(60))
    assert time.process_time() - started < 5
