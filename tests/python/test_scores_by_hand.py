"""The scores worked by hand, from scores to rankings: to be read from top to bottom.

A robot has five comparisons of four parameters. Each test has a log of rows (seconds, comparison,
result, cmp, thresh[, node]) and above it the arithmetic. S1 and S2 are the scores of types I and
II; NONE is 9999.9.

    comparison  parameter  condition             distance
    0           limit      value > limit         1
    1           limit      other > limit         3
    2           speed      value > speed         2
    3           wait       age > wait            4
    4           never      value > never         4   (not in any log)
"""

from __future__ import annotations

import math

import pytest
from mission_samples import comparison, events, ns, static_info

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.scores.score_tables import Tpcs, parameter_tables, rank_curves, tpc_scores
from pytpc.diagnosis.scores.scores import NONE
from pytpc.diagnosis.scores.summary_scores import LogTables
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries

ROBOT = static_info(
    comparison(0, "limit", distance=1),
    comparison(1, "limit", distance=3),
    comparison(2, "speed", distance=2),
    comparison(3, "wait", distance=4),
    comparison(4, "never", distance=4),
)
TPCS = Tpcs.of(ROBOT)
NAN, INF = math.nan, math.inf


def scores(rows, *seconds, window_s=12.0):
    """S1 and S2 of all five comparisons at each time."""
    table = events(rows).with_keys(TPCS.keys)
    marks = [ns(second) for second in seconds]
    return tpc_scores(TPCS, LogTables(table, Summaries.empty()), marks, window_s)


def of(found, number):
    """S1 and S2 of one comparison at each time."""
    return found.first[:, number].tolist(), found.second[:, number].tolist()


def ranking(rows, seconds, kind=None, **options):
    mark = Mark(ns(seconds), kind)
    mission = Recording("m", events(rows), (mark,), 0, ns(100))
    (found,) = rank_marks(mission, ROBOT, Question(**options))
    return found


# ---- One comparison -----------------------------------------------------------------------------

# Results F T F at 10, 20, 24 s: flops at 20 and 24 s.
#   S1 at 22 s: last flop 2 s ago, one so far:   2 * (1 + 1) = 4
#   S1 at 30 s: last flop 6 s ago, two so far:   6 * (1 + 2) = 18
# cmp - thresh: 1-4 = -3, 6-4 = 2, 3-4 = -1. All values up to 22 s: 1, 4, 6 -> max - min = 5; the
# value 3 changes nothing.
#   S2 at 22 s: window [10, 22] has 10 and 20 s: mean (3 + 2) / 2 = 2.5; D = 2.5 / 5 = 0.5;
#               one flop in it: 0.5 * max(1, 1) = 0.5
#   S2 at 30 s: window [18, 30] has 20 and 24 s: mean (2 + 1) / 2 = 1.5; D = 0.3; two flops: 0.6
ONE = [(10, 0, 0, 1, 4), (20, 0, 1, 6, 4), (24, 0, 0, 3, 4)]


def test_both_scores():
    first, second = of(scores(ONE, 22, 30), 0)
    assert first == [4.0, 18.0]
    assert second == pytest.approx([0.5, 0.6], rel=1e-15)


# An evaluation at the very time of the mark counts, and one at the very begin of the window, too.
#   S1 at 24 s: the flop is 0 s ago: 0 * (1 + 2) = 0, the most suspicious of all.
#   S2 at 32 s, w = 12: window [20, 32] has 20 and 24 s, as at 30 s: 0.6
#   S2 at 32.001 s: only 24 s: D = 1 / 5, one flop: 0.2
def test_both_ends_of_the_window_belong_to_it():
    first, second = of(scores(ONE, 24, 32, 32.001), 0)
    assert first[0] == 0.0
    assert second[1:] == pytest.approx([0.6, 0.2], rel=1e-15)


# At 9 s nothing has been evaluated; at 15 s one evaluation has, which cannot be a flop.
#   S2 at 15 s: D = |1 - 4| / (4 - 1) = 1, no flop: 1 * max(1, 0) = 1
#   S2 at 50 s: window [38, 50] is empty; S1 goes on: (50 - 24) * 3 = 78
def test_before_the_first_and_after_the_last():
    first, second = of(scores(ONE, 9, 15, 50), 0)
    assert first == [NONE, NONE, 78.0]
    assert second == [NONE, 1.0, NONE]


def test_no_event_at_all():
    assert of(scores([], 10), 0) == ([NONE], [NONE])
    assert of(scores(ONE, 30), 4) == ([NONE], [NONE])


