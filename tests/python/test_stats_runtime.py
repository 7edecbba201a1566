"""Table 6.12 of small missions, worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info

from pytpc.recording.events import Events
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summary
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.stats.runtime import runtime_statistics, runtime_table

# Comparisons 0 and 1 are of coverage, on two lines; 2 of faces; 3 of idle is never evaluated; 4 is
# with a constant.
STATIC = static_info(
    comparison(0, "coverage"),
    comparison(1, "coverage"),
    comparison(2, "faces"),
    comparison(3, "idle"),
    comparison(4, "", type="constant"),
)


def mission(rows, begin: float, end: float, summaries=()) -> Recording:
    builder = SummaryBuilder()
    for row in summaries:
        builder.add(row)
    return Recording("m", events(rows), (), ns(begin), ns(end), summaries=builder.build())


# First mission, 10 s: coverage at 0.5 (false), 0.9 (true, a flop) and 10.0 (true, in the last of
# the ten seconds) by comparison 0 and 3.2 (true) by 1; faces at 3.5. Second, 4.5 s, so five
# seconds: coverage at 100.5, the first one there, so no flop; faces at 104.4.
ONE = mission(
    [
        (0.5, 0, 0, 1, 2),
        (0.9, 0, 1, 3, 2),
        (3.2, 1, 1, 3, 2),
        (3.5, 2, 0, 1, 2),
        (3.6, 4, 1, 1, 2),
        (10.0, 0, 1, 3, 2),
    ],
    0,
    10,
)
TWO = mission([(100.5, 0, 0, 1, 2), (104.4, 2, 1, 3, 2)], 100, 104.5)


# coverage: 4 + 1 evaluations, 5 / 14.5 s = 0.345; seconds 0, 3, 9 and one of the second mission, 4
# of 15; 3 of 5 true. faces: 2 / 14.5 = 0.138, 2 of 15 seconds, 1 of 2 true.
def test_two_missions_by_hand():
    found = runtime_statistics([ONE, TWO], STATIC)
    assert (found.missions, found.seconds) == (2, 14.5)
    assert (found.locations, found.seen, found.parameters) == (4, 3, 3)
    table = runtime_table(found)
    rows = dict(table.rows)
    assert list(rows) == ["coverage", "faces"]
    assert rows["coverage"] == pytest.approx((2, 5, 5 / 14.5, 400 / 15, 1, 60, 40))
    assert rows["faces"] == pytest.approx((1, 2, 2 / 14.5, 200 / 15, 0, 50, 50))
    # Of two rows: (5 + 2) / 2; the deviation is sqrt((1.5^2 + 1.5^2) / (2 - 1)) = 2.1213.
    summary = dict(table.summary)
    assert (summary["mean"][1], summary["sum"][1]) == (3.5, 7)
    assert summary["std"][1] == pytest.approx(2.1213, abs=1e-4)


def test_one_place_in_two_link_units_is_one_location():
    (unit,) = STATIC.units
    other = replace(comparison(5, "coverage"), lineno=10)
    twice = StaticInfo.of([unit, replace(unit, link_unit="other", comparisons=(other,))])
    found = runtime_statistics([ONE, mission([(1, 5, 1, 3, 2)], 0, 2)], twice)
    (row, _) = found.rows
    assert (row.parameter, row.locations, row.comparisons) == ("coverage", 2, 5)


# The second object is always above while the first is below: no flop, one place, one parameter. By
# turns in one stream, each evaluation after the first would be a flop.
def test_objects_of_a_class_count_together():
    rows = [(1, 0, 0, 1, 2), (2, 9, 1, 3, 2), (3, 0, 0, 1, 2), (4, 9, 1, 3, 2)]
    whole = mission(rows, 0, 10, [replace(kept(5, 6, 10, 0, True), key=key(9))])
    keys = {key(0): key(0), key(9): f"{key(0)}#2"}
    events_of, summaries = (
        replace(table, keys=tuple(keys[one] for one in table.keys))
        for table in (whole.events, whole.summaries)
    )
    objects = replace(whole, events=events_of, summaries=summaries)
    found = runtime_statistics([objects], STATIC)
    (row,) = found.rows
    assert (row.parameter, row.locations, row.comparisons, row.flops) == ("coverage", 1, 14, 0)
    assert (found.seen, found.locations) == (1, 4)
    assert row.true == pytest.approx(100 * 12 / 14)


def kept(begin: float, end: float, count: int, flops: int, result: bool) -> Summary:
    """A summary of comparison 0 in /node."""
    return Summary(
        key(0), "/node", ns(begin), ns(end), count, flops, count, 0, result, result, 1.0, 2.0,
        -1.0, 1.0, 0.0, 1.0, 1.0, 3.0,
    )  # fmt: skip


# Ten evaluations in [0, 0.9] are all false. Eight in [1, 2] with one flop at 1.25, true from then
# on: evenly spread, 0.75 * 8 = 6 of them true. The first evaluation and the flop are among those;
# the one in /other is in no summary. 19 in all, 6 true; seconds 0, 1, 2 and 5 of 10; one flop.
def test_summaries_count_for_their_evaluations():
    rows = [(0, 0, 0, 1, 2), (1.25, 0, 1, 3, 2), (5.5, 0, 0, 1, 2, "/other")]
    summaries = [kept(0, 0.9, 10, 0, False), kept(1, 2, 8, 1, True)]
    (row,) = runtime_statistics([mission(rows, 0, 10, summaries)], STATIC).rows
    assert (row.locations, row.comparisons, row.flops) == (1, 19, 1)
    assert (row.frequency, row.runtime) == (1.9, 40.0)
    assert row.true == pytest.approx(100 * 6 / 19)


def test_summaries_of_other_builds_are_left_out():
    other = replace(kept(0, 1, 5, 0, True), key=key(99))
    assert runtime_statistics([mission([], 0, 10, [other])], STATIC).rows == ()


# A mission without a length: nothing can be said per second, and its one second is counted.
def test_a_mission_of_no_time():
    (row,) = runtime_statistics([mission([(7, 2, 1, 3, 2)], 7, 7)], STATIC).rows
    assert (row.frequency, row.runtime, row.true) == (None, 100.0, 100.0)


# The clock was set after the first report: of a billion seconds two have an event, and no table of
# all of them is made.
def test_the_clock_was_set_meanwhile():
    rows = [(0.5, 2, 1, 3, 2), (10**9, 2, 1, 3, 2)]
    (row,) = runtime_statistics([mission(rows, 0, 10**9)], STATIC).rows
    assert row.runtime == pytest.approx(200 / 10**9)


def test_nothing_was_reported():
    found = runtime_statistics([Recording("m", Events.empty(), (), 0, 0)], STATIC)
    table = runtime_table(found)
    assert (table.rows, table.summary) == ((), ())
    assert "0 of 4 locations (0.0 %)" in table.notes[0]
    assert runtime_table(runtime_statistics([], STATIC)).rows == ()
