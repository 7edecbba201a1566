"""Advice for the suspects at marks, one by one and joined."""

from __future__ import annotations

import json
from dataclasses import replace

from mission_samples import comparison, events, ns, static_info

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.suggestion.advise import advise, alternatives, join_advice
from pytpc.present.as_json import advice_json, group_json
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording

# `faces >= limit` of 3 flops at 10 s (2, then 4) and at 12 s back (1); `coverage > cover` of 0.6
# stays False at 0.3 until 16 s and at 0.5 until 20 s. Marks of type I at 11 s, of type II at 16 and
# 20 s.
STATIC = static_info(comparison(0, "~limit", ">=", default=3), comparison(1, "~cover"))
FACES = [(1, 2), (10, 4), (11.5, 4), (12, 1)]
COVER = [(t, 0.3 if t <= 16 else 0.5) for t in range(1, 21)]
MARKS = (Mark(ns(11), "I"), Mark(ns(16), "II"), Mark(ns(20), "II"))


def mission(marks=MARKS, static=STATIC):
    rows = [(t, 0, cmp >= 3, cmp, 3) for t, cmp in FACES]
    rows += [(t, 1, cmp > 0.6, cmp, 0.6) for t, cmp in COVER]
    recording = Recording("mission", events(rows), tuple(marks), 0, ns(20))
    return recording, rank_marks(recording, static)


def declared(low, high):
    return Declared("/node/cover", "double", low, high, None, None, (), "", "topic /node")


def one(rankings, mark, parameter):
    """The ranking of one mark with one suspect."""
    ranking = rankings[mark]
    suspects = tuple(s for s in ranking.suspects if s.parameter == parameter)
    assert len(suspects) == 1
    return replace(ranking, suspects=suspects)


# At 11 s the last flop is that at 10 s: 4 >= limit is False above 4, and 2 is, too. At 16 s 0.3 is
# greater than what is below 0.3; at 20 s so is 0.5 than what is below 0.5. 0.299 is below both, and
# turns all 20 evaluations, those of 0.3 and those of 0.5, all of which are near: the windows are
# [-1, 11], [4, 16] and [8, 20].
def test_suggestion_and_what_it_would_have_changed():
    recording, rankings = mission()
    (faces,) = advise(recording, STATIC, one(rankings, 0, "~limit"))
    assert (faces.suggestion.direction, faces.suggestion.value) == ("raise", 5)
    assert faces.what_if is not None
    # 4 at 10 s is near, 4 at 11.5 s, too ([8, 20]).
    assert (faces.what_if.marks, faces.what_if.answered) == (1, 1)
    assert (faces.what_if.flipped_near, faces.what_if.flipped_away) == (2, 0)
    (cover,) = advise(recording, STATIC, one(rankings, 1, "~cover"))
    assert cover.suggestion.value == 0.299
    assert cover.what_if is not None
    assert (cover.what_if.marks, cover.what_if.answered) == (2, 2)
    assert (cover.what_if.flipped_near, cover.what_if.flipped_away) == (20, 0)
    (later,) = advise(recording, STATIC, one(rankings, 2, "~cover"))
    assert later.suggestion.value == 0.499
    assert later.what_if is not None
    # 0.3 at 16 s is not greater than 0.499: that mark is not answered.
    assert (later.what_if.marks, later.what_if.answered) == (2, 1)
    assert (later.what_if.flipped_near, later.what_if.flipped_away) == (4, 0)


def test_the_declared_range_counts():
    recording, rankings = mission()
    (found,) = advise(
        recording, STATIC, one(rankings, 1, "~cover"), Question(declared=[declared(0.4, 1)])
    )
    assert found.declared == declared(0.4, 1)
    assert found.what_if is None
    assert found.suggestion.reason == "no value in the declared range 0.4..1 would do: below 0.3"
    (inside,) = advise(
        recording, STATIC, one(rankings, 1, "~cover"), Question(declared=[declared(0, 1)])
    )
    assert inside.suggestion.value == 0.299


def test_so_many_and_no_more():
    recording, rankings = mission()
    assert advise(recording, STATIC, rankings[1], Question(top=0)) == []
    assert len(advise(recording, STATIC, rankings[1], Question(top=1))) == 1
    names = [a.suspect.parameter for a in advise(recording, STATIC, rankings[1])]
    assert names == [s.parameter for s in rankings[1].suspects]


# A ranking at a time that is no mark of the recording (`rank --at`) counts as one more mark.
def test_a_mark_that_is_not_recorded():
    recording, _ = mission()
    other = replace(recording, marks=(Mark(ns(13), "II"),))
    ranking = one(rank_marks(other, STATIC), 0, "~cover")
    (found,) = advise(recording, STATIC, ranking)
    assert found.what_if is not None
    assert (found.what_if.marks, found.what_if.answered) == (3, 3)