# Three evaluations at the same time 10 s, F T F in the order in which they came: two flops.
#   S1 at 11 s: 1 * (1 + 2) = 3
#   S2 at 11 s: (1 + 2 + 1) / 3 = 4/3; values 0 .. 3; D = 4/9; two flops: 8/9
def test_equal_times_keep_their_order():
    rows = [(10, 0, 0, 0, 1), (10, 0, 1, 3, 1), (10, 0, 0, 0, 1)]
    first, second = of(scores(rows, 11), 0)
    assert first == [3.0]
    assert second == pytest.approx([8 / 9], rel=1e-15)


# A flag has cmp = thresh: max - min = 0, so there is no D. It may flop all the same:
# at 12 s, 13 - 12 = 1, 1 * (1 + 1) = 2. Then both values have been seen (1 and 0) and D is 0: it is
# at its threshold, always.
def test_a_constant_comparison():
    assert of(scores([(10, 0, 1, 1, 1), (11, 0, 1, 1, 1)], 13), 0) == ([NONE], [NONE])
    rows = [(10, 0, 1, 1, 1), (12, 0, 0, 0, 0)]
    assert of(scores(rows, 13), 0) == ([2.0], [0.0])


# A value that never changes beside a threshold that does not either has a D of 1: as far away as
# it ever was. |5 - 2| / (5 - 2) = 1.
def test_a_value_that_never_changes():
    assert of(scores([(10, 0, 1, 5, 2), (11, 0, 1, 5, 2)], 12), 0) == ([NONE], [1.0])


# NaN and infinite values count for flops (F T F: at 11 and 12 s) and for nothing else.
#   S1 at 13 s: 1 * (1 + 2) = 3
#   S2 at 13 s: only 10 s has numbers: |1 - 4| / (4 - 1) = 1, times two flops: 2
#   All of them such: no S2.
def test_nan_and_infinity():
    rows = [(10, 0, 0, 1, 4), (11, 0, 1, INF, 4), (12, 0, 0, NAN, 4)]
    assert of(scores(rows, 13), 0) == ([3.0], [2.0])
    rows = [(11, 0, 1, INF, 4), (12, 0, 0, 1, NAN), (12.5, 0, 1, -INF, INF)]
    assert of(scores(rows, 13), 0) == ([1.5], [NONE])


# Two nodes run the same code. /a says F T at 10 and 12 s, /b says T T at 11 and 13 s: one flop, at
# 12 s. Taken together it would have been three.
#   S1 at 14 s: 2 * (1 + 1) = 4
#   S2 at 14 s: differences 1, 2, 1, 2, mean 1.5; values 0 .. 3, D = 0.5; one flop: 0.5
def test_two_nodes():
    rows = [
        (10, 0, 0, 0, 1, "/a"),
        (11, 0, 1, 3, 1, "/b"),
        (12, 0, 1, 2, 1, "/a"),
        (13, 0, 1, 3, 1, "/b"),
    ]
    assert of(scores(rows, 14), 0) == ([4.0], [0.5])


# ---- All of them, by parameter ------------------------------------------------------------------

# At 40 s, window [28, 40]:
#   comparison 0 (limit): F at 10, T at 20 s. S1 = (40-20) * (1+1) = 40. No event in the window.
#   comparison 1 (limit): F at 30, T at 35 s. S1 = (40-35) * 2 = 10.
#       S2: |0-2| and |4-2|, mean 2, values 0 .. 4: D = 0.5, one flop: 0.5
#   comparison 2 (speed): T F T at 36, 37, 38 s. S1 = (40-38) * (1+2) = 6.
#       S2: |3-2|, |1-2|, |3-2|, mean 1, values 1 .. 3: D = 0.5, two flops: 1
#   comparison 3 (wait): F F at 39 and 40 s. No flop.
#       S2: |9-10|, |9.5-10|, mean 0.75, values 9 .. 10: D = 0.75
# By parameter, the better of its comparisons:
#   S1: limit 10 (of 1), speed 6, wait none, never none
#   S2: limit 0.5 (of 1), speed 1, wait 0.75, never none
# Four parameters; rank = 1 - (number of better ones)/4, 0 without a score:
#   rank 1: speed 1, limit 0.75, wait 0, never 0
#   rank 2: limit 1, wait 0.75, speed 0.5, never 0
ALL = [
    (10, 0, 0, 1, 4),
    (20, 0, 1, 6, 4),
    (30, 1, 0, 0, 2),
    (35, 1, 1, 4, 2),
    (36, 2, 1, 3, 2),
    (37, 2, 0, 1, 2),
    (38, 2, 1, 3, 2),
    (39, 3, 0, 9, 10),
    (40, 3, 0, 9.5, 10),
]


