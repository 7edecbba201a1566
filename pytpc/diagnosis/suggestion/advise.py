"""The advice for suspects: at one mark, for marks that say the same, and for all together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from pytpc.base.wording import Number, show, shown_value
from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.results.advice import (
    Advice,
    BlamedAdvice,
    JoinedAdvice,
    MarkGroup,
    Remedy,
    Suggested,
    Suggestion,
    WhatIf,
)
from pytpc.diagnosis.results.differences import Difference
from pytpc.diagnosis.results.suspects import (
    Accused,
    Blame,
    MarkRanking,
    Suspect,
    Uncompared,
)
from pytpc.diagnosis.suggestion.known_values import defaults
from pytpc.diagnosis.suggestion.remedy import NAMES, remedy, restored
from pytpc.diagnosis.suggestion.smallest_change import At, smallest_change
from pytpc.diagnosis.suggestion.what_if import what_if
from pytpc.diagnosis.thresholds.intervals import holds
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark, MarkType
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo

if TYPE_CHECKING:
    from pathlib import PurePath


def advise(
    recording: Recording,
    static_info: StaticInfo,
    ranking: MarkRanking,
    question: Question = PLAIN,
) -> list[Advice]:
    """Advice for the first suspects at a mark, in their order.

    The replay looks at the marks of the suspect's type, at those without a type, and at this mark.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        ranking: the suspects at a mark of the recording.
        question: its ``top``, ``declared`` and ``window_s``.
    """
    return [
        _advice(recording, static_info, ranking.mark, suspect, question)
        for suspect in ranking.suspects[: question.top]
    ]


def smallest_changes_at(
    recording: Recording,
    static_info: StaticInfo,
    ranking: MarkRanking,
    question: Question = PLAIN,
) -> list[Suggested]:
    """The first suspects at a mark, each with its suggestion; arguments as of ``advise``."""
    return [
        Suggested(suspect, _suggested(recording, static_info, ranking.mark, suspect, question)[0])
        for suspect in ranking.suspects[: question.top]
    ]


def alternatives(
    recording: Recording,
    static_info: StaticInfo,
    ranking: MarkRanking,
    suspect: Suspect,
    question: Question = PLAIN,
) -> list[Advice]:
    """What else may be done about a suspect: by the other comparisons of its parameter.

    Each has ``suspect`` as it is with another ``key`` and ``comparison``; those that suggest the
    same value, or none, are left out.
    """
    said, _ = _suggested(recording, static_info, ranking.mark, suspect, question)
    known = {(said.direction, said.value)}
    found = []
    for key in suspect.keys:
        if key == suspect.key:
            continue
        other = replace(suspect, key=key, comparison=static_info.comparisons[key])
        advice = _advice(recording, static_info, ranking.mark, other, question)
        what = (advice.suggestion.direction, advice.suggestion.value)
        if what[0] is not None and what not in known:
            known.add(what)
            found.append(advice)
    return found


def _advice(
    recording: Recording,
    static_info: StaticInfo,
    mark: Mark,
    suspect: Suspect,
    question: Question,
) -> Advice:
    suggestion, about = _suggested(recording, static_info, mark, suspect, question)
    if suggestion.value is None:
        return Advice(suspect, suggestion, None, about)
    marks = [one for one in recording.marks if one.type in {suspect.type, None} or one == mark]
    if mark not in marks:
        marks.append(mark)
    replay = replace(question, kind=suspect.type, marks=marks)
    then = what_if(recording, static_info, suspect.parameter, suggestion.value, replay)
    return Advice(suspect, suggestion, then, about)


def _suggested(
    recording: Recording,
    static_info: StaticInfo,
    mark: Mark,
    suspect: Suspect,
    question: Question,
) -> tuple[Suggestion, Declared | None]:
    """The suggestion for a suspect, and what is declared of its parameter."""
    about = declared_for(question.declared or (), suspect, static_info.source_path(suspect.key))
    at = At(mark.time_ns, suspect.type)
    return smallest_change(
        recording, static_info, suspect.comparison, at, question.about(about)
    ), about


def declared_for(
    declared: Sequence[Declared], suspect: Suspect | Accused, source: PurePath | None = None
) -> Declared | None:
    """What is declared of a suspect's parameter; None without a declaration, or if they differ.

    What the node itself published counts before what a file says. With ``source``, the file of the
    comparison, only declarations of the package that holds this file count.
    """
    same = [one for one in declared if same_parameter(one.parameter, suspect.parameter)]
    said = [one for one in same if one.parameter.startswith(f"{suspect.last.node}/")]
    if not said:
        # Full names are those of messages: other nodes have parameters of their own.
        said = [one for one in same if not one.parameter.startswith("/")]
        if not said:
            # A file has the name of the field alone; the server's handle adds its namespace.
            field = suspect.parameter.rpartition("/")[2]
            said = [one for one in declared if one.parameter == field]
        if source is not None:
            above = {str(folder) for folder in source.parents}
            said = [one for one in said if one.package in above]
    meanings = {replace(one, parameter="", description="", place="", package="") for one in said}
    return said[0] if len(meanings) == 1 else None


def join_advice(
    recording: Recording,
    static_info: StaticInfo,
    rankings: Sequence[MarkRanking],
    question: Question = PLAIN,
) -> list[MarkGroup]:
    """Advice for groups of marks that say the same, in the order of their first marks.

    The arguments are those of ``advise``, with the rankings of several marks.
    """
    groups: dict[tuple[object, ...], list[tuple[MarkRanking, list[Advice]]]] = {}
    for ranking in rankings:
        advice = advise(recording, static_info, ranking, question)
        groups.setdefault(_says(ranking.mark, advice), []).append((ranking, advice))
    found = []
    for own in groups.values():
        marks = tuple(ranking.mark for ranking, _ in own)
        suspects = tuple(
            JoinedAdvice(
                advice, named, agreed, *_tried(recording, static_info, marks, advice, question)
            )
            for advice, named, agreed in _joined([advice for _, advice in own], question.top)
        )
        reasons = dict.fromkeys(ranking.reason for ranking, _ in own if ranking.reason)
        found.append(MarkGroup(marks, marks[0].type, suspects, tuple(reasons)))
    return found


def with_remedies(
    recording: Recording,
    static_info: StaticInfo,
    rankings: Sequence[MarkRanking],
    lists: Sequence[Sequence[Advice]],
    question: Question = PLAIN,
) -> list[list[Advice]]:
    """Add the values to try to the advice for each mark, as ``join_advice`` works them out.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        rankings: of its marks.
        lists: for each the advice for its first suspects.
        question: its ``window_s``; a good run does not count here.
    """
    alone = replace(question, references=(), flown=())
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
    """What makes marks one group: type, first suspect, and what to do with it."""
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
    about = question.about(advice.declared)
    found = remedy(recording, static_info, advice.suspect.parameter, typed, about)
    asked = replace(question, kind=kind, marks=marks)
    return _with_effect(found, _replayed(recording, static_info, found, asked))


def _with_effect(found: Remedy, then: WhatIf | None) -> tuple[Remedy, WhatIf | None]:
    """The value to try and its replay; no value if the log alone wants to switch in vain."""
    is_switch = found.basis == "smallest" and found.direction == "switch"
    if then is None or not is_switch or then.answered or then.flipped_near or then.unsure:
        return found, then
    reason = f"{show(found.value)} would have turned no decision before the marks"
    none = replace(found, direction=None, value=None, basis=None, text=reason, reason=reason)
    return none, None


def _replayed(
    recording: Recording, static_info: StaticInfo, found: Remedy, question: Question
) -> WhatIf | None:
    """What the value to try would have changed; None where there is none."""
    if found.value is None:
        return None
    return what_if(recording, static_info, found.parameter, found.value, question)


def _joined(lists: Sequence[Sequence[Advice]], top: int) -> list[tuple[Advice, int, int]]:
    """The first suspects of all lists, a suspect that a list lacks counting as its last.

    Each comes with how many marks name it, and at how many its suggestion would do.
    """
    found: dict[tuple[str, MarkType], list[Advice]] = {}
    places: dict[tuple[str, MarkType], int] = {}
    for some in lists:
        for advice in some:
            name = (advice.suspect.parameter, advice.suspect.type)
            found.setdefault(name, []).append(advice)
            places[name] = places.get(name, 0) + advice.suspect.position - top - 1
    order = sorted(found, key=lambda name: (places[name], name))
    return [_most_agreed(found[name]) for name in order[:top]]


def _most_agreed(same: Sequence[Advice]) -> tuple[Advice, int, int]:
    """The one of several suggestions for a parameter that would do at the most marks."""
    best, most = same[0], 0
    for advice in same:
        value = advice.suggestion.value
        if value is None:
            continue
        count = sum(holds(other.suggestion.feasible, float(value)) for other in same)
        if count > most:
            best, most = advice, count
    return best, len(same), most


def advise_blamed(
    blame: Blame, recording: Recording, static_info: StaticInfo, question: Question = PLAIN
) -> list[BlamedAdvice]:
    """The first suspects, each with the value to try (`remedy.remedy`).

    All marks count, but not the types that observers gave: most people confuse them (thesis, table
    6.13), and the value depends on the type more than on anything else. The log decides the type
    (`Remedy.kind`). A value from before a change, or from the good run, goes before the log: with
    it the robot worked. So does the default, unless the log wants more in its direction.
    """
    found = []
    for accused in blame.suspects[: question.top]:
        if isinstance(accused, Uncompared):
            found.append(BlamedAdvice(accused, as_in_the_good_run(accused.difference), None))
            continue
        name = accused.parameter
        about = declared_for(question.declared or (), accused, static_info.source_path(accused.key))
        untyped = [replace(mark, type=None) for mark in blame.marks]
        value = remedy(recording, static_info, name, untyped, question.about(about))
        value = _as_before(_as_default(value, static_info, question.about(about)), question)
        kind = value.kind or accused.type
        asked = replace(question, kind=kind, marks=blame.marks)
        then = _replayed(recording, static_info, value, asked)
        found.append(BlamedAdvice(accused, *_with_effect(value, then)))
    return stopping_last(found)


def as_in_the_good_run(found: Difference) -> Remedy:
    """What to try for a parameter that no comparison reports: the value of the good run."""
    good, current = found.good, found.bad.value
    reason = f"it was {shown_value(good.value)} in the good run"
    nothing = Remedy(found.name, None, None, None, None, reason, reason, None, None, None)
    if not isinstance(current, bool | int | float) or good.number is None:
        return nothing
    if isinstance(current, float) and not math.isfinite(current):
        return nothing
    return restored(replace(nothing, current=current), good.number, "reference", NAMES["reference"])


def stopping_last(advice: Sequence[BlamedAdvice]) -> list[BlamedAdvice]:
    """Of suspects that share a position those come last whose value would stop everything."""
    return sorted(advice, key=lambda one: (one.accused.position, one.stops))


def _as_default(found: Remedy, static_info: StaticInfo, question: Question) -> Remedy:
    """The remedy with the default, if that may do, or if the log points away from it.

    If this parameter is wrong, then most likely because somebody moved it away from its default.
    The direction in the log depends on the types of error, which people confuse.
    """
    if found.basis in NAMES or found.current is None or question.flown:
        return found
    for one in defaults(static_info, found.parameter, question.declaration):
        if one.source not in question.sources or one.value == found.current:
            continue
        away = found.value is None or (found.value > found.current) != (one.value > found.current)
        if away or (found.smallest is not None and holds(found.smallest.feasible, one.value)):
            return restored(found, one.value, one.source, NAMES[one.source])
        return found
    return found


def _as_before(found: Remedy, question: Question) -> Remedy:
    """The remedy with the value that the parameter had before it was changed, if that is known."""
    if found.basis == "reference":
        return found
    for one in question.changes:
        known = math.isfinite(one.old) and one.old != one.new
        if known and same_parameter(one.parameter, found.parameter):
            words = "the value before it was changed"
            if found.current == one.old and _is_decided_by(one, question):
                # Another node has the present value under the name in the source.
                way = found.direction if found.direction == "switch" else None
                found = replace(found, current=_alike(one.new, found.current), direction=way)
                words = f"the value of {one.parameter} before it was changed"
            return restored(found, one.old, "before", words)
    return found


def _is_decided_by(change: Change, question: Question) -> bool:
    """Whether the mission decided otherwise than with the old value, in the node of the change."""
    differing = () if question.differences is None else question.differences.found
    return any(one.turned for one in differing if one.parameter == change.parameter)


def _alike(value: float, other: Number | None) -> Number:
    """The value as a bool or whole number, as the other one is."""
    if isinstance(other, bool):
        return bool(value)
    return int(value) if isinstance(other, int) and value.is_integer() else value
