from __future__ import annotations

import math

import numpy as np
import pytest
from mission_samples import comparison, events, key, ns, static_info

from pytpc.diagnosis.ranking.known_good import (
    MOST_SETTINGS,
    SET_ANEW,
    UNCHANGED,
    Instead,
    KnownGood,
    Moved,
    before_changes,
    of_good_run,
    of_settings,
    other_thresholds,
)
from pytpc.diagnosis.ranking.other_values import (
    ALONE,
    REPLAYED,
    diagnose_beside,
    diagnose_replayed,
)
from pytpc.diagnosis.ranking.replayed_outcomes import ACQUITTED, UNKNOWN_CHARGE, replayed, turns
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.thresholds.units import added_by
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.link_unit import Transform

STATIC = static_info(
    comparison(0, "~height"),
    comparison(1, "~speed"),
    comparison(2, "~range"),
    comparison(
        3,
        "~angle_deg",
        transform=Transform("affine", scale=2.0, offset=1.0),
    ),
)


def recording(rows, *marks, kind=None):
    found = [Mark(ns(t), kind, f"user{n}") for n, t in enumerate(marks)]
    return Recording("mission", events(rows), tuple(found), 0, ns(100))


def turned_spans(values, thresh, other, step=1.0):
    """The turns of ``value > thresh`` at these values, ``step`` apart, and of a log of 30 s."""
    rows = [(n * step, 0, v > thresh, v, thresh) for n, v in enumerate(values)]
    rows.append((30.0, 1, 0, 0, 1))
    stream = ResultStreams.of(events(rows), Tpcs.of(STATIC)).streams[0]
    turned = (stream.cmp > thresh) != (stream.cmp > other)
    begins, lengths = turns(stream, turned, np.full(turned.size, float(other)))
    return list(zip(begins.tolist(), lengths.tolist(), strict=True))


# 0 1 2 3 4 5 at 0..5 s: above 2 from 3 s on, above 4 from 5 s on.
def test_a_turn_lasts_until_the_outcome_is_the_same_again():
    assert turned_spans([0, 1, 2, 3, 4, 5], 2, 4) == [(3.0, 2.0)]


# Left alone at 3 s with 3, rising by 1 a second: at 4 s it is 4, and above it at the next look, 1 s
# later.
def test_where_it_is_left_alone_the_value_is_followed_on():
    assert turned_spans([0, 1, 2, 3], 2, 4) == [(3.0, pytest.approx(2.0))]


# The same with the threshold on the line itself, 3 > 3: only the look after is needed.
def test_a_value_on_the_other_threshold_is_past_it_at_the_next_look():
    assert turned_spans([0, 1, 2, 3], 2.5, 3) == [(3.0, pytest.approx(1.0))]


# A timer that is set back from 5 to 0, and left at 2: it rises by 1 in 0.5 s, to 3 in 0.5 s and one
# look of 0.5 s. With the step from 5 it would fall.
def test_a_timer_that_is_set_back_is_followed_from_there():
    assert turned_spans([5, 0, 1, 2], 1.5, 3, step=0.5) == [(1.5, pytest.approx(1.0))]


def test_what_is_asked_once_or_goes_away_never_gets_there():
    assert turned_spans([3], 2, 4) == [(0.0, math.inf)]
    assert turned_spans([5, 3.9, 3.5], 2, 4) == [(1.0, math.inf)]


# 3 at 0 s and 1 s are two turns, as 5 was between: 0 to 1 s, and from 2 s on with no way to 4.
def test_two_turns_are_two():
    assert turned_spans([3, 5, 3], 2, 4) == [(0.0, 1.0), (2.0, math.inf)]


def test_old_values_become_thresholds_in_their_own_unit():
    changes = [
        Change("/node/angle_deg", "", 3.0, 4.0),
        Change("~height", "", 1.5, math.nan),
        Change("~unknown", "", 1.0, 2.0),
    ]
    assert before_changes(STATIC, changes) == {key(3): Instead(((9.0, 7.0),)), key(0): 1.5}