def test_scores_of_all_comparisons():
    found = scores(ALL, 40)
    assert found.first.tolist() == [[40.0, 10.0, 6.0, NONE, NONE]]
    assert found.second.tolist() == [[NONE, 0.5, 1.0, 0.75, NONE]]


def test_scores_and_ranks_by_parameter():
    first, second = parameter_tables(TPCS, scores(ALL, 40))
    assert first.names == second.names == ("limit", "never", "speed", "wait")
    assert first.scores.tolist() == [[10.0, NONE, 6.0, NONE]]
    assert first.ranks.tolist() == [[0.75, 0.0, 1.0, 0.0]]
    assert second.scores.tolist() == [[0.5, NONE, 1.0, 0.75]]
    assert second.ranks.tolist() == [[1.0, 0.0, 0.5, 0.75]]
    assert (first.best[0, 0], second.best[0, 0]) == (1, 1)


# The same on a grid of 10 s: the last row is that of 40 s, and the first that of 0 s is empty.
def test_curves():
    mission = Recording("m", events(ALL), (), 0, ns(40))
    curves = rank_curves(mission, ROBOT, step_s=10)
    assert curves.times_ns.tolist() == [0, ns(10), ns(20), ns(30), ns(40)]
    assert curves.parameters == ("limit", "never", "speed", "wait")
    assert curves.score1[4].tolist() == [10.0, NONE, 6.0, NONE]
    assert curves.rank2[4].tolist() == [1.0, 0.0, 0.5, 0.75]
    assert curves.combined[4].tolist() == [1.0, 0.0, 1.0, 0.75]
    assert curves.score2[0].tolist() == [NONE] * 4
    assert curves.rank1[0].tolist() == [0.0] * 4


# ---- Rankings -----------------------------------------------------------------------------------


def test_a_type_that_is_believed():
    found = ranking(ALL, 40, "I")
    assert [(s.position, s.parameter, s.score) for s in found.suspects] == [
        (1, "speed", 6.0),
        (2, "limit", 10.0),
    ]
    assert (found.parameters, found.enough, found.reason) == (4, True, "")
    found = ranking(ALL, 40, "II")
    assert [(s.position, s.parameter, s.score) for s in found.suspects] == [
        (1, "limit", 0.5),
        (2, "wait", 0.75),
        (3, "speed", 1.0),
    ]


# Ignored: the better rank, then the sum of both.
#   limit max(0.75, 1) = 1, sum 1.75; speed max(1, 0.5) = 1, sum 1.5; wait max(0, 0.75) = 0.75
def test_a_type_that_is_ignored():
    for kind in ("I", "II", None):
        found = ranking(ALL, 40, kind, types="ignore")
        assert [(s.position, s.parameter, s.rank, s.type) for s in found.suspects] == [
            (1, "limit", 1.0, "II"),
            (2, "speed", 1.0, "I"),
            (3, "wait", 0.75, "II"),
        ]
        assert [(s.rank1, s.rank2) for s in found.suspects] == [(0.75, 1), (1, 0.5), (0, 0.75)]


# Doubted. By table 6.13 a mark of type I comes from type II with 26/51 / (26/51 + 2/17)
# = 26 / (26 + 6) = 0.8125, one of type II from type I with 15/17 / (15/17 + 25/51)
# = 45 / (45 + 25) = 9/14.
#   Type I:  speed max(1, 0.8125 * 0.5) = 1; limit max(0.75, 0.8125 * 1) = 0.8125 (of type II);
#            wait max(0, 0.8125 * 0.75) = 0.609375
#   Type II: limit max(1, 9/14 * 0.75) = 1; wait max(0.75, 0) = 0.75;
#            speed max(0.5, 9/14 * 1) = 9/14 (of type I)
def test_a_type_that_is_doubted():
    found = ranking(ALL, 40, "I", types="doubt")
    assert [(s.parameter, s.rank, s.type, s.score) for s in found.suspects] == [
        ("speed", 1.0, "I", 6.0),
        ("limit", 0.8125, "II", 0.5),
        ("wait", 0.609375, "II", 0.75),
    ]
    found = ranking(ALL, 40, "II", types="doubt")
    assert [(s.parameter, s.rank, s.type) for s in found.suspects] == [
        ("limit", 1.0, "II"),
        ("wait", 0.75, "II"),
        ("speed", 9 / 14, "I"),
    ]
    # Without a type there is nothing to doubt.
    assert ranking(ALL, 40, types="doubt") == ranking(ALL, 40, types="ignore")


