"""All marks together: the verdict in words, and what there is to say where evidence is short."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info

from pytpc.base.wording import percent
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.results.suspects import Accused, Blame, Evaluation
from pytpc.diagnosis.suggestion.advise import advise_blamed
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.recording.summaries import Summary
from pytpc_evaluation.study.case import Case
from pytpc_evaluation.study.methods import METHODS

STATIC = static_info(comparison(0, "~gate"), comparison(1, "~safe"), comparison(2, "~never"))
MARKS = (Mark(ns(33), "I", "ana"), Mark(ns(34), "I", "bob"))


def rows():
    """~gate turns at 30 s of 80, for it grows by 1/80 a second; ~safe stays 8 from its 9."""
    found = []
    for tick in range(160):
        t = tick / 2
        found.append((t, 0, t >= 30, t / 80, 30 / 80))
        found.append((t + 0.01, 1, 0, 1 + 0.1 * math.sin(t), 9))
    return found


def mission(marks=MARKS, **more):
    return Recording("mission", events(rows()), tuple(marks), 0, ns(80), **more)


def accused(probability, parameter="~gate"):
    last = Evaluation(0, True, 1.0, 2.0, True, "/node")
    known = comparison(0, parameter)
    return Accused(1, False, parameter, probability, "I", known.key, known, last)


def said(probability, none):
    return Blame((accused(probability),), none, 3, MARKS, ()).text


def test_other_names_of_the_same_comparisons_change_nothing_but_the_names():
    # By these the parameters stand in the opposite order.
    others = static_info(comparison(0, "/z/gate"), comparison(1, "/a/safe"), comparison(2, "/b"))
    one = mission()
    found = [blame(one, static, Question()) for static in (STATIC, others)]
    assert [suspect.parameter for suspect in found[0].suspects] == ["~gate", "~safe"]
    assert [suspect.parameter for suspect in found[1].suspects] == ["/z/gate", "/a/safe"]
    assert found[0].suspects[0].probability == pytest.approx(found[1].suspects[0].probability)


def test_a_verdict_is_an_accusation_from_eighty_percent_on():
    assert said(0.8, 0.1) == "blame ~gate: 80 %; none of the parameters: 10 %"
    assert said(0.799, 0.1) == "not sure: ~gate is likeliest (80 %); none of the parameters: 10 %"
    assert said(0.3, 0.6) == (
        "not sure: most likely none of the parameters (60 %; perhaps a fault in the code),"
        " then ~gate (30 %)"
    )
    surest = Blame((accused(0.9),), 0.1, 3, MARKS, ())
    assert (surest.accused, surest.confidence) == ("~gate", 0.9)
    assert Blame((accused(0.79),), 0.1, 3, MARKS, ()).accused is None
    nobody = Blame((), 1.0, 3, MARKS, ())
    assert (nobody.accused, nobody.confidence) == (None, 0.0)
    assert nobody.text == "not enough evidence to suspect any parameter"


def test_which_marks_they_are():
    assert blame(mission(), STATIC).title == "All 2 marks of 2 observers together: 2 of type I"
    mixed = [Mark(ns(33), None), Mark(ns(34), "II"), Mark(ns(35), "I"), Mark(ns(36), "I")]
    assert blame(mission(mixed), STATIC).title == (
        "All 4 marks together: 2 of type I, 1 of type II, 1 without a type"
    )
    assert blame(mission(MARKS[:1]), STATIC).title == "The one mark: 1 of type I"


def test_the_parameter_that_turned_before_the_marks():
    found = blame(mission(), STATIC)
    first, second = found.suspects
    assert [(s.position, s.tied, s.parameter) for s in found.suspects] == [
        (1, False, "~gate"),
        (2, False, "~safe"),
    ]
    assert (first.type, first.key) == ("I", STATIC.comparisons[first.key].key)
    # The last evaluation up to 34 s, the last mark.
    assert first.last == Evaluation(ns(34), True, 34 / 80, 30 / 80, True, "/node")
    assert first.probability + second.probability + found.none == pytest.approx(1)
    assert (found.parameters, found.notes) == (3, ())


# Of two parameters that are compared alike none is before the other.
def test_equal_ones_share_a_position():
    alike = [(t, key, t >= 30, t / 80, 30 / 80) for t in range(80) for key in (0, 1)]
    found = blame(Recording("m", events(alike), MARKS, 0, ns(80)), STATIC)
    assert [(s.position, s.tied) for s in found.suspects] == [(1, True), (1, True)]


def test_one_mark_says_little_where_it_is_not_sure():
    still = [(t / 2, 1, 0, 1 + 0.1 * math.sin(t), 9) for t in range(160)]
    one = Recording("m", events(still), (Mark(ns(40), None),), 0, ns(80))
    found = blame(one, STATIC)
    assert found.accused is None
    assert found.notes == ("one mark says little: mark the error each time it happens",)


# The log ends at 79.5 s: 100 s and 200 s are 20.5 and 120 s later. The two others count.
def test_marks_that_have_no_report_are_named():
    late = (*MARKS, Mark(ns(100), "I"), Mark(ns(200), "I"), Mark(ns(200), "II"))
    found = blame(mission(late), STATIC)
    assert found.suspects
    assert found.notes == (
        "mark 3: the last report up to the mark is 20.5 s before it",
        "marks 4, 5: the last report up to the mark is 120 s before it",
    )
    nobody = blame(mission(late[2:]), STATIC)
    assert (nobody.suspects, nobody.none) == ((), 1.0)
    assert nobody.notes[0].startswith("mark 1: ")


def test_nothing_marked_and_nothing_reported():
    assert blame(mission(()), STATIC).suspects == ()
    empty = blame(Recording("m", events([]), MARKS, 0, ns(80)), STATIC)
    assert empty.notes == ("marks 1, 2: no comparison was reported",)


# Without the types the marks say the same of both.
def test_types_that_are_ignored():
    ignored = blame(mission(), STATIC, Question(types="ignore"))
    untyped = blame(mission([Mark(m.time_ns, None, m.observer) for m in MARKS]), STATIC)
    assert ignored.suspects == untyped.suspects != blame(mission(), STATIC).suspects
    assert {mark.type for mark in ignored.marks} == {None}


def same(found, verdict):
    """Whether users get what the study judges."""
    assert tuple(suspect.parameter for suspect in found.suspects) == verdict.order
    return found.confidence == verdict.confidence


# In the good run ~gate's threshold was higher, and ~safe's the same: so it is in the history.
def test_users_get_what_the_study_judges():
    clean = Recording("clean", events([(1, 0, 0, 0.1, 0.9), (2, 1, 0, 1, 9)]), (), 0, ns(80))
    changed = Change("~gate", "/node", 0.9, 0.375)
    case = Case(mission(), STATIC, clean, (changed,))
    alone = blame(mission(), STATIC)
    assert same(alone, METHODS["tpc"](case))
    known = {"references": [clean]}, {"changes": [Change("~gate", "", 0.9, 0.375)]}
    for method, beside in zip(("tpc+reference", "tpc+changes"), known, strict=True):
        found = blame(mission(), STATIC, Question(**beside))
        assert same(found, METHODS[method](case))
        assert found.suspects[0].parameter == "~gate"
        assert found.confidence > alone.confidence


# The good run says that ~safe is what it was, the history that ~gate is. By both it is neither.
def test_a_good_run_and_the_changes_together():
    clean = Recording("clean", events([(1, 0, 0, 0.1, 0.9), (2, 1, 0, 1, 9)]), (), 0, ns(80))
    found = blame(
        mission(), STATIC, Question(references=[clean], changes=[Change("safe", "", 5.0, 9.0)])
    )
    assert blame(mission(), STATIC, Question(references=[clean])).accused == "~gate"
    assert found.accused is None
    assert found.none > 0.5


def test_a_run_that_nobody_watched_vetoes_no_value():
    """It may have gone wrong unseen: with another run the threshold is replayed."""
    clean = Recording("clean", events([(1, 0, 0, 0.1, 0.9), (2, 1, 0, 1, 9)]), (), 0, ns(80))
    unseen = mission(())
    beside = blame(mission(), STATIC, Question(references=[unseen, clean]))
    among = blame(mission(), STATIC, Question(others=[unseen, clean]))
    assert beside.accused is None
    assert among.accused == "~gate"


# Only the changes of results were reported; the rest came as a summary.
def test_summaries_are_told():
    builder = SummaryBuilder()
    builder.add(
        Summary(
            key=key(0),
            node="/node",
            begin_ns=ns(31),
            end_ns=ns(33),
            count=1200,
            flops=0,
            far=1200,
            odd=0,
            cmp=0.4,
            thresh=0.375,
            result=True,
            res=True,
            diff_min=0.0,
            diff_max=0.1,
            diff_mean=0.05,
            abs_mean=0.05,
            low=0.3,
            high=0.4,
        )
    )
    found = blame(mission(summaries=builder.build()), STATIC)
    assert found.notes == (
        "1,200 evaluations came as summaries, of which only the extremes and the last are judged;"
        " TPC_POLICY=every reports them one by one",
    )
    only = Recording("m", events([]), MARKS, 0, ns(80), summaries=builder.build())
    assert [one.parameter for one in blame(only, STATIC).suspects] == ["~gate"]


# ~gate turned at 30 s. To have it not turn before the marks it has to be above 34/80: so says the
# log to all three marks, whatever type was said. People confuse these (table 6.13: 41 of 68).
@pytest.mark.parametrize("types", [("I", "I", "I"), ("II", "II", "II"), ("I", None, "II")])
def test_what_to_do_with_the_first(types):
    marks = (*MARKS, Mark(ns(36), "II"))
    recording = mission(replace(mark, type=kind) for mark, kind in zip(marks, types, strict=True))
    found = blame(recording, STATIC)
    (advice,) = advise_blamed(found.only("gate"), recording, STATIC)
    assert (advice.remedy.kind, advice.remedy.direction) == ("I", "raise")
    assert advice.remedy.value > 34 / 80
    assert advice.what_if is not None
    assert advice.what_if.marks == 3


def test_one_suspect_at_its_place():
    found = blame(mission(), STATIC)
    (first,) = found.only("gate").suspects
    assert first == found.suspects[0]
    (second,) = found.only("/node/safe").suspects
    assert second.position == 2
    assert found.only("speed").suspects == ()


# Whatever the log says: with 0.9 it went right, or with what the good run had. What is no number,
# or was not changed, is no value to try.
def test_the_value_of_before_comes_first():
    recording = mission((*MARKS, Mark(ns(70), "II")))
    clean = Recording("clean", events([(1, 0, 0, 0.1, 0.9), (2, 1, 0, 1, 9)]), (), 0, ns(80))

    def tried(**known):
        found = blame(recording, STATIC, Question(**known))
        (advice,) = advise_blamed(found, recording, STATIC, Question(top=1, **known))
        assert advice.accused.parameter == "~gate"
        return advice.remedy

    before = tried(changes=[Change("gate", "", 0.2, 0.375)])
    assert (before.direction, before.value, before.basis) == ("lower", 0.2, "before")
    assert before.text == (
        "lower ~gate from 0.375 to 0.2 (the value before it was changed; the log alone points the"
        " other way)"
    )
    assert tried(references=[clean]).value == 0.9
    found = blame(recording, STATIC)
    for nothing in (
        Change("gate", "", math.nan, 0.375),
        Change("gate", "", 0.375, 0.375),
        Change("safe", "", 1, 9),
    ):
        (advice,) = advise_blamed(found, recording, STATIC, Question(top=1, changes=[nothing]))
        assert advice.remedy.basis != "before"


# It went right with 0.9; 0.2 was a try in between. With 0.9 ~gate (0.4 at most) does not turn at
# 30 s, with 0.2 it turns earlier: so the order tells which of both is replayed.
def test_of_several_changes_the_oldest_has_the_value_of_before():
    both = [Change("gate", "", 0.9, 0.2), Change("gate", "", 0.2, 0.375)]
    found = blame(mission(), STATIC, Question(changes=both))
    once = [Change("gate", "", 0.9, 0.375)]
    assert found == blame(mission(), STATIC, Question(changes=once))
    assert found != blame(mission(), STATIC, Question(changes=both[1:]))
    (advice,) = advise_blamed(found.only("gate"), mission(), STATIC, Question(changes=both))
    assert (advice.remedy.value, advice.remedy.basis) == (0.9, "before")


def test_percent():
    assert [percent(x) for x in (0, 0.004, 0.006, 0.721, 0.996, 1)] == [
        "0 %",
        "<1 %",
        "1 %",
        "72 %",
        ">99 %",
        "100 %",
    ]


# `v > 10` was never true. Below 5.6 it would have been so once. Of the eight values the median is
# 5.2 and the median deviation 0.15, so below 5.0 - 1.4826 * 0.15 = 4.7776 it would always be. A
# default beyond the smallest change may do, and is known. If it lies the other way, the type of the
# error is more doubtful than the default is.
@pytest.mark.parametrize(
    ("default", "value", "basis"),
    [
        (None, 4.77, "lasting"),
        (5.3, 5.3, "default"),
        (12.0, 12.0, "default"),
    ],
)
def test_a_default_goes_before_the_log(default, value, basis):
    static, log = never_above(default)
    (advice,) = advise_blamed(blame(log, static), log, static)
    assert (advice.remedy.value, advice.remedy.basis) == (value, basis)
    by_log = Question(sources=frozenset())
    (advice,) = advise_blamed(blame(log, static), log, static, by_log)
    assert advice.remedy.basis == "lasting"


# The present value, and one that is not enough.
@pytest.mark.parametrize("default", [10.0, 8.0])
def test_a_default_that_does_nothing_is_none(default):
    static, log = never_above(default)
    (advice,) = advise_blamed(blame(log, static), log, static)
    assert advice.remedy.basis == "lasting"


def test_it_is_said_if_the_log_points_away_from_the_default():
    static, log = never_above(12.0)
    (advice,) = advise_blamed(blame(log, static), log, static)
    assert advice.remedy.text == (
        "raise ~limit from 10 to 12 (the default in the source; the log alone points the other way)"
    )


def never_above(default):
    """A robot that stands: its static information, and a mission with a mark without a type."""
    static = static_info(comparison(0, "~limit", default=default))
    rows = [(90 + n, 0, False, v, 10) for n, v in enumerate((5, 5.2, 5.4, 5.1, 5.6, 5.3, 5, 5.2))]
    return static, Recording("stands", events(rows), (Mark(ns(98), None),), 0, ns(100))
