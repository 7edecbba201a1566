"""A flag is not suggested to be switched where something else decided its condition."""

from __future__ import annotations

import pytest
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.suggestion.advise import advise_blamed
from pytpc.diagnosis.suggestion.remedy import remedy
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summary

MARKS = (Mark(ns(20), "II"),)


def condition(line):
    """A flag, and a comparison behind it in the same line."""
    return static_info(
        comparison(0, "use_window", "flag", default=True, source_code=line, lineno=7, column=6),
        comparison(1, "least", ">", source_code=line, lineno=7, column=20),
    )


def flight(flag, counts, least=5):
    """Once a second the flag is asked, and then each of ``counts`` is compared with ``least``."""
    rows = []
    for t, count in enumerate(counts):
        rows.append((t, 0, bool(flag), flag, flag))
        rows.append((t + 0.01, 1, count > least, count, least))
    return Recording("m", events(rows), MARKS, 0, ns(len(counts)))


def tried(line, flag, counts):
    return remedy(flight(flag, counts), condition(line), "use_window", MARKS)


FEW, MANY = [3] * 21, [9] * 21


# Without the window the condition is false, too.
@pytest.mark.parametrize(
    "line", ["if (use_window_ && count > least_) {", "if use_window and count > self.least:"]
)
def test_behind_a_flag_that_is_on_a_comparison_was_false(line):
    found = tried(line, 1, FEW)
    assert found.value is None
    assert found.reason == (
        "switching it would have turned nothing: the comparison with least in the same condition"
        " was false before the mark"
    )
    # At 19 s it was true: without the flag it would not have been.
    assert tried(line, 1, [*FEW[:-2], 9, 3]).value is False


# With it the condition is true, as it was without it.
@pytest.mark.parametrize(
    "line", ["if (use_window_ || count > least_) {", "if use_window or count > self.least:"]
)
def test_behind_a_flag_that_is_off_a_comparison_was_true(line):
    found = tried(line, 0, MANY)
    assert found.value is None
    assert "was true before the mark" in found.reason
    assert tried(line, 0, FEW).value is True


# The operator, or what the outcome means, is not known from the line.
@pytest.mark.parametrize("line", ["if (use_window_ && a || count > least_) {",
    "if (!use_window_ || count > least_) {", "if (use_window_ && !(count > least_)) {",
    "if (use_window_ == (count > least_)) {", "x = use_window ? count > least : 0;", None,
])  # fmt: skip
def test_what_is_not_known_is_not_judged(line):
    assert tried(line, 1, FEW).value is False


# What is not evaluated in the window says nothing, and what stands before the flag was passed.
def test_only_what_comes_after_the_flag_and_in_the_window_counts():
    line = "if (count > least_ && use_window_) {"
    static = static_info(
        comparison(0, "use_window", "flag", default=True, source_code=line, lineno=7, column=30),
        comparison(1, "least", ">", source_code=line, lineno=7, column=6),
    )
    assert remedy(flight(1, FEW), static, "use_window", MARKS).value is False
    late = Question(window_s=0.005)
    log = flight(1, FEW)
    and_line = condition("if (use_window_ && count > least_) {")
    assert remedy(log, and_line, "use_window", MARKS, late).value is False


# A summary without a flop has one outcome; with one, it has both.
@pytest.mark.parametrize(("flops", "value"), [(0, None), (1, False)])
def test_summaries_tell_the_outcome(flops, value):
    builder = SummaryBuilder()
    row = {"count": 9, "flops": flops, "far": 9, "odd": 0, "result": False, "res": False,
           "cmp": 3.0, "thresh": 5.0, "diff_min": -2.0, "diff_max": -2.0, "diff_mean": -2.0,
           "abs_mean": 2.0, "low": 3.0, "high": 5.0}  # fmt: skip
    builder.add(Summary(key(1), "/node", ns(18), ns(18.9), **row))
    flags = events([(t, 0, True, 1, 1) for t in range(21)])
    log = Recording("m", flags, MARKS, 0, ns(21), summaries=builder.build())
    static = condition("if (use_window_ && count > least_) {")
    assert remedy(log, static, "use_window", MARKS).value is value


# A switch whose value is in no evaluation: the log does not say what another case would do.
def test_what_would_turn_no_decision_is_not_suggested():
    static = static_info(comparison(0, "mode", "flag", default=2), comparison(1, "least", ">"))
    rows = [(t, 0, False, 2, 2) for t in range(21)]
    rows += [(t + 0.5, 1, False, 3, 5) for t in range(21)]
    log = Recording("m", events(sorted(rows)), MARKS, 0, ns(21))
    (mode,) = [
        one
        for one in advise_blamed(blame(log, static), log, static)
        if one.accused.parameter == "mode"
    ]
    assert (mode.remedy.value, mode.what_if, mode.stops) == (None, None, False)
    assert mode.remedy.reason == "0 would have turned no decision before the marks"