# It was 5, then 8, and is 12: the log has 12, and 5 is what worked.
def test_of_several_changes_the_first_old_and_the_last_new_value_count():
    changes = [Change("/n/height", "", 5.0, 8.0), Change("/n/height", "", 8.0, 12.0)]
    assert before_changes(STATIC, changes) == {key(0): Instead(((12.0, 5.0),))}


# Two nodes run the code, and both values were changed.
@pytest.mark.parametrize("way", [1, -1])
def test_changes_of_two_nodes_are_both_replayed(way):
    changes = [Change("/a/height", "", 4.0, 5.0), Change("/b/height", "", 12.0, 9.0)]
    (other,) = before_changes(STATIC, changes[::way]).values()
    assert other_thresholds(np.array([5.0, 9.0]), other).tolist() == [4.0, 12.0]


def test_a_value_that_was_not_set_gives_no_threshold():
    least = Transform("expression", text="min(3, x)", tree=("min", 3.0, "x"))
    static = static_info(comparison(0, "~height", transform=least))
    assert before_changes(static, [Change("~height", "", math.nan, 2.0)]) == {}


@pytest.mark.parametrize(
    ("text", "slope"),
    [
        ("x + start", 1.0),
        ("this->last_ + 1000 * x", 1000.0),
        ("now - (x / 2 + ros::begin)", -0.5),
        ("-x", -1.0),
        ("scale * x + start", None),
        ("x * x", None),
        ("y + 1", None),
        ("1e400 * x", None),
        ("x - x", None),
        ("-" * 200_000 + "x", None),
        ("x +", None),
        ("x[] + 1", None),
    ],
)
def test_how_far_a_threshold_moves_with_its_parameter(text, slope):
    assert added_by(comparison(0, "~a", transform=Transform("expression", text=text))) == slope


# x + start: nobody knows where it started, but with 5 in place of 2 it is 3 more.
def test_a_threshold_to_which_the_parameter_is_added_moves_with_it():
    added = Transform("expression", text="x + start")
    static = static_info(comparison(0, "~timeout", transform=added))
    (other,) = before_changes(static, [Change("~timeout", "", 5.0, 2.0)]).values()
    assert other == Moved(3.0)
    assert other_thresholds(np.array([10.0, 20.0]), other).tolist() == [13.0, 23.0]
    assert before_changes(static, [Change("~timeout", "", 5.0, math.nan)]) == {}


# Two costmaps run the same code, one with a width of 6 and one with 9: the first had 5 before.
def test_only_evaluations_with_the_changed_value_are_replayed():
    other = other_thresholds(np.array([6.0, 9.0, 6.0]), Instead(((6.0, 5.0),)))
    assert other[[0, 2]].tolist() == [5.0, 5.0]
    assert math.isnan(other[1])
    rows = [(t, 0, limit < 5.5, 5.5, limit) for t in range(0, 60, 2) for limit in (6, 9)]
    rows += [(t, 1, 0, 0, 1) for t in range(100)]
    found = replayed(recording(rows, 70), STATIC, {key(0): Instead(((9.0, 8.0),))})
    assert found["~height"] == ACQUITTED
    assert (
        replayed(recording(rows, 70), STATIC, {key(0): Instead(((6.0, 5.0),))})["~height"]
        > ACQUITTED
    )
    # Nothing was evaluated with that value, so nobody knows.
    gone = replayed(recording(rows, 70), STATIC, {key(0): Instead(((7.0, 5.0),))})
    assert gone == {"~height": UNKNOWN_CHARGE}


# The second comparison is known to be as it was.
def test_what_kept_its_threshold_has_done_nothing():
    static = static_info(comparison(0, "~gate"), comparison(1, "~gate"))
    rows = [(t, n, 0, 1.0, 3.0) for t in range(50) for n in range(2)]
    assert replayed(recording(rows, 40), static, {key(0): 9.0}, {key(1)}) == {"~gate": ACQUITTED}


