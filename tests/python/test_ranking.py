from __future__ import annotations

from dataclasses import replace

import pytest
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.recording.events import Events
from pytpc.recording.faults import unknown_keys
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries, Summary
from pytpc.static.link_unit import Place
from pytpc.static.parameters import parameter_name

# Comparisons 0 and 1 are of coverage, 2 of faces, 3 of idle, 4 is a constant, 5 of never (which is
# never evaluated), 6 of faces too.
STATIC = static_info(
    comparison(0, "coverage", distance=3),
    comparison(1, "coverage", distance=2),
    comparison(2, "faces", ">=", distance=1),
    comparison(3, "idle", "<", distance=1),
    comparison(4, "", ">", type="constant"),
    comparison(5, "never"),
    comparison(6, "faces"),
)


def recording(rows, marks):
    return Recording("mission", events(rows), tuple(marks), 0, ns(100))


# Flops up to 50 s: comparison 0 at 40 s only, (50-40) * 2 = 20; comparison 1 at 30 and 45 s,
# (50-45) * 3 = 15, so coverage has 15 by comparison 1; comparison 2 at 49 s, 1 * 2 = 2. Comparison
# 3 never flops, 4 is a constant, 5 has no event. Four parameters: faces 1 - 0/4, coverage 1 - 1/4.
ROWS = [
    (10, 0, 0, 0, 4),
    (40, 0, 1, 5, 4),
    (20, 1, 0, 0.1, 0.5),
    (30, 1, 1, 0.6, 0.5),
    (45, 1, 0, 0.2, 0.5),
    (48, 2, 0, 0, 1),
    (49, 2, 1, 1, 1),
    (10, 3, 1, 5, 10),
    (46, 3, 1, 9, 10),
    (49.5, 4, 0, 1, 2),
    (49.6, 4, 1, 3, 2),
]


def test_type1_by_hand():
    (found,) = rank_marks(recording(ROWS, [Mark(ns(50), "I")]), STATIC)
    assert [(s.position, s.parameter, s.key, s.score, s.rank) for s in found.suspects] == [
        (1, "faces", key(2), 2.0, 1.0),
        (2, "coverage", key(1), 15.0, 0.75),
    ]
    assert found.parameters == 4
    assert found.suspects[1].keys == (key(0), key(1))
    assert found.suspects[0].keys == (key(2),)
    last = found.suspects[1].last
    assert (last.time_ns, last.cmp, last.thresh, last.result) == (ns(45), 0.2, 0.5, False)
    assert (last.node, found.suspects[0].comparison.lineno) == ("/node", 12)
    assert (found.position_of("coverage"), found.position_of("idle")) == (2, None)


# Window [38, 50]. Comparison 0: only 40 s, |5-4| / (5-0) = 0.2, one flop: 0.2.
# Comparison 1: only 45 s, 0.3 / 0.5 = 0.6. So coverage has 0.2 by comparison 0.
# Comparison 2: (1 + 0) / 2 / (1 - 0) = 0.5, one flop. Comparison 3: 1 / (10 - 5) = 0.2.
# coverage and idle both have 0.2: they share position and rank; idle is nearer (1 < 3), so it is
# listed first. faces has two before it: 1 - 2/4.
def test_type2_by_hand():
    (found,) = rank_marks(recording(ROWS, [Mark(ns(50), "II")]), STATIC)
    assert [(s.position, s.tied, s.parameter, s.key, s.score, s.rank) for s in found.suspects] == [
        (1, True, "idle", key(3), 0.2, 1.0),
        (1, True, "coverage", key(0), 0.2, 1.0),
        (3, False, "faces", key(2), 0.5, 0.5),
    ]
    assert [(s.rank1, s.rank2) for s in found.suspects] == [(0.0, 1.0), (0.75, 1.0), (1.0, 0.5)]
    assert (found.enough, found.reason) == (True, "")


# Type I ranks: faces 1, coverage 0.75, idle 0. Type II: idle and coverage 1, faces 0.5.
# All have a better rank of 1; the sums are coverage 1.75, faces 1.5, idle 1.
def test_a_mark_without_a_type():
    (found,) = rank_marks(recording(ROWS, [Mark(ns(50), None)]), STATIC)
    assert [(s.position, s.parameter, s.type, s.rank) for s in found.suspects] == [
        (1, "coverage", "II", 1.0),
        (2, "faces", "I", 1.0),
        (3, "idle", "II", 1.0),
    ]
    assert not any(suspect.tied for suspect in found.suspects)
    # The same where the types are not to be believed.
    (again,) = rank_marks(recording(ROWS, [Mark(ns(50), "I")]), STATIC, Question(types="ignore"))
    assert again.suspects == found.suspects


