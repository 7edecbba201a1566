"""What a log with summaries is read as, so that the default policy has a diagnosis, too."""

from __future__ import annotations

import numpy as np
import pytest
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.recording.summaries import Summary


def summary(begin, end, last, low, high, **changes):
    """Evaluations of ``~gate`` against 5, from ``low`` to ``high``, the last one ``last``."""
    fields = {
        "key": key(0),
        "node": "/node",
        "begin_ns": ns(begin),
        "end_ns": ns(end),
        "count": 10,
        "flops": 0,
        "far": 10,
        "odd": 0,
        "result": last > 5,
        "res": last > 5,
        "cmp": last,
        "thresh": 5.0,
        "diff_min": low - 5.0,
        "diff_max": high - 5.0,
        "diff_mean": 0.0,
        "abs_mean": 1.0,
        "low": min(low, 5.0),
        "high": max(high, 5.0),
    }
    return Summary(**{**fields, **changes})


def read_as(*summaries, rows=((0.0, 0, 0, 1, 5),)):
    builder = SummaryBuilder()
    for one in summaries:
        builder.add(one)
    log = Recording("m", events(rows), (), 0, ns(20), summaries=builder.build())
    found = with_summarised(log)
    return [
        (time / 1e9, cmp, bool(result))
        for time, cmp, result in zip(found.time_ns, found.cmp, found.result, strict=True)
    ]


# From the last value 3 it is 2 to the extreme 1 and 1 to the extreme 4: the farther one is first.
@pytest.mark.parametrize(
    ("last", "low", "high", "values"),
    [(3.0, 1.0, 4.0, [1.0, 4.0, 3.0]), (2.0, 1.0, 4.0, [4.0, 1.0, 2.0])],
)
def test_a_summary_is_its_extremes_and_its_end(last, low, high, values):
    found = read_as(summary(1, 2, last, low, high))
    assert found == [
        (0.0, 1.0, False),
        *((at, value, False) for at, value in zip((1.0, 1.5, 2.0), values, strict=True)),
    ]


def test_of_a_summary_with_flops_or_without_numbers_only_the_end_is_taken():
    assert read_as(summary(1, 2, 6.0, 1.0, 6.0, flops=1))[1:] == [(2.0, 6.0, True)]
    nothing = {"diff_min": np.nan, "diff_max": np.nan, "odd": 10}
    assert read_as(summary(1, 2, 3.0, 3.0, 3.0, **nothing))[1:] == [(2.0, 3.0, False)]
    assert read_as(summary(1, 2, 3.0, 3.0, 3.0, count=1))[1:] == [(2.0, 3.0, False)]


def test_without_summaries_the_log_stays_as_it_is():
    log = Recording("m", events([(0.0, 0, 0, 1, 5)]), (), 0, ns(20))
    assert with_summarised(log) is log.events


# In the good run ~gate was 2, and 3 to 4 would have passed it for 20 s before the marks. Only the
# first evaluation and the summaries say so: by the events alone nothing of it would have turned.
def test_what_differs_is_blamed_from_summaries_alone():
    static = static_info(comparison(0, "~gate"), comparison(1, "~safe"))
    builder = SummaryBuilder()
    for second in range(30):
        builder.add(summary(second, second + 0.9, 1.0, 0.5, 1.0))
    for second in range(30, 60):
        builder.add(summary(second, second + 0.9, 3.5, 3.0, 4.0))
    rows = [(0.0, 0, 0, 1, 5), *((float(t), 1, 0, 1, 9) for t in range(60))]
    marks = tuple(Mark(ns(at), "II") for at in (40, 45, 50, 55))
    log = Recording("m", events(rows), marks, 0, ns(60), summaries=builder.build())
    found = blame(log, static, Question(changes=[Change("~gate", "", 2.0, 5.0)]))
    assert found.accused == "~gate"
    without = Recording("m", events(rows), marks, 0, ns(60))
    assert blame(without, static, Question(changes=[Change("~gate", "", 2.0, 5.0)])).accused is None
