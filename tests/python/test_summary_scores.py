"""Scores under `edges`: the same number for type I; for type II exact or evenly spread."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from mission_samples import EventBuilder, SummaryBuilder, events, key, ns

from pytpc.diagnosis.scores.scores import NONE, Formula, type1, type2
from pytpc.diagnosis.scores.summary_scores import LogTables, type2_of_summaries
from pytpc.recording.events import Events, Report
from pytpc.recording.summaries import Summaries, Summary

NAN, INF = math.nan, math.inf


class Evaluated(NamedTuple):
    """One evaluation, at a time in milliseconds."""

    ms: int
    node: str
    thread: int
    key: str
    cmp: float
    thresh: float

    @property
    def result(self) -> bool:
        return self.cmp > self.thresh

    @property
    def report(self) -> Report:
        return Report(self.key, self.result, self.cmp, self.thresh, self.result)


def every(run: Sequence[Evaluated]) -> Events:
    builder = EventBuilder()
    for one in run:
        builder.add(one.ms * 10**6, one.node, one.report)
    return builder.build()


def edges(run: Sequence[Evaluated], period_ms: int) -> tuple[Events, Summaries]:
    """The policy, as docs/reference/runtime.md says it: one pass over the evaluations in order."""
    builder = EventBuilder()
    last: dict[tuple[str, str], bool] = {}
    periods = defaultdict(list)
    for one in run:
        site = (one.node, one.key)
        flop = site in last and last[site] != one.result
        if site not in last or flop:
            builder.add(one.ms * 10**6, one.node, one.report)
        last[site] = one.result
        periods[one.node, one.thread, one.key, one.ms // period_ms].append((one, flop))
    summaries = SummaryBuilder()
    for (node, _, name, _), taken in periods.items():
        summaries.add(summary(node, name, taken))
    return builder.build(), summaries.build()


def summary(node: str, name: str, taken: list[tuple[Evaluated, bool]]) -> Summary:
    end = taken[-1][0]
    good = [one for one, _ in taken if math.isfinite(one.cmp) and math.isfinite(one.thresh)]
    diffs = [one.cmp - one.thresh for one in good] or [NAN]
    values = [value for one in good for value in (one.cmp, one.thresh)] or [NAN]
    return Summary(
        key=name,
        node=node,
        begin_ns=taken[0][0].ms * 10**6,
        end_ns=end.ms * 10**6,
        count=len(taken),
        flops=sum(flop for _, flop in taken),
        far=sum(abs(diff) > 1e-4 for diff in diffs),
        odd=len(taken) - len(good),
        result=end.result,
        res=end.result,
        cmp=end.cmp,
        thresh=end.thresh,
        diff_min=min(diffs),
        diff_max=max(diffs),
        diff_mean=sum(diffs) / len(diffs),
        abs_mean=sum(abs(diff) for diff in diffs) / len(diffs),
        low=min(values),
        high=max(values),
    )


KEYS = ("k0", "k1")
VALUES = st.one_of(
    st.floats(-10, 10).map(lambda x: round(x, 3)),
    st.sampled_from([NAN, INF, -INF, 0.0, 1.0, 1.0 + 5e-5, 1e300, -1e300, 1.5e308, -1.5e308]),
)
THRESHOLDS = st.one_of(st.just(1.0), st.just(1.0), VALUES)


@st.composite
def runs(draw: st.DrawFn) -> list[Evaluated]:
    """Two nodes with up to three threads each, two keys; no two evaluations at the same time."""
    steps = draw(st.lists(st.integers(1, 400), min_size=1, max_size=60))
    smooth = draw(st.booleans())
    run = []
    ms = 0
    for step in steps:
        ms += step
        value = draw(st.floats(0.5, 1.5)) if smooth else draw(VALUES)
        run.append(
            Evaluated(
                ms=ms,
                node=draw(st.sampled_from(["/a", "/b"])),
                thread=draw(st.integers(1, 3)),
                key=draw(st.sampled_from(KEYS)),
                cmp=value,
                thresh=1.0 if smooth else draw(THRESHOLDS),
            )
        )
    return run


def straddled(summaries: Summaries, key_name: str, begin: int, mark: int) -> bool:
    """Whether any summary of the key has an end of the window strictly inside of its span."""
    rows = [row for row in range(len(summaries)) if summaries.keys[summaries.key[row]] == key_name]
    spans = [(summaries.begin_ns[row], summaries.end_ns[row]) for row in rows]
    return any(low < begin <= high or low <= mark < high for low, high in spans)


@given(
    runs(),
    st.sampled_from([20, 100, 1000]),
    st.lists(st.integers(0, 12_000), min_size=1, max_size=12),
    st.sampled_from([0.0, 0.3, 1.0, 12.0]),
    st.sampled_from([{}, {"gamma": 1.0}, {"alpha": 2.0, "beta": 0.5, "delta": 1.0, "gamma": 0.5}]),
)
@settings(max_examples=400, deadline=None)
@example([Evaluated(1, "/a", 1, "k0", 1e308, -1e308)], 100, [1, 2], 1.0, {})
@example(
    [Evaluated(1, "/a", 1, "k0", 0.0, 1.0), Evaluated(2, "/a", 1, "k0", 1.5e308, 1.0)],
    20,
    [1],
    0.0,
    {},
)
def test_edges_gives_the_scores_of_every_evaluation(run, period_ms, marks_ms, window_s, powers):
    whole = every(run).with_keys(KEYS)
    some, summaries = edges(run, period_ms)
    some = some.with_keys(KEYS)
    marks = [ms * 10**6 for ms in marks_ms]
    distance = [2, 4]
    assert np.array_equal(type1(whole, marks, distance), type1(some, marks, distance))
    exact = type2(whole, marks, distance, Formula(window_s=window_s, **powers))
    formula = Formula(window_s=window_s, **powers)
    found = type2_of_summaries(LogTables(some, summaries), marks, distance, formula)
    assert np.isfinite(found).all()
    largest = max((abs(v) for one in run for v in one[4:] if math.isfinite(v)), default=0.0)
    if largest >= 1e300:
        return
    for row, mark in enumerate(marks):
        begin = mark - round(window_s * 1e9)
        for code, name in enumerate(KEYS):
            score = found[row, code]
            if not straddled(summaries, name, begin, mark):
                assert score == pytest.approx(exact[row, code], rel=1e-9)
            ratio = evenly_spread(some, summaries, name, (begin, mark))
            if ratio is None:
                assert score == NONE
            elif not powers:
                flops = some.flop & (some.key == code)
                flops &= (some.time_ns >= begin) & (some.time_ns <= mark)
                assert score == pytest.approx(ratio * max(1, int(flops.sum())), rel=1e-9)


def evenly_spread(
    some: Events, summaries: Summaries, name: str, window: tuple[int, int]
) -> float | None:
    """D of the definition, summary by summary; None where there is nothing to tell it from."""
    begin, mark = window
    number = total = 0.0
    ended, begun = set(), set()
    for row in np.flatnonzero(some.key == KEYS.index(name)):
        both = {float(some.cmp[row]), float(some.thresh[row])}
        if some.time_ns[row] <= mark and all(map(math.isfinite, both)):
            ended |= both
    mine = [row for row in range(len(summaries)) if summaries.keys[summaries.key[row]] == name]
    for row in mine:
        count = int(summaries.count[row] - summaries.odd[row])
        first, last = int(summaries.begin_ns[row]), int(summaries.end_ns[row])
        if not count:
            continue
        values = {float(summaries.low[row]), float(summaries.high[row])}
        begun |= values if first <= mark else set()
        ended |= values if last <= mark else set()
        if last < begin or first > mark:
            continue
        inside = min(last, mark) - max(first, begin)
        share = 1.0 if first == last else max(inside / (last - first), 1e-200)
        number += share * count
        total += share * count * float(summaries.abs_mean[row])
    begun |= ended
    spread = max(ended) - min(ended) if ended else 0.0
    spread = spread or (max(begun) - min(begun) if begun else 0.0)
    return min(1.0, total / number / spread) if number and spread else None


def by_hand(**changed: float) -> Summary:
    """Evaluations from 0.5 to 1.5 s whose differences are 1, 2 and 3; values from 0 to 4."""
    columns = {
        "key": key(0),
        "node": "/node",
        "begin_ns": ns(0.5),
        "end_ns": ns(1.5),
        "count": 3,
        "flops": 0,
        "far": 3,
        "odd": 0,
        "result": True,
        "res": True,
        "cmp": 4.0,
        "thresh": 1.0,
        "diff_min": 1.0,
        "diff_max": 3.0,
        "diff_mean": 2.0,
        "abs_mean": 2.0,
        "low": 0.0,
        "high": 4.0,
    }
    return Summary(**(columns | changed))


LATER = by_hand(
    begin_ns=ns(2), end_ns=ns(2.5), count=2, far=2, diff_min=1.0, diff_max=1.0, abs_mean=1.0
)


def table(*summaries: Summary) -> Summaries:
    builder = SummaryBuilder()
    for one in summaries:
        builder.add(one)
    return builder.build()


# The window [1, 3] holds LATER (2 evaluations, sum 2) and cuts the other one, of which it has half
# the span: half of 3 evaluations, which sum to half of 6. The spread is 4: (2 + 3) / (2 + 1.5) / 4,
# and n_i is 2 + 1.5.
def test_a_summary_that_the_window_cuts():
    first = events([(0.5, 0, 1, 2, 1)])
    both = table(by_hand(), LATER)
    (score,) = type2_of_summaries(LogTables(first, both), [ns(3)], [1], Formula(2))
    assert score == pytest.approx([5 / 14], rel=1e-12)
    formula = Formula(2, alpha=0, gamma=1)
    assert type2_of_summaries(LogTables(first, both), [ns(3)], [1], formula) == pytest.approx(3.5)


# w = 2.5: both are within [0.5, 3]: (6 + 2) / 5 / 4 = 0.4.
def test_a_summary_within_the_window_is_exact():
    scores = type2_of_summaries(
        LogTables(events([(0.5, 0, 1, 2, 1)]), table(by_hand(), LATER)), [ns(3)], [1], Formula(2.5)
    )
    assert scores == pytest.approx(0.4, rel=1e-12)


# At 1 s the summary has begun; what is known is its first evaluation (2 - 1, spread 1). The mean
# difference is 2, and none can be more than the spread.
def test_a_mark_within_a_period():
    both = LogTables(events([(0.5, 0, 1, 2, 1)]), table(by_hand()))
    assert type2_of_summaries(both, [ns(1)], [1]) == 1.0
    # Without that event nothing has ended: the spread is that of what has begun, 4.
    alone = LogTables(Events.empty([key(0)]), table(by_hand()))
    assert type2_of_summaries(alone, [ns(1)], [1]) == 0.5
    # At its very begin, none of the span is in the window: the mean stands for what is.
    assert type2_of_summaries(alone, [ns(0.5)], [1]) == 0.5


def test_without_summaries_it_is_type2():
    some = events([(0, 0, 1, 10, 4), (5, 0, 1, 6, 4), (8, 0, 1, 5, 4), (20, 0, 1, 4.5, 4)])
    scores = type2_of_summaries(LogTables(some, Summaries.empty()), [ns(20), ns(8)], [1])
    assert scores[:, 0].tolist() == [0.125, 0.5]


# The policy was `every` until 0.4 s: those two evaluations are in no summary and count by
# themselves, with differences 3 and 3: (3 + 3 + 6 + 2) / 7 / 4. The flop that is 20 ms before the
# summary is in it, as on /rosout where a report has the time of its writing.
def test_both_policies_in_one_recording():
    mixed = events([(0.1, 0, 1, 4, 1), (0.3, 0, 1, 4, 1), (0.48, 0, 0, 0, 1)])
    scores = type2_of_summaries(LogTables(mixed, table(by_hand(), LATER)), [ns(3)], [1])
    assert scores == pytest.approx(14 / 7 / 4)


def test_a_node_without_summaries_beside_one_that_has_them():
    mixed = events([(0.5, 0, 1, 2, 1), (1, 0, 1, 4, 1, "/other"), (1.2, 0, 1, 4, 1, "/other")])
    scores = type2_of_summaries(LogTables(mixed, table(by_hand(), LATER)), [ns(3)], [1])
    assert scores == pytest.approx((6 + 2 + 3 + 3) / 7 / 4)


# One summary in a hundred is as long as the mission (a clock that jumped): it is not overlooked.
def test_one_long_summary_among_many_short_ones():
    short = [
        by_hand(begin_ns=ns(n), end_ns=ns(n + 0.5), abs_mean=1.0, diff_max=1.0) for n in range(300)
    ]
    long = by_hand(begin_ns=ns(0.2), end_ns=ns(400), count=2, diff_min=3, diff_max=3, abs_mean=3)
    scores = type2_of_summaries(
        LogTables(events([(0, 0, 1, 2, 1)]), table(long, *short)), [ns(100.8)], [1], Formula(1.0)
    )
    # [99.8, 100.8] holds one short summary, 3 of 1, and 1 s of the 399.8 s of the long one, 2 of 3.
    share = 1 / 399.8
    assert scores == pytest.approx((3 + 6 * share) / (3 + 2 * share) / 4, rel=1e-12)
