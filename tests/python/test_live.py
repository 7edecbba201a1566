"""The live scores are the offline ones, at every instant and whatever the order of arrival."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_samples import (
    EventBuilder,
    SummaryBuilder,
    comparison,
    equal_tables,
    key,
    ns,
    static_info,
)

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.scores.live_scores import LiveRanking, LiveScores, TooOldError
from pytpc.diagnosis.scores.scores import NONE, Before, Formula, type1, type2
from pytpc.diagnosis.scores.summary_scores import LogTables, type2_of_summaries
from pytpc.recording.events import Report
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summary

NAN, INF = math.nan, math.inf
KEYS = [key(0), key(1), key(2)]
DISTANCE = [1.0, 2.0, 5.0]

VALUES = st.one_of(
    st.sampled_from([NAN, INF, -INF, 0.0, 1e16, -1e16, 1e308, -1e308, 5e-324]),
    st.floats(-1e3, 1e3),
)
# Seconds since the newest of all so far: often the same time, sometimes a pause longer than all
# that is kept, and up to 3 s late.
STEPS = st.sampled_from([0, 0, 0.001, 0.3, 1, 2.5, 40, -0.001, -1, -3])
REPORTS = st.lists(
    st.tuples(STEPS, st.integers(0, 2), st.booleans(), VALUES, VALUES, st.sampled_from("ab")),
    max_size=60,
)


def stamped(reports):
    """(ns, key, node, result, cmp, thresh) in the order of arrival."""
    newest = 0.0
    rows = []
    for step, number, result, cmp, thresh, node in reports:
        rows.append((ns(newest + step), key(number), f"/{node}", result, cmp, thresh))
        newest = max(newest, newest + step)
    return rows


def table(rows):
    builder = EventBuilder()
    for time_ns, name, node, result, cmp, thresh in rows:
        builder.add(time_ns, node, Report(name, result, cmp, thresh, result))
    return builder.build().with_keys(KEYS)


def add(live, rows):
    for time_ns, name, node, result, cmp, thresh in rows:
        live.add(time_ns, name, node, result, cmp, thresh, result)


def same(live, rows, mark_ns, window):
    """To the last bit: both add the same numbers in the same order."""
    first, second = live.scores_at(mark_ns)
    events = table(rows)
    assert first.tolist() == type1(events, mark_ns, DISTANCE)[0].tolist()
    assert second.tolist() == type2(events, mark_ns, DISTANCE, Formula(window_s=window))[0].tolist()


@settings(max_examples=300, deadline=None)
@given(REPORTS, st.sampled_from([0.0, 0.5, 3.0, 12.0]), st.data())
def test_live_is_offline_at_every_instant(reports, window, data):
    rows = stamped(reports)
    live = LiveScores(KEYS, DISTANCE, window, late_s=3.0)
    for count, row in enumerate(rows, start=1):
        add(live, [row])
        newest = max(row[0] for row in rows[:count])
        late = data.draw(st.sampled_from([0, 0.001, 1.0, -0.5, -3.0, 100.0]))
        same(live, rows[:count], newest + ns(late), window)
    assert live.late == 0
    same(live, rows, ns(1e6), window)


# Dense streams, so that much is forgotten, in blocks of every size.
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.3, 2.0]))
def test_live_is_offline_after_much_was_forgotten(seed, window):
    random = np.random.default_rng(seed)
    live = LiveScores(KEYS, DISTANCE, window, late_s=0.5)
    rows = []
    for step in range(2000):
        late = random.integers(0, ns(0.2)) if random.random() < 0.2 else 0
        value = random.normal() * 10.0 ** random.integers(-3, 4)
        number, node = int(random.integers(0, 3)), "ab"[int(random.integers(0, 2))]
        rows.append(
            (ns(step / 100) - int(late), key(number), f"/{node}", bool(value > 0.5), value, 0.5)
        )
        add(live, rows[-1:])
        if step % 97 == 0:
            same(live, rows, ns(step / 100), window)
            same(live, rows, ns(step / 100 - 0.2), window)
    assert live.late == 0
    # Of 20 s six streams keep the window and 0.5 s, and a quarter more until they look again.
    kept = sum(len(s.times) for streams in live._streams.values() for s in streams.values())
    assert kept <= (window + 0.5) * 1.25 * 100 + 6 * 20


# Sums depend on the order of what is added, in their last bits.
def test_equal_times_of_several_nodes_are_in_the_order_of_arrival():
    values = [("/a", 1.0), ("/b", 2.0), ("/a", 3.0), ("/b", 4.0)]
    rows = [(ns(1), key(0), node, True, value, 0.0) for node, value in values]
    live = LiveScores(KEYS, DISTANCE, 3.0)
    add(live, rows)
    assert equal_tables(live._events(ns(1), Before.nothing(3)), table(rows))
    assert live.last(key(0), ns(1)).cmp == 4.0


# A spread of 1e16 in the first second, then small numbers: the extremes are remembered when the
# reports are not. At 100 s the window [88, 100] has |3 - 1| alone: 2 / (1e16 - 0).
def test_what_is_forgotten_still_counts():
    live = LiveScores([key(0)], [1])
    add(live, [(ns(t), key(0), "/a", t % 2 == 1, 1e16, 0.0) for t in range(40)])
    add(live, [(ns(100), key(0), "/a", True, 3.0, 1.0)])
    # Results alternate from 0 to 39 s (39 flops, the last at 39 s to True); 100 s is True, too.
    # (100 - 39) * (1 + 39) = 2440.
    first, second = live.scores_at(ns(100))
    assert first.tolist() == [2440.0]
    assert second.tolist() == [2e-16]
    (stream,) = live._streams[key(0)].values()
    assert len(stream.times) < 30


# Kept are the last 5 s, and up to a quarter more: 1.5 s late is in time, 49 s is not. Another node
# is not late for what this one has.
def test_reports_that_come_too_late_are_counted():
    live = LiveScores([key(0)], [1], 2.0, late_s=3.0)
    add(live, [(ns(t), key(0), "/a", False, 1.0, 0.0) for t in range(100)])
    live.add(ns(50), key(0), "/a", True, 1.0, 0.0, True)
    assert live.late == 1
    live.add(ns(50), key(0), "/b", True, 1.0, 0.0, True)
    live.add(ns(97.5), key(0), "/a", True, 1.0, 0.0, True)
    assert live.late == 1
    # Two flops: to True at 97.5 s and back at 98 s, (99 - 98) * (1 + 2) = 3.
    assert live.scores_at(ns(99))[0].tolist() == [3.0]


def test_a_time_that_is_forgotten_has_no_scores():
    live = LiveScores([key(0)], [1], 2.0, late_s=3.0)
    add(live, [(ns(t), key(0), "/a", False, 1.0, 0.0) for t in range(100)])
    with pytest.raises(TooOldError, match="forgotten"):
        live.scores_at(ns(50))
    assert live.scores_at(ns(96))[1].tolist() == [1.0]
    # All of a node that began later than the mark is as if it were not there: a node on wall time
    # beside simulated time.
    wall = 10**18
    add(live, [(wall + ns(t), key(0), "/wall", t % 2 == 0, 9.0, 0.0) for t in range(100)])
    assert live.scores_at(ns(99))[0].tolist() == [NONE]
    assert live.scores_at(ns(99))[1].tolist() == [1.0]


def test_unknown_keys_are_left_out():
    live = LiveScores([key(0)], [1])
    for number in (0, 1, 1):
        live.add(5, key(number), "/a", True, 1.0, 0.0, True)
    assert live.first_ns == {key(0): 5}
    assert live.last(key(0), 5).time_ns == 5


def test_nothing_yet():
    live = LiveScores([key(0)], [1])
    assert [scores.tolist() for scores in live.scores_at(5)] == [[NONE], [NONE]]
    assert [scores.size for scores in LiveScores([], []).scores_at(5)] == [0, 0]


def test_wrong_arguments():
    with pytest.raises(ValueError, match="one distance for each key"):
        LiveScores([key(0)], [1, 2])
    with pytest.raises(ValueError, match="window_s is negative"):
        LiveScores([key(0)], [1], -1)
    with pytest.raises(ValueError, match="twice"):
        LiveScores([key(0), key(0)], [1, 1])


def summary(begin, cmps, node):
    """A period of evaluations against 1.0, the first at ``begin`` and the last 0.1 s later."""
    diffs = [cmp - 1.0 for cmp in cmps]
    return Summary(
        key=key(0),
        node=node,
        begin_ns=ns(begin),
        end_ns=ns(begin + 0.1),
        count=len(cmps),
        flops=0,
        far=sum(abs(diff) > 1e-4 for diff in diffs),
        odd=0,
        result=True,
        res=True,
        cmp=cmps[-1],
        thresh=1.0,
        diff_min=min(diffs),
        diff_max=max(diffs),
        diff_mean=sum(diffs) / len(diffs),
        abs_mean=sum(abs(diff) for diff in diffs) / len(diffs),
        low=min([1.0, *cmps]),
        high=max([1.0, *cmps]),
    )


PERIODS = st.lists(
    st.tuples(
        st.sampled_from([0.1, 0.2, 1.0, 9.0]),
        st.lists(st.floats(1.0, 9.0), min_size=1, max_size=4),
        st.sampled_from("ab"),
        st.booleans(),
    ),
    min_size=1,
    max_size=40,
)


@settings(max_examples=150, deadline=None)
@given(PERIODS, st.sampled_from([0.5, 3.0]))
def test_live_is_offline_with_summaries(periods, window):
    live = LiveScores(KEYS, DISTANCE, window, late_s=1.0)
    builder = SummaryBuilder()
    rows = []
    begin = 0.0
    for step, cmps, node, flop in periods:
        one = summary(begin, cmps, f"/{node}")
        builder.add(one)
        live.add_summary(one)
        if flop:
            rows.append((ns(begin), key(0), f"/{node}", len(rows) % 2 == 0, cmps[0], 1.0))
            add(live, rows[-1:])
        for mark in (begin + 0.1, begin + 0.05):
            first, second = live.scores_at(ns(mark))
            events = table(rows)
            expected = type2_of_summaries(
                LogTables(events, builder.build()), ns(mark), DISTANCE, Formula(window)
            )
            assert first.tolist() == type1(events, ns(mark), DISTANCE)[0].tolist()
            assert second == pytest.approx(expected[0], rel=1e-9)
        begin += step


STATIC = static_info(
    comparison(0, "coverage", distance=1),
    comparison(1, "coverage", distance=2),
    comparison(2, "faces", distance=5),
    comparison(3, "fixed", type="constant"),
)


@settings(max_examples=100, deadline=None)
@given(REPORTS, st.sampled_from(["I", "II", None]), st.sampled_from(["believe", "doubt", "ignore"]))
def test_the_live_ranking_is_the_recorded_one(reports, kind, types):
    rows = stamped(reports)
    live = LiveRanking(STATIC, Question(types=types, window_s=3.0))
    add(live.scores, rows)
    end = max([row[0] for row in rows], default=0)
    for mark_ns in (end, end + ns(1), end + ns(20)):
        mark = Mark(mark_ns, kind)
        mission = Recording("m", table(rows), (mark,), 0, end)
        (offline,) = rank_marks(mission, STATIC, Question(types=types, window_s=3.0))
        found = live.ranking_at(mark)
        assert str(found) == str(offline)  # NaN is not equal to itself


def test_a_live_mark_that_is_too_old():
    live = LiveRanking(STATIC)
    add(live.scores, [(ns(t), key(0), "/a", t % 2 == 0, 1.0, 0.0) for t in range(100)])
    found = live.ranking_at(Mark(ns(50), "I"))
    assert (found.suspects, found.enough, found.parameters) == ((), False, 2)
    assert found.reason == "the mark is more than 10 s older than the newest reports"


# Under `edges`: the first report at 10 s and a summary up to 12.1 s.
def test_a_live_ranking_from_summaries():
    live = LiveRanking(STATIC)
    live.scores.add(ns(10), key(0), "/a", True, 5.0, 1.0, True)
    one = replace(summary(10.0, [5.0, 3.0], "/a"), end_ns=ns(12.1))
    live.scores.add_summary(one)
    builder = SummaryBuilder()
    builder.add(one)
    rows = [(ns(10), key(0), "/a", True, 5.0, 1.0)]
    mark = Mark(ns(13), "II")
    mission = Recording("m", table(rows), (mark,), 0, ns(13), summaries=builder.build())
    (offline,) = rank_marks(mission, STATIC)
    assert live.ranking_at(mark) == offline
    # (4 + 2) / 2 / (5 - 1) = 0.75; the last evaluation is the summary's.
    assert [(s.score, s.last.cmp) for s in offline.suspects] == [(0.75, 3.0)]
