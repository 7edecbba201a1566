"""The entrance: the whole answer about a mission, from all its marks."""

from __future__ import annotations

from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.suggestion.advise import advise_blamed
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo


def diagnose_mission(
    recording: Recording,
    static_info: StaticInfo,
    question: Question = PLAIN,
    parameter: str | None = None,
) -> Diagnosis:
    """Judge the parameters by all marks of a mission, and advise on the first ones.

    Args:
        recording: the mission with its marks.
        static_info: what the analysis found, with the names of this mission.
        question: what else is known; ``top`` is how many suspects get a value to try.
        parameter: the one in question; None: the first suspects.
    """
    found = blame(recording, static_info, question)
    about = found if parameter is None else found.only(parameter)
    advice = advise_blamed(about, recording, static_info, question)
    return Diagnosis(about, tuple(advice), question.differences)
