"""Advice for several marks at once: marks that say the same need one answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from pytpc.advice.advise import Advice, advise
from pytpc.advice.counterfactual import WhatIf, what_if
from pytpc.advice.declared import Declared
from pytpc.advice.intervals import holds
from pytpc.advice.remedy import Remedy, remedy
from pytpc.ingest.recording import Recording
from pytpc.marks import Mark, MarkType
from pytpc.scoring.ranking import MarkRanking
from pytpc.scoring.scores import WINDOW_S
from pytpc.static_info import StaticInfo


@dataclass(frozen=True, slots=True)
class JoinedAdvice:
    """One parameter at the marks of a group, with the advice that does at the most of them.

    It is a suspect at ``named`` of the marks, and the suggested value would do at ``agreed``.
    ``remedy`` is the value to try, from all marks of the group together, and ``what_if`` what it
    would have changed, None where there is none.
    """

    advice: Advice
    named: int
    agreed: int
    remedy: Remedy
    what_if: WhatIf | None


@dataclass(frozen=True, slots=True)
class MarkGroup:
    """Marks of one type whose first suspect and the direction of its suggestion are the same.

    ``suspects`` are ordered by their mean position. ``reasons`` say at which marks there is not
    enough evidence, and why.
    """

    marks: tuple[Mark, ...]
    type: MarkType | None
    suspects: tuple[JoinedAdvice, ...]
    reasons: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Agreed:
    """The advice that does at the most marks, at how many it was named, and at how many it does."""

    advice: Advice
    named: int
    count: int


@dataclass
class _Open:
    marks: list[Mark] = field(default_factory=list)
    lists: list[list[Advice]] = field(default_factory=list)
    reasons: list[str] = field(default_factory=list)


def join_advice(
    recording: Recording,
    static_info: StaticInfo,
    rankings: Sequence[MarkRanking],
    *,
    top: int = 5,
    declared: Sequence[Declared] = (),
    reference: Recording | None = None,
    flown: Sequence[float] = (),
    window_s: float = WINDOW_S,
) -> list[MarkGroup]:
    """The advice for all marks, those that say the same together, in the order of the first ones.

    The arguments are those of `pytpc.advice.advise.advise`, with the rankings of several marks,
    ``reference``, a mission that went right, and ``flown``, values of the one suspect that did not
    help.
    """
    groups: dict[tuple[object, ...], _Open] = {}
    for ranking in rankings:
        advice = advise(
            recording, static_info, ranking, top=top, declared=declared, window_s=window_s
        )
        first = advice[0] if advice else None
        same = (
            ranking.mark.type,
            first and (first.suspect.parameter, first.suspect.type, first.suggestion.direction),
        )
        group = groups.setdefault(same, _Open())
        group.marks.append(ranking.mark)
        group.lists.append(advice)
        if ranking.reason and ranking.reason not in group.reasons:
            group.reasons.append(ranking.reason)
    return [
        MarkGroup(
            tuple(group.marks),
            group.marks[0].type,
            tuple(
                _with_remedy(
                    recording,
                    static_info,
                    group.marks,
                    advice,
                    reference=reference,
                    flown=flown,
                    window_s=window_s,
                )
                for advice in _joined(group.lists, top)
            ),
            tuple(group.reasons),
        )
        for group in groups.values()
    ]


def _with_remedy(
    recording: Recording,
    static_info: StaticInfo,
    marks: Sequence[Mark],
    agreed: _Agreed,
    *,
    reference: Recording | None,
    flown: Sequence[float],
    window_s: float,
) -> JoinedAdvice:
    """What was agreed on with the value to try, by the type that the parameter is suspected for."""
    advice, kind = agreed.advice, agreed.advice.suspect.type
    typed = [replace(mark, type=kind) for mark in marks]
    name = advice.suspect.parameter
    found = remedy(
        recording,
        static_info,
        name,
        typed,
        reference=reference,
        declared=advice.declared,
        flown=flown,
        window_s=window_s,
    )
    then = None
    if found.value is not None:
        then = what_if(
            recording, static_info, name, found.value, kind=kind, marks=typed, window_s=window_s
        )
    return JoinedAdvice(advice, agreed.named, agreed.count, found, then)


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
