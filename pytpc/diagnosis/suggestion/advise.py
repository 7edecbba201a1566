"""The advice for the suspects at one mark: the entrance to this room."""

from __future__ import annotations

from dataclasses import replace

from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.results.advice import Advice, Suggested, Suggestion
from pytpc.diagnosis.results.suspects import MarkRanking, Suspect
from pytpc.diagnosis.suggestion.declared import declared_for
from pytpc.diagnosis.suggestion.suggest import At, suggest
from pytpc.diagnosis.suggestion.what_if import what_if
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo


def advise(
    recording: Recording,
    static_info: StaticInfo,
    ranking: MarkRanking,
    question: Question = PLAIN,
) -> list[Advice]:
    """Advice for the first suspects at a mark, in their order.

    The counterfactual looks at the marks of the type that the suspect's score is of, those of no
    type, and this mark.

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


def suggest_each(
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
    said = _advice(recording, static_info, ranking.mark, suspect, question)
    known = {(said.suggestion.direction, said.suggestion.value)}
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
    replay = question.replayed(suspect.type, marks)
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
    about = declared_for(question.declared, suspect, static_info.source_path(suspect.key))
    at = At(mark.time_ns, suspect.type)
    return suggest(recording, static_info, suspect.comparison, at, question.about(about)), about