# A second comparison of the same parameter, height > cover with 0.4 and 0.6: below 0.4. The first
# suspect's suggestion is by the one, the alternative by the other.
def test_alternatives_are_the_other_comparisons():
    static = static_info(comparison(1, "~cover"), comparison(2, "~cover"))
    rows = [(t, 1, False, 0.3, 0.6) for t in range(1, 10)]
    rows += [(t, 2, False, 0.4 if t % 2 else 0.1, 0.6) for t in range(1, 10)]
    recording = Recording("mission", events(rows), (Mark(ns(9), "II"),), 0, ns(9))
    ranking = rank_marks(recording, static)[0]
    (first,) = advise(recording, static, ranking)
    (other,) = alternatives(recording, static, ranking, ranking.suspects[0])
    assert {first.suggestion.value, other.suggestion.value} == {0.299, 0.399}
    assert first.suspect.key != other.suspect.key
    assert other.suspect.comparison.key == other.suspect.key
    # Another comparison that says the same is no alternative.
    same = static_info(comparison(1, "~cover"), comparison(3, "~cover"))
    rows = [(t, key, False, 0.3, 0.6) for t in range(1, 10) for key in (1, 3)]
    rows += [(5.5, key, False, 0.2, 0.6) for key in (1, 3)]
    recording = Recording("mission", events(rows), (Mark(ns(9), "II"),), 0, ns(9))
    ranking = rank_marks(recording, same)[0]
    assert alternatives(recording, same, ranking, ranking.suspects[0]) == []


def only_cover(rankings):
    return [one(rankings, 1, "~cover"), one(rankings, 2, "~cover")]


# Both marks of type II want a lower limit: 0.299 does at both, 0.499 at one.
def test_marks_that_say_the_same_are_joined():
    recording, rankings = mission()
    groups = join_advice(recording, STATIC, [one(rankings, 0, "~limit"), *only_cover(rankings)])
    assert [len(group.marks) for group in groups] == [1, 2]
    assert [group.type for group in groups] == ["I", "II"]
    (cover,) = groups[1].suspects
    assert cover.advice.suggestion.value == 0.299
    assert (cover.named, cover.agreed) == (2, 2)
    # In the other order, too.
    backwards = join_advice(recording, STATIC, only_cover(rankings)[::-1])
    assert backwards[0].suspects[0].advice.suggestion.value == 0.299


# At 20 s the first suspect is another one: the marks do not say the same.
def test_marks_that_say_something_else_stay_apart():
    recording, rankings = mission()
    apart = join_advice(
        recording, STATIC, [rankings[1], one(rankings, 2, "~cover")], Question(top=1)
    )
    first = rankings[1].suspects[0].parameter
    assert len(apart) == (1 if first == "~cover" else 2)
    empty = replace(rankings[2], suspects=(), reason="nothing")
    groups = join_advice(recording, STATIC, [one(rankings, 1, "~cover"), empty])
    assert [len(group.suspects) for group in groups] == [1, 0]
    assert groups[1].reasons == ("nothing",)


# At both marks ~cover is first; ~limit is second at 16 s and not among the first at 20 s. In the
# mean of both ~cover is before it.
def test_the_order_of_joined_suspects():
    recording, rankings = mission()
    cover, faces = one(rankings, 1, "~cover").suspects[0], one(rankings, 1, "~limit").suspects[0]
    both = (replace(cover, position=1), replace(faces, position=2))
    first = replace(rankings[1], suspects=both)
    (group,) = join_advice(recording, STATIC, [first, one(rankings, 2, "~cover")], Question(top=2))
    names = [(one.advice.suspect.parameter, one.named) for one in group.suspects]
    assert names == [("~cover", 2), ("~limit", 1)]
    (group,) = join_advice(recording, STATIC, [first], Question(top=2))
    assert [one.advice.suspect.parameter for one in group.suspects] == ["~cover", "~limit"]


# Two marks at which the same would do: the advice is that of the earlier one.
def test_of_advice_as_good_the_first():
    recording, rankings = mission((Mark(ns(15), "II"), Mark(ns(16), "II")))
    same = [one(rankings, 0, "~cover"), one(rankings, 1, "~cover")]
    (group,) = join_advice(recording, STATIC, same)
    assert group.suspects[0].advice.suspect == same[0].suspects[0]
    assert group.suspects[0].agreed == 2


# Where the range leaves a value at neither mark there is still one that says why.
def test_joined_without_a_value():
    recording, rankings = mission()
    (group,) = join_advice(
        recording, STATIC, only_cover(rankings), Question(declared=[declared(0.55, 1)])
    )
    (cover,) = group.suspects
    assert (cover.named, cover.agreed) == (2, 0)
    assert cover.advice.suggestion.reason is not None


def test_json_has_no_number_that_json_lacks():
    recording, rankings = mission()
    (group,) = join_advice(
        recording, STATIC, only_cover(rankings), Question(declared=[declared(0, 1)])
    )
    text = json.dumps(group_json(group, 0), allow_nan=False)
    found = json.loads(text)
    assert [mark["seconds"] for mark in found["marks"]] == [16, 20]
    cover = found["suspects"][0]
    assert cover["suggestion"]["feasible"] == [
        {"low": None, "high": 0.3, "low_inclusive": False, "high_inclusive": False}
    ]
    assert (cover["named"], cover["agreed"]) == (2, 2)
    assert cover["what_if"]["answered"] == 2
    assert cover["declared"]["high"] == 1
    (none,) = advise(
        recording, STATIC, one(rankings, 1, "~cover"), Question(declared=[declared(0.4, 1)])
    )
    assert advice_json(none)["what_if"] is None