# speed and wait both flop once, at 35 s: S1 = 5 * 2 = 10 for both; limit at 38 s: 2 * 2 = 4.
# Behind the first, both are second and share rank 1 - 1/4; the next would be fourth. speed is
# listed first: it is nearer to what is exposed (2 < 4).
def test_ties_are_shown_as_ties():
    rows = [
        (30, 2, 0, 1, 2),
        (35, 2, 1, 3, 2),
        (30, 3, 0, 1, 2),
        (35, 3, 1, 3, 2),
        (37, 0, 0, 1, 2),
        (38, 0, 1, 3, 2),
        (20, 4, 0, 1, 2),
        (25, 4, 1, 3, 2),
    ]
    found = ranking(rows, 40, "I")
    assert [(s.position, s.parameter, s.tied, s.rank) for s in found.suspects] == [
        (1, "limit", False, 1.0),
        (2, "speed", True, 0.75),
        (2, "wait", True, 0.75),
        (4, "never", False, 0.25),
    ]
    assert found.enough
    # By both: S2 of speed and wait is 1/2 * 1 flop as well, |1-2| and |3-2| over 3 - 1.
    both = ranking(rows, 40)
    assert [(s.position, s.parameter, s.tied) for s in both.suspects if s.tied] == [
        (2, "speed", True),
        (2, "wait", True),
    ]


# ---- Not enough evidence ------------------------------------------------------------------------


def lacks(found, reason):
    assert (found.enough, found.reason) == (False, reason)


def test_a_mark_before_the_first_report():
    found = ranking(ALL, 7.5, "I")
    assert found.suspects == ()
    lacks(found, "the mark is 2.5 s before the first report")


# The last report is at 40 s. Up to 52 s its window has something; at 52.5 s it has not.
def test_a_mark_after_the_last_report():
    assert ranking(ALL, 52, "I").enough
    found = ranking(ALL, 52.5, "I")
    lacks(found, "the last report up to the mark is 12.5 s before it")
    # What flopped last is still said: (52.5 - 38) * 3 = 43.5 and (52.5 - 35) * 2 = 35.
    assert [(s.parameter, s.score) for s in found.suspects] == [("limit", 35.0), ("speed", 43.5)]


# The same in a gap of the log, from 40 to 70 s.
def test_a_mark_in_a_gap():
    rows = [*ALL, (70, 3, 0, 9, 10)]
    assert ranking(rows, 70, "I").enough
    lacks(ranking(rows, 60, "I"), "the last report up to the mark is 20 s before it")


def test_a_mark_on_another_clock():
    found = ranking(ALL, 1_790_000_000, "I")
    lacks(found, "the mark is on another clock than the reports")
    early = [(1_790_000_000 + t, *row) for t, *row in ALL]
    lacks(ranking(early, 40), "the mark is on another clock than the reports")


def test_no_report_and_no_comparison():
    lacks(ranking([], 40), "no comparison was reported")
    mission = Recording("m", events(ALL), (Mark(ns(40), "I"),), 0, ns(100))
    (found,) = rank_marks(mission, static_info(comparison(0, "x", type="constant")))
    lacks(found, "the static information has no comparison with a parameter")


# At 40 s only wait has been evaluated, twice, without a flop. With comparison 0 there are two.
def test_too_few_parameters():
    rows = [(39, 3, 0, 9, 10), (40, 3, 0, 9.5, 10), (50, 0, 1, 1, 0)]
    found = ranking(rows, 40, "II")
    assert [s.parameter for s in found.suspects] == ["wait"]
    lacks(found, "only wait had been compared up to the mark")
    assert ranking(rows, 50, "II").enough


def test_nobody_has_a_score():
    rows = [(39, 3, 0, 9, 10), (39, 2, 0, 2, 2)]
    lacks(ranking(rows, 40, "I"), "no result had changed up to the mark")
    rows = [(1, 3, 0, 9, 10), (39, 2, 0, 2, 2)]
    why = "nothing that ever had two different values was compared in the 12 s before"
    lacks(ranking(rows, 40, "II"), f"{why} the mark")
    both = f"no result had changed up to the mark, and {why} it"
    lacks(ranking(rows, 40), both)
    lacks(ranking(rows, 40, "I", types="doubt"), both)


# Both flopped once, at 35 s.
def test_all_scores_are_equal():
    rows = [(30, 2, 0, 1, 2), (35, 2, 1, 3, 2), (30, 3, 0, 1, 2), (35, 3, 1, 3, 2)]
    found = ranking(rows, 40, "I")
    assert [s.position for s in found.suspects] == [1, 1]
    lacks(found, "all 2 parameters with a score have the same one")
