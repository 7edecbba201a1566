"""The tables from summaries (policy ``edges``) against those from every evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mission_samples import SECOND, SummaryBuilder, comparison, events, key, static_info

from pytpc.recording.events import Events
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries, Summary
from pytpc_evaluation.stats.delays import error_start
from pytpc_evaluation.stats.missions import StudyMission
from pytpc_evaluation.stats.runtime import runtime_statistics
from pytpc_evaluation.stats.thesis_tables import thesis_tables
from pytpc_evaluation.treatment import Treatment

STATIC = static_info(comparison(0, "~limit"), comparison(1, "~other"))
RAISED = Treatment("t", "type2", "~limit", "/node", 3.0, 9.0, {}, "", Path("p.yaml"))


def summaries_of(given: Events) -> Summaries:
    """What ``edges`` would keep with a period of a second, that begins with the mission's."""
    builder = SummaryBuilder()
    for code, name in enumerate(given.keys):
        rows = given.by_key.rows(code)
        for second in sorted({int(time) // SECOND for time in given.time_ns[rows]}):
            own = rows[given.time_ns[rows] // SECOND == second]
            diff = given.cmp[own] - given.thresh[own]
            last = own[-1]
            builder.add(
                Summary(
                    name, "/node", int(given.time_ns[own[0]]), int(given.time_ns[last]), own.size,
                    int(given.flop[own].sum()), int((abs(diff) > 1e-4).sum()), 0,
                    bool(given.result[last]), bool(given.res[last]), float(given.cmp[last]),
                    float(given.thresh[last]), float(diff.min()), float(diff.max()),
                    float(diff.mean()), float(abs(diff).mean()),
                    float(min(given.cmp[own].min(), given.thresh[own].min())),
                    float(max(given.cmp[own].max(), given.thresh[own].max())),
                )
            )  # fmt: skip
    return builder.build()


def with_edges(whole: Recording) -> Recording:
    kept = whole.events.flop | (whole.events.previous < 0)
    return replace(whole, events=whole.events.take(kept), summaries=summaries_of(whole.events))


def mission(rows: Sequence[tuple[int, int, int]], threshold: float) -> Recording:
    """From rows (milliseconds, number of the key, compared value)."""
    table = events(
        [(at / 1000, n, int(cmp > threshold), cmp, threshold) for at, n, cmp in sorted(rows)]
    )
    return Recording("m", table, (), 0, 12 * SECOND)


ROWS = st.lists(
    st.tuples(st.integers(0, 11_999), st.integers(0, 1), st.integers(0, 8)),
    min_size=1,
    max_size=60,
    # Reports of one comparison at the same instant: the summaries of two periods would share it.
    unique_by=lambda row: row[0],
)


@given(ROWS)
def test_table_6_12_is_the_same(rows):
    whole = mission(rows, 4.0)
    kept = with_edges(whole)
    every = runtime_statistics([whole], STATIC).rows
    for exact, row in zip(every, runtime_statistics([kept], STATIC).rows, strict=True):
        assert replace(row, true=0.0, false=0.0) == replace(exact, true=0.0, false=0.0)
        # Only where a predicate flopped within a second its outcomes are not all known.
        code = int(exact.parameter == "~other")
        own = kept.summaries.take(kept.summaries.key == kept.summaries.keys.index(key(code)))
        unsure = int(own.count[own.flops > 0].sum())
        assert abs(row.true - exact.true) <= 100 * unsure / exact.comparisons + 1e-9
        assert row.true + row.false == pytest.approx(100)


# The raised threshold is above all values, so that the recorded outcome is always false.
@given(ROWS)
def test_an_error_of_type2_begins_in_the_same_second(rows):
    whole = mission(rows, 9.0)
    exact = error_start(StudyMission("m", whole, RAISED), STATIC)
    start = error_start(StudyMission("m", with_edges(whole), RAISED), STATIC)
    if exact is None or start is None:
        assert exact is start
    else:
        assert start <= exact
        assert start // SECOND == exact // SECOND


@given(ROWS)
def test_an_error_of_type1_begins_with_the_same_flop(rows):
    whole = mission(rows, 4.0)
    lowered = replace(RAISED, type="type1")
    exact = error_start(StudyMission("m", whole, lowered), STATIC)
    assert error_start(StudyMission("m", with_edges(whole), lowered), STATIC) == exact


def test_all_tables_of_a_mission_with_summaries():
    rows = [(at, 0, 5 if at > 3000 else 1) for at in range(100, 10_000, 100)]
    whole = replace(mission(rows, 9.0), marks=(Mark(5 * SECOND, "II", "a"),))
    tables = {
        t.label: t for t in thesis_tables([StudyMission("m", with_edges(whole), RAISED)], STATIC)
    }
    # 99 evaluations; the first above 3 is at 3.1 s, in the second that begins with 3.0 s.
    assert tables["runtime"].rows[0][1][1] == 99
    assert tables["delays"].rows[0][1] == (3.0, 2.0, 2.0)
    # The only parameter with a score: |cmp - 9| is not constant, so there is one.
    assert tables["found"].rows[0][1][3:5] == (1, 1.0)