def test_every_mark_has_its_ranking_in_order():
    marks = [Mark(ns(41), "I", "b"), Mark(ns(5), "I"), Mark(ns(60), "II", "a")]
    found = rank_marks(recording(ROWS, marks), STATIC)
    assert [ranking.mark for ranking in found] == marks
    assert found[1].suspects == ()
    # At 41 s only comparison 0 (40 s: (41-40) * 2 = 2) and 1 (30 s: 22) have flopped.
    assert [(s.parameter, s.score) for s in found[0].suspects] == [("coverage", 2.0)]
    assert rank_marks(recording(ROWS, []), STATIC) == []


def test_keys_that_nobody_knows_are_counted_and_left_out():
    rows = [*ROWS, (49.9, 77, 0, 1, 2), (49.95, 77, 1, 3, 2)]
    mission = recording(rows, [Mark(ns(50), "I")])
    assert unknown_keys(mission.events, STATIC) == {key(77): 2}
    assert rank_marks(mission, STATIC) == rank_marks(recording(ROWS, mission.marks), STATIC)


def test_names_of_parameters():
    assert parameter_name(comparison(1, "rate")) == "rate"
    dynamic = comparison(1, "<dynamic>", read_at=Place("src/a.cpp", 8))
    assert parameter_name(dynamic) == "<dynamic> at src/a.cpp:8"


def test_nothing_to_rank():
    mission = Recording("m", Events.empty(), (Mark(5, "I"), Mark(6, None)), 0, 10)
    assert [r.suspects for r in rank_marks(mission, STATIC)] == [(), ()]
    assert [r.suspects for r in rank_marks(mission, static_info())] == [(), ()]


SUMMARY = Summary(
    key=key(0),
    node="/node",
    begin_ns=ns(10),
    end_ns=ns(12),
    count=3,
    flops=0,
    far=3,
    odd=0,
    result=True,
    res=True,
    cmp=7.0,
    thresh=4.0,
    diff_min=-4.0,
    diff_max=3.0,
    diff_mean=1 / 3,
    abs_mean=3.0,
    low=0.0,
    high=8.0,
)


# Under `edges` the log has the first evaluation of comparison 0 alone, and a summary of 2 s whose
# last evaluation was 7 against 4. Its window holds differences 4, 2 and 3 of a spread of 8:
# (4 + 2 + 3) / 3 / 8. At 10.5 s all that is known to be before the mark is the first evaluation.
def test_type2_from_summaries():
    builder = SummaryBuilder()
    builder.add(SUMMARY)
    marks = [Mark(ns(10.5), "II"), Mark(ns(13), "II")]
    mission = replace(recording([(10, 0, 0, 0, 4)], marks), summaries=builder.build())
    early, late = rank_marks(mission, STATIC)
    (suspect,) = late.suspects
    assert (suspect.parameter, suspect.score) == ("coverage", 0.375)
    assert (suspect.last.time_ns, suspect.last.cmp, suspect.last.result) == (ns(12), 7.0, True)
    assert suspect.keys == (key(0),)
    assert [(s.last.time_ns, s.last.cmp) for s in early.suspects] == [(ns(10), 0.0)]


# A recording's summaries have the words of its events, also where a key has no summary.
def test_summaries_that_only_name_a_key():
    names = Summaries.of(
        keys=[key(0), key(1), key(2)], nodes=["/node"], **Summaries.empty().columns()
    )
    mission = replace(recording(ROWS, [Mark(ns(50), "I")]), summaries=names)
    assert rank_marks(mission, STATIC) == rank_marks(recording(ROWS, [Mark(ns(50), "I")]), STATIC)


def test_wrong_arguments():
    mission = recording(ROWS, [Mark(ns(50), "I")])
    with pytest.raises(ValueError, match="types is 'maybe', not one of believe, doubt, ignore"):
        rank_marks(mission, STATIC, Question(types="maybe"))
    with pytest.raises(ValueError, match="window_s is negative"):
        rank_marks(mission, STATIC, Question(window_s=-1))


# The last report is at 10 s, but a summary goes on to 30 s, which at 40 s was 10 s ago, at 43 s 13.
def test_a_summary_is_a_report_up_to_its_end():
    builder = SummaryBuilder()
    builder.add(replace(SUMMARY, end_ns=ns(30)))
    marks = [Mark(ns(20), "II"), Mark(ns(40), "II"), Mark(ns(43), "II")]
    rows = [(10, 0, 0, 0, 4), (9, 2, 0, 0, 1)]
    mission = replace(recording(rows, marks), summaries=builder.build())
    during, after, late = rank_marks(mission, STATIC)
    assert (during.reason, after.reason) == ("", "")
    assert late.reason == "the last report up to the mark is 13 s before it"