# With 9 instead of 3 gate's first comparison would not have turned; of the second nothing is known.
def test_a_comparison_that_cannot_be_replayed_may_have_done_it():
    static = static_info(comparison(0, "~gate"), comparison(1, "~gate"), comparison(2, "~far"))
    rows = [(t, n, 0, 1.0, 3.0) for t in range(50) for n in range(3)]
    found = replayed(recording(rows, 40), static, {key(0): 9.0, key(2): 9.0})
    assert found == {"~gate": UNKNOWN_CHARGE, "~far": ACQUITTED}


def test_of_a_good_run_only_what_differs_is_replayed():
    here = events([(1, 0, 0, 1, 4), (1, 1, 0, 1, 4), (1, 2, 0, 1, 4)])
    there = events([(1, 0, 0, 1, 2), (1, 1, 0, 1, 4)])
    assert of_good_run(Tpcs.of(STATIC), here, there) == {key(0): 2.0}


def mission():
    """height turns at 30 s and stays; speed crosses its threshold at 30 s, and falls back at 40 s.

    range never comes near.
    """
    rows = []
    for tick in range(200):
        t = tick / 2
        high, fast = (3.0 if t >= 30 else 1.0), (t / 10 if t < 40 else 0.0)
        rows.append((t, 0, high > 2, high, 2))
        rows.append((t + 0.01, 1, fast > 3, fast, 3))
        rows.append((t + 0.02, 2, 0, 1 + 0.1 * math.sin(t), 9))
    return rows


def test_what_turns_nothing_before_the_marks_is_acquitted():
    others = {key(0): 4.0, key(2): 8.0}
    found = replayed(recording(mission(), 36, 38), STATIC, others)
    assert found["~range"] == ACQUITTED
    assert found["~height"] > 0.0
    assert set(found) == {"~height", "~range"}
    assert replayed(recording(mission(), 20), STATIC, others)["~height"] == ACQUITTED


# With 3.06 speed's decision would have come at 31 s instead of 30.5 s, half a second later; with 9
# never: 9.5 s, until it falls back.
def test_a_decision_a_moment_later_is_hardly_another_one():
    charge = [
        replayed(recording(mission(), 36, 38, kind="I"), STATIC, {key(1): other})["~speed"]
        for other in (3.06, 9.0)
    ]
    assert charge[0] < charge[1] - 1.0


# Not by the number: 2.5 and 2000 turn the same evaluations of height, 1 before and 3 after.
def test_the_size_of_the_change_is_not_asked():
    near, far = (
        replayed(recording(mission(), 36), STATIC, {key(0): other})["~height"]
        for other in (3.5, 2000.0)
    )
    assert near == far


def test_what_is_turned_in_the_whole_wait_is_charged_where_nothing_is_done():
    marks = (75, 82, 89, 96)
    others = {key(0): 4.0, key(1): 3.9}
    found = replayed(recording(mission(), *marks, kind="II"), STATIC, others)
    assert found["~height"] > found["~speed"]


def test_the_replay_decides_among_what_differs():
    rows, others = mission(), {key(0): 4.0, key(2): 8.0}
    names = Tpcs.of(STATIC).names
    prior = np.where([name in ("~height", "~range") for name in names], 0.0, UNCHANGED)
    found = diagnose_replayed(recording(rows, 36, 38), STATIC, KnownGood(prior, others))
    assert [found.names[n] for n in found.order] == ["~height", "~range", "~speed"]
    assert found.posterior.sum() + found.none == pytest.approx(1.0)
    assert found.posterior[names.index("~height")] > 0.5


def test_without_marks_nobody_is_charged():
    found = diagnose_replayed(recording(mission()), STATIC, KnownGood(np.zeros(4), {key(0): 4.0}))
    assert (found.order, found.none) == ([], 1.0)


def set_anew(*values, every=10.0):
    """height's threshold has these values in turn; what it is compared with is 3 all the time."""
    rows = []
    for tick in range(160):
        t = tick / 2
        limit = values[min(int(t / every), len(values) - 1)]
        rows.append((t, 0, limit < 3.0, 3.0, limit))
        rows.append((t + 0.01, 1, t % 9 > 4, t % 9, 4))
    return rows


