"""Margins, near misses, drift: what a comparison did over a mission, by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest
from mission_samples import SummaryBuilder, comparison, events, key, link_unit, ns, static_info

from pytpc.diagnosis.behaviour import behaviours, over_missions
from pytpc.recording.events import Events
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summary
from pytpc.static.link_unit import ParameterRead, Transform
from pytpc.static.static_info import StaticInfo


def mission(table, summaries=None):
    found = Recording("m", table, (), 0, ns(1000))
    return found if summaries is None else replace(found, summaries=summaries)


def of_values(values, thresh=0.0, step=1.0, **changes):
    """The behaviour of ``value > thresh``, one evaluation each ``step`` seconds."""
    rows = [(n * step, 0, value > thresh, value, thresh) for n, value in enumerate(values)]
    static = static_info(comparison(0, "~limit", **changes))
    (found,) = behaviours(mission(events(rows)), static)
    return found


def test_the_distribution_counts_time():
    # 10 s at 4, 10 s at 2 and 1 s at 1, evaluated each second: 21 s. Of these 5 % are 1.05 s, of
    # which 1 s is at 1, so that the value below which they lie is 2; half are 10.5 s: 2; 95 %: 4.
    found = of_values([4] * 10 + [2] * 10 + [1])
    assert found.evaluations == 21
    assert found.seconds == pytest.approx(21)
    assert found.margins == (1, 2, 2, 4)
    assert found.reach == 4
    assert found.nearest == 0.25
    assert found.true_share == 1


def test_a_pause_does_not_count():
    # A pause of 100 s between two spans of 5 s: the longest that counts is three usual steps.
    rows = [(t, 0, 1, 5, 0) for t in (0, 1, 2, 3, 4, 104, 105, 106, 107, 108)]
    static = static_info(comparison(0, "~limit"))
    (found,) = behaviours(mission(events(rows)), static)
    assert found.seconds == pytest.approx(4 + 3 + 4 + 1)


def test_turns_and_shares():
    # 6 s below, 2 s above, 2 s below: 2 turns in 10 s are 12 a minute.
    found = of_values([-3] * 6 + [3] * 2 + [-3] * 2)
    assert (found.turns, found.turns_per_minute) == (2, pytest.approx(12))
    assert found.true_share == pytest.approx(0.2)
    assert found.near_misses == 0


def test_near_misses_come_near_and_leave():
    # The range is 10: near is 0.5 and less, and above 1 it has left.
    assert of_values([10, 0.4, 10]).near_misses == 1
    assert of_values([10, 0.4, 0.9, 0.3, 10]).near_misses == 1, "noise counts once"
    assert of_values([10, 0.4, 1.1, 0.3, 10]).near_misses == 2
    assert of_values([10, 0.6, 10]).near_misses == 0
    assert of_values([10, 0.4]).near_misses == 1, "it may end there"


def test_a_turn_is_no_miss():
    assert of_values([10, 0.4, -3, -8]).near_misses == 0, "it turned while near"
    assert of_values([10, 0.4, -0.4, 0.4, 10]).near_misses == 0
    assert of_values([10, -0.4, -10]).near_misses == 0, "it came over the threshold"


def test_undecided_is_the_share_of_time_near_the_threshold():
    # The range is 10, near is up to 0.5: 3 of 10 s.
    assert of_values([10] * 7 + [0.5, 0.1, 0.3]).undecided == pytest.approx(0.3)


def test_a_margin_that_shrinks_is_a_drift():
    # From 10 by 0.1 each second over 60 s: the last part are the 6 s from 4.6 to 4.1, with the
    # median 4.35, and 4.35 / 0.1 s are left. 0.1 a second are 6 a minute.
    found = of_values([10 - 0.1 * n for n in range(60)])
    assert found.drift.per_minute == pytest.approx(-6)
    assert found.drift.turns_in_s == pytest.approx(43.5)
    assert found.drift_text == "-6 a minute: 0 in 43 s"


def test_a_margin_that_grows_never_turns():
    found = of_values([1 + 0.1 * n for n in range(60)])
    assert found.drift.per_minute == pytest.approx(6)
    assert found.drift.turns_in_s is None
    assert found.drift_text == "6 a minute"


def test_noise_is_no_drift():
    assert of_values([5 + (n * 7 % 10) / 10 for n in range(60)]).drift is None
    assert of_values([10 - n for n in range(9)]).drift is None, "too few"


def test_the_margin_is_in_the_unit_of_the_parameter():
    # The threshold is 2 x: a margin of 4 is one of 2 in the parameter's unit.
    twice = Transform("affine", 2.0, 0.0)
    found = of_values([5, 7, 9], thresh=1, transform=twice)
    assert found.margins.least == 2
    assert (found.unit, found.reach) == ("parameter", 4)


def test_other_numbers_in_the_arithmetic_leave_the_unit_of_the_value():
    found = of_values([5, 7], thresh=1, transform=Transform("expression", text="x * speed"))
    assert (found.unit, found.margins.least) == ("value", 4)


def test_flags_and_texts_have_no_margin():
    flag = static_info(comparison(0, "~on", "flag"))
    rows = [(t, 0, t % 2, t % 2, t % 2) for t in range(4)]
    (found,) = behaviours(mission(events(rows)), flag)
    assert (found.margins, found.undecided, found.nearest, found.turns) == (None, None, None, 3)
    read = ParameterRead(
        "~mode", "getParam", "std::string", None, "src/node.cpp", 3, 1, "Node::step"
    )
    text = StaticInfo.of([link_unit([comparison(0, "~mode", "==")], [read])])
    (found,) = behaviours(mission(events([(0, 0, 1, 1, 1), (1, 0, 0, 0, 1)])), text)
    assert found.margins is None


def test_values_that_are_no_numbers_have_no_margin():
    nan = float("nan")
    assert of_values([nan, nan]).margins is None
    found = of_values([nan, 3, 5])
    assert found.margins.least == 3


def summary(begin, end, count, low, high, *, flops=0):
    return Summary(
        key(0), "/node", ns(begin), ns(end), count, flops, count, 0, True, True, high, 0.0,
        low, high, (low + high) / 2, (low + high) / 2, 0.0, high,
    )  # fmt: skip


def test_summaries_count_their_evaluations_once():
    # The first evaluation and a flop are in the events and in the summaries; a later evaluation is
    # in no summary.
    table = events([(0, 0, 0, -1, 0), (0.5, 0, 1, 2, 0), (30, 0, 1, 4, 0)])
    rows = SummaryBuilder()
    rows.add(summary(0, 1, 100, -1, 2, flops=1))
    rows.add(summary(1, 2, 50, 2, 6))
    (found,) = behaviours(mission(table, rows.build()), static_info(comparison(0, "~limit")))
    assert (found.evaluations, found.turns) == (151, 1)
    assert found.margins.least == 1
    assert found.reach == 7


def test_turns_beyond_a_cap_count():
    table = events([(0, 0, 0, -1, 0), (0.5, 0, 1, 2, 0)])
    rows = SummaryBuilder()
    rows.add(summary(0, 1, 100, -1, 2, flops=12))
    (found,) = behaviours(mission(table, rows.build()), static_info(comparison(0, "~limit")))
    assert found.turns == 12


def test_a_log_without_reports_has_no_behaviour():
    assert behaviours(mission(Events.empty()), static_info(comparison(0, "~limit"))) == ()


def test_over_missions():
    # The margin shrinks by 1 from mission to mission: 6 missions are clear, and after the last one,
    # with 4, four more are left.
    static = static_info(comparison(0, "~limit"), comparison(1, "~other"))
    found = []
    for margin in (9, 8, 7, 6, 5, 4):
        rows = [(t, 0, 1, margin, 0) for t in range(5)] + [(5, 0, 1, margin + 1, 0)]
        rows += [(t, 1, 0, -1, 1) for t in range(5)] if margin == 6 else []
        found.append(behaviours(mission(events(rows)), static))
    limit, other = over_missions(found)
    assert (limit.parameter, limit.trend, limit.zero_in) == ("~limit", -1, 4)
    assert [one.margins.median for one in limit.behaviours] == [9, 8, 7, 6, 5, 4]
    assert [one is None for one in other.behaviours] == [True, True, True, False, True, True]
    assert other.trend is None


def test_two_instances_with_one_name_are_told_apart_over_missions():
    static = static_info(comparison(0, "~limit"))
    one = behaviours(mission(events([(0, 0, 1, 3, 0), (1, 0, 1, 9, 0)])), static)
    other = tuple(replace(each, key=f"{each.key}#2") for each in one)
    found = over_missions([(*one, *other), one])
    assert [each.behaviours for each in found] == [(*one, *one), (*other, None)]
    # The number of an instance with a name of its own may be another one in the next mission.
    assert [each.behaviours for each in over_missions([one, other])] == [(*one, *other)]


def test_a_few_missions_have_no_trend():
    static = static_info(comparison(0, "~limit"))
    found = [
        behaviours(mission(events([(0, 0, 1, margin, 0), (1, 0, 1, 9, 0)])), static)
        for margin in (3, 2, 1)
    ]
    assert over_missions(found)[0].trend is None
