"""The whole diagnosis of one mission: every mark, all marks together, and the rank curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.ranking.clocks import two_clocks
from pytpc.diagnosis.ranking.complaints import complaints
from pytpc.diagnosis.ranking.reasons import why
from pytpc.diagnosis.results.advice import Advice, Remedy, Suggestion
from pytpc.diagnosis.results.mission_answer import (
    MarkAnswer,
    MissionAnswer,
    RankCurves,
    SuspectAnswer,
)
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.scores.rank_curves import STEP_S, rank_curves
from pytpc.diagnosis.suggestion.advise import advise, alternatives
from pytpc.diagnosis.suggestion.blamed_advice import advise_blamed
from pytpc.diagnosis.suggestion.joining import with_remedies
from pytpc.diagnosis.thresholds.units import threshold_of
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Comparison
from pytpc.static.static_info import StaticInfo

# The most steps of the curves, and the most numbers that are worked out for them.
_STEPS = 6000
_NUMBERS = 10_000_000


def answer_mission(
    recording: Recording,
    static_info: StaticInfo,
    rankings: Sequence[MarkRanking],
    question: Question,
) -> MissionAnswer:
    """Everything that the report page says of a mission.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        rankings: the suspects at each mark, as ``rank_marks`` answers the question.
        question: its ``top`` is how many suspects of a mark are looked at closely.
    """
    every = [
        advise(recording, static_info, ranking, replace(question, top=len(ranking.suspects)))
        for ranking in rankings
    ]
    firsts = [advice[: question.top] for advice in every]
    tried = with_remedies(recording, static_info, rankings, firsts, question)

    def looked_at(ranking: MarkRanking, advice: Advice) -> SuspectAnswer:
        suspect = advice.suspect
        return SuspectAnswer(
            advice,
            why(recording, suspect, ranking.mark, question.window_s),
            tuple(alternatives(recording, static_info, ranking, suspect, question)),
            _suggested_threshold(suspect.comparison, advice.told),
            _feasible_thresholds(suspect.comparison, advice.suggestion),
        )

    found = blame(recording, static_info, question) if rankings else None
    first = []
    if found is not None:
        first = advise_blamed(found, recording, static_info, replace(question, top=1))
    return MissionAnswer(
        question=question,
        marks=tuple(
            MarkAnswer(
                ranking,
                tuple(looked_at(ranking, one) for one in own),
                tuple(advice[question.top :]),
            )
            for ranking, own, advice in zip(rankings, tried, every, strict=True)
        ),
        blame=found,
        first=first[0] if first else None,
        curves=_curves(recording, static_info, rankings, question),
        warnings=(*complaints(recording, static_info), *two_clocks(recording)),
    )


def _curves(
    recording: Recording,
    static_info: StaticInfo,
    rankings: Sequence[MarkRanking],
    question: Question,
) -> RankCurves | None:
    """Both ranks over the mission, at 10 Hz, or less often where that is too much for a page."""
    if not any(ranking.suspects for ranking in rankings):
        return None
    steps = min(_STEPS, _NUMBERS // max(1, len(static_info.thresholds)))
    step_s = max(STEP_S, recording.seconds / max(1, steps))
    return rank_curves(recording, static_info, question, step_s=step_s)


def _suggested_threshold(found: Comparison, told: Suggestion | Remedy) -> float | None:
    if told.value is None or told.direction == "switch":
        return None
    return threshold_of(found, float(told.value))


def _feasible_thresholds(
    found: Comparison, suggestion: Suggestion
) -> tuple[tuple[float, float], ...]:
    """The values that would do, as thresholds; an open end is infinite."""
    if found.relation == "flag":
        return ()
    spans = []
    for interval in suggestion.feasible:
        low, high = (threshold_of(found, end) for end in (interval.low, interval.high))
        if math.isnan(low) or math.isnan(high):
            # Which end is open shows the side on which the suggested value lies.
            end = high if math.isnan(low) else low
            inside = _suggested_threshold(found, suggestion)
            if inside is None or math.isnan(end) or math.isnan(inside):
                continue
            low, high = end, math.inf if inside > end else -math.inf
        spans.append((min(low, high), max(low, high)))
    return tuple(spans)