def test_what_was_set_while_it_ran_is_replayed_with_its_first_value():
    tpcs = Tpcs.of(STATIC)
    found = of_settings(STATIC, tpcs, events(set_anew(5, 2)))
    assert found.others == {key(0): 5.0}
    assert found.prior[tpcs.names.index("~height")] == SET_ANEW
    assert np.isnan(np.delete(found.prior, tpcs.names.index("~height"))).all()


@pytest.mark.parametrize("values", [range(MOST_SETTINGS + 1), (5, 2, 5)])
def test_a_threshold_that_is_worked_out_is_no_setting(values):
    assert of_settings(STATIC, Tpcs.of(STATIC), events(set_anew(*values, every=5.0))).others == {}


# The log looks as if height was set from 5 to 2, but the parameter server had 2 all the time.
def test_what_is_known_to_have_kept_its_value_was_not_set():
    mission = recording(set_anew(5, 5, 2), 28, 35, kind="I")
    changed = [Change("~speed", "", 3.0, 4.0)]
    found = diagnose_beside(mission, STATIC, changes=changed)
    assert found.names[found.order[0]] == "~speed"


# Two nodes run the code, each with its own value.
def test_a_setting_of_another_node_is_no_change():
    rows = [(t, 0, 1, 3, 2 + t % 2, f"/n{t % 2}") for t in range(20)]
    assert of_settings(STATIC, Tpcs.of(STATIC), events(rows)).others == {}


# The good run had both values of speed's threshold, and only the first one of height's.
def test_who_sets_a_wrong_value_while_it_runs_is_found():
    mission = recording(set_anew(5, 5, 2), 28, 35, kind="I")
    good = recording(set_anew(5))
    for references in ((), (good,)):
        found = diagnose_beside(mission, STATIC, references=references)
        assert found.names[found.order[0]] == "~height"
        assert found.posterior[found.order[0]] > 0.5


# height is compared with the parameter times the load, which the log does not have.
def test_what_is_worked_out_from_more_than_the_parameter_is_no_setting():
    worked_out = Transform("expression", text="max_height * load")
    static = static_info(comparison(0, "~height", transform=worked_out), comparison(1, "~speed"))
    assert of_settings(static, Tpcs.of(static), events(set_anew(5, 2))).others == {}


def set_up(*seconds):
    """~height is compared at these seconds, and ~speed each second, with the marks at 30 s."""
    rows = [(t, 0, False, 1, 2) for t in seconds]
    rows += [(t, 1, t > 25, t, 25) for t in range(40)]
    return recording(sorted(rows), 30.0)


# The good run had another threshold, with which 1 is still below it. Compared at the set-up only,
# it is as likely as one of which the log knows nothing, for it may act as a number.
def test_what_is_compared_at_the_set_up_only_is_neither_accused_nor_acquitted():
    names = Tpcs.of(STATIC).names
    prior = np.array([0.0 if name == "~height" else UNCHANGED for name in names])

    def score(*seconds):
        found = diagnose_replayed(set_up(*seconds), STATIC, KnownGood(prior, {key(0): 1.5}))
        return found.scores[names.index("~height")]

    assert score(0.0, 1.0) == pytest.approx(REPLAYED * UNKNOWN_CHARGE - ALONE * math.log(2))
    assert score(0.0, 1.0, 15.0) < REPLAYED * ACQUITTED


def test_a_set_up_lasts_ten_seconds_and_not_longer_than_up_to_a_mark():
    streams = ResultStreams.of(set_up(0.0, 9.0).events, Tpcs.of(STATIC))
    height = Tpcs.of(STATIC).names.index("~height")
    assert streams.only_at_set_up(30.0) == {height}
    assert streams.only_at_set_up(8.0) == frozenset()
    later = ResultStreams.of(set_up(0.0, 11.0).events, Tpcs.of(STATIC))
    assert later.only_at_set_up(30.0) == frozenset()
