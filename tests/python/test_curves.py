"""Curves over a mission: what `rank_marks` says at the same times, at the cost of all at once."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_samples import comparison, events, ns, static_info

from pytpc.base.errors import TpcError
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.scores.score_tables import rank_curves
from pytpc.diagnosis.scores.scores import NONE
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording

STATIC = static_info(
    comparison(0, "coverage", distance=1),
    comparison(1, "coverage", distance=2),
    comparison(2, "faces", distance=5),
    comparison(3, "fixed", type="constant"),
)
ROWS = st.lists(
    st.tuples(
        st.integers(0, 40),
        st.integers(0, 3),
        st.booleans(),
        st.sampled_from([0.0, 0.25, 1.0, 7.0]),
        st.sampled_from([0.0, 1.0]),
    ),
    max_size=40,
)


@settings(max_examples=100, deadline=None)
@given(ROWS)
def test_curves_are_the_rankings_at_their_times(rows):
    table = events(rows)
    curves = rank_curves(
        Recording("m", table, (), 0, ns(20)), STATIC, Question(window_s=5), step_s=2.5
    )
    marks = [Mark(int(time), kind) for time in curves.times_ns for kind in ("I", "II", None)]
    mission = Recording("m", table, tuple(marks), 0, ns(20))
    rankings = iter(rank_marks(mission, STATIC, Question(window_s=5)))
    assert curves.parameters == ("coverage", "faces")
    assert curves.times_ns.tolist() == [ns(2.5 * step) for step in range(9)]
    for row in range(9):
        tables = (curves.score1, curves.rank1), (curves.score2, curves.rank2)
        for scores, ranks in tables:
            found = {s.parameter: (s.score, s.rank) for s in next(rankings).suspects}
            for column, name in enumerate(curves.parameters):
                pair = float(scores[row, column]), float(ranks[row, column])
                assert pair == found.get(name, (NONE, 0.0))
        both = {s.parameter: s.rank for s in next(rankings).suspects}
        expected = [both.get(name, 0.0) for name in curves.parameters]
        assert curves.combined[row].tolist() == expected


# From 3 s to 4 s in steps of 0.3 s: 3, 3.3, 3.6, 3.9. One instant is one step.
def test_the_grid():
    mission = Recording("m", events([]), (), ns(3), ns(4))
    times = rank_curves(mission, STATIC, step_s=0.3).times_ns
    assert times.tolist() == [ns(3), ns(3.3), ns(3.6), ns(3.9)]
    instant = Recording("m", events([]), (), ns(3), ns(3))
    assert rank_curves(instant, STATIC).times_ns.tolist() == [ns(3)]
    assert rank_curves(instant, static_info()).rank1.shape == (1, 0)


def test_grids_that_cannot_be():
    decades = Recording("sim and wall", events([]), (), 0, 1_790_000_000 * 10**9)
    with pytest.raises(
        TpcError, match=r"sim and wall: 1790000000 s in steps of 0\.1 s are too many"
    ):
        rank_curves(decades, STATIC)
    mission = Recording("m", events([]), (), 0, ns(4))
    for step in (0, -1, 1e-12):
        with pytest.raises(ValueError, match="less than a nanosecond"):
            rank_curves(mission, STATIC, step_s=step)
