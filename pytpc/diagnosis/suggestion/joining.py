"""Advice for several marks at once: marks with the same answer are joined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.results.advice import Advice, JoinedAdvice, MarkGroup, Remedy, WhatIf
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.suggestion.advise import advise
from pytpc.diagnosis.suggestion.remedy import remedy
from pytpc.diagnosis.suggestion.what_if import what_if
from pytpc.diagnosis.thresholds.intervals import holds
from pytpc.recording.marks import Mark, MarkType
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True, slots=True)
class _Agreed:
    """The advice that does at the most marks, at how many it was named, and at how many it does."""

    advice: Advice
    named: int
    count: int


@dataclass
class _OpenGroup:
    marks: list[Mark] = field(default_factory=list)
    lists: list[list[Advice]] = field(default_factory=list)
    reasons: list[str] = field(default_factory=list)


def join_advice(
    recording: Recording,
    static_info: StaticInfo,
    rankings: Sequence[MarkRanking],
    question: Question = PLAIN,
) -> list[MarkGroup]:
    """The advice for all marks, those that say the same together, in the order of the first ones.

    The arguments are those of `pytpc.diagnosis.suggestion.advise.advise`, with the rankings of
    several marks.
    """
    groups: dict[tuple[object, ...], _OpenGroup] = {}
    for ranking in rankings:
        advice = advise(recording, static_info, ranking, question)
        group = groups.setdefault(_says(ranking.mark, advice), _OpenGroup())
        group.marks.append(ranking.mark)
        group.lists.append(advice)
        if ranking.reason and ranking.reason not in group.reasons:
            group.reasons.append(ranking.reason)
    return [
        MarkGroup(
            tuple(group.marks),
            group.marks[0].type,
            tuple(
                JoinedAdvice(
                    one.advice,
                    one.named,
                    one.count,
                    *_tried(recording, static_info, group.marks, one.advice, question),
                )
                for one in _joined(group.lists, question.top)
            ),
            tuple(group.reasons),
        )
        for group in groups.values()
    ]


def with_remedies(
    recording: Recording,
    static_info: StaticInfo,
    rankings: Sequence[MarkRanking],
    lists: Sequence[Sequence[Advice]],
    question: Question = PLAIN,
) -> list[list[Advice]]:
    """The advice for each mark with the values to try, the same as ``join_advice`` has.

    They are from all the marks that say the same.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        rankings: of its marks.
        lists: for each the advice for its first suspects.
        question: its ``window_s``; a good run is not looked at.
    """
    alone = replace(question, reference=None, flown=())
    marks: dict[tuple[object, ...], list[Mark]] = {}
    for ranking, advice in zip(rankings, lists, strict=True):
        marks.setdefault(_says(ranking.mark, advice), []).append(ranking.mark)
    known: dict[tuple[object, ...], tuple[Remedy, WhatIf | None]] = {}
    found = []
    for ranking, advice in zip(rankings, lists, strict=True):
        says, filled = _says(ranking.mark, advice), []
        for one in advice:
            place = (says, one.suspect.parameter, one.suspect.type)
            if place not in known:
                known[place] = _tried(recording, static_info, marks[says], one, alone)
            filled.append(replace(one, remedy=known[place][0], tried=known[place][1]))
        found.append(filled)
    return found


def _says(mark: Mark, advice: Sequence[Advice]) -> tuple[object, ...]:
    """What marks say that are joined: the type, the first suspect and what to do with it."""
    if not advice:
        return (mark.type,)
    first = advice[0]
    return (
        mark.type, first.suspect.parameter, first.suspect.type, first.suggestion.direction,
    )  # fmt: skip


def _tried(
    recording: Recording,
    static_info: StaticInfo,
    marks: Sequence[Mark],
    advice: Advice,
    question: Question,
) -> tuple[Remedy, WhatIf | None]:
    """The value to try, by the type that the parameter is suspected for."""
    kind = advice.suspect.type
    typed = [replace(mark, type=kind) for mark in marks]
    name = advice.suspect.parameter
    found = remedy(recording, static_info, name, typed, question.about(advice.declared))
    then = None
    if found.value is not None:
        replay = question.replayed(kind, typed)
        then = what_if(recording, static_info, name, found.value, replay)
    return found, then


def _joined(lists: Sequence[Sequence[Advice]], top: int) -> list[_Agreed]:
    """The first suspects of all lists; one that a list does not have stands behind its last."""
    found: dict[tuple[str, MarkType], list[Advice]] = {}
    places: dict[tuple[str, MarkType], int] = {}
    for some in lists:
        for advice in some:
            name = (advice.suspect.parameter, advice.suspect.type)
            found.setdefault(name, []).append(advice)
            places[name] = places.get(name, 0) + advice.suspect.position - top - 1
    order = sorted(found, key=lambda name: (places[name], name))
    return [_most_agreed(found[name]) for name in order[:top]]


def _most_agreed(same: Sequence[Advice]) -> _Agreed:
    """That of several suggestions for one parameter which would do at the most marks."""
    best, most = same[0], 0
    for advice in same:
        value = advice.suggestion.value
        if value is None:
            continue
        count = sum(holds(other.suggestion.feasible, float(value)) for other in same)
        if count > most:
            best, most = advice, count
    return _Agreed(best, len(same), most)
