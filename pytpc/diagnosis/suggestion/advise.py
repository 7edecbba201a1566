"""All that is advised about the suspects at a mark: the entrance to this room."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.ranking.ranking import MarkRanking, Suspect
from pytpc.diagnosis.suggestion.declared import Declared, declared_for
from pytpc.diagnosis.suggestion.remedy import Remedy
from pytpc.diagnosis.suggestion.suggest import At, Suggestion, suggest
from pytpc.diagnosis.suggestion.what_if import WhatIf, what_if
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True, slots=True)
class Advice:
    """A suspect with what to do.

    ``suggestion`` is SPEC 8's smallest change, and ``what_if`` what it would have changed, None
    where nothing is suggested. ``remedy`` is the value to try, and ``tried`` what that would have
    changed; `pytpc.diagnosis.suggestion.joining.with_remedies` fills them, for they need the other
    marks.
    """

    suspect: Suspect
    suggestion: Suggestion
    what_if: WhatIf | None
    declared: Declared | None
    remedy: Remedy | None = None
    tried: WhatIf | None = None


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
    about = declared_for(question.declared, suspect, static_info.source_path(suspect.key))
    at = At(mark.time_ns, suspect.type)
    suggestion = suggest(recording, static_info, suspect.comparison, at, question.about(about))
    if suggestion.value is None:
        return Advice(suspect, suggestion, None, about)
    marks = [one for one in recording.marks if one.type in {suspect.type, None} or one == mark]
    if mark not in marks:
        marks.append(mark)
    replay = question.replayed(suspect.type, marks)
    then = what_if(recording, static_info, suspect.parameter, suggestion.value, replay)
    return Advice(suspect, suggestion, then, about)
