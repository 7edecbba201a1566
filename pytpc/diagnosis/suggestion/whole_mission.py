"""The whole diagnosis of one mission: every mark, all marks together, and the rank curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pytpc.base.wording import many, show
from pytpc.diagnosis.behaviour import behaviours, by_nearest
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.advice import Advice, RankCurves, Remedy, Suggestion
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.mission_answer import (
    LeadAnswer,
    MarkAnswer,
    MissionAnswer,
    Spans,
    SuspectAnswer,
)
from pytpc.diagnosis.results.suspects import Accused, MarkRanking, Suspect, Uncompared
from pytpc.diagnosis.scores.score_tables import STEP_S, rank_curves
from pytpc.diagnosis.suggestion.advise import advise, alternatives, declared_for
from pytpc.diagnosis.suggestion.smallest_change import At, smallest_change
from pytpc.diagnosis.thresholds.units import threshold_of
from pytpc.diagnosis.turn_groups import turn_groups_of
from pytpc.recording.events import Floats
from pytpc.recording.faults import faults_of
from pytpc.recording.marks import Mark
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
    found: Diagnosis | None,
) -> MissionAnswer:
    """Everything that the report page says about a mission.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        rankings: the suspects at each mark, as ``rank_marks`` answers the question.
        question: its ``top`` is how many suspects of a mark get all the evidence.
        found: what all marks say together; None without a mark.
    """
    every = [
        advise(recording, static_info, ranking, replace(question, top=len(ranking.suspects)))
        for ranking in rankings
    ]

    def looked_at(ranking: MarkRanking, advice: Advice) -> SuspectAnswer:
        suspect = advice.suspect
        return SuspectAnswer(
            advice,
            why(recording, suspect, ranking.mark, question.window_s),
            tuple(alternatives(recording, static_info, ranking, suspect, question)),
            _suggested_threshold(suspect.comparison, advice.suggestion),
            _feasible_thresholds(suspect.comparison, advice.suggestion),
        )

    lead = None if found is None else _lead(recording, static_info, rankings, found, question)
    return MissionAnswer(
        question=question,
        marks=tuple(
            MarkAnswer(
                ranking,
                tuple(looked_at(ranking, one) for one in advice[: question.top]),
                tuple(advice[question.top :]),
            )
            for ranking, advice in zip(rankings, every, strict=True)
        ),
        diagnosis=found,
        curves=_curves(recording, static_info, rankings, question),
        warnings=tuple(faults_of(recording, static_info)),
        lead=lead,
        behaviours=tuple(sorted(behaviours(recording, static_info), key=by_nearest)),
        groups=turn_groups_of(recording, static_info),
    )


def _lead(
    recording: Recording,
    static_info: StaticInfo,
    rankings: Sequence[MarkRanking],
    found: Diagnosis,
    question: Question,
) -> LeadAnswer | None:
    """The evidence for the first suspect that the diagnosis shows, if there is any in the log."""
    if not found.shown:
        return None
    advised = found.shown[0]
    told, accused = advised.remedy, advised.accused
    if isinstance(accused, Uncompared):
        return None
    if told.key is not None and told.key in static_info.comparisons:
        comparison = static_info.comparisons[told.key]
        kind = told.kind or accused.type
        accused = replace(accused, key=told.key, comparison=comparison, type=kind)
    place = _most_telling(rankings, accused)
    mark = rankings[place].mark
    about = declared_for(question.declared or (), accused, static_info.source_path(accused.key))
    at = At(mark.time_ns, accused.type)
    least = smallest_change(recording, static_info, accused.comparison, at, question.about(about))
    return LeadAnswer(
        advised,
        accused,
        mark,
        place + 1,
        why(recording, accused, mark, question.window_s),
        _suggested_threshold(accused.comparison, told),
        _feasible_thresholds(accused.comparison, least),
        about,
    )


def _most_telling(rankings: Sequence[MarkRanking], accused: Accused) -> int:
    """At which mark this parameter is most suspicious, by this comparison if possible."""

    def order(place: int) -> tuple[bool, bool, bool, int, int]:
        ranking = rankings[place]
        suspect = ranking.suspect_of(accused.parameter)
        if suspect is None:
            return (True, True, not ranking.enough, 0, -place)
        key, kind = suspect.key == accused.key, suspect.type == accused.type
        return (not kind, not key, not ranking.enough, suspect.position, place)

    return min(range(len(rankings)), key=order)


def _curves(
    recording: Recording,
    static_info: StaticInfo,
    rankings: Sequence[MarkRanking],
    question: Question,
) -> RankCurves | None:
    """Both ranks over the mission, at 10 Hz, or less often if that is too much for a page."""
    if not any(ranking.suspects for ranking in rankings):
        return None
    steps = min(_STEPS, _NUMBERS // max(1, len(static_info.thresholds)))
    step_s = max(STEP_S, recording.seconds / max(1, steps))
    return rank_curves(recording, static_info, question, step_s=step_s)


def _suggested_threshold(found: Comparison, told: Suggestion | Remedy) -> float | None:
    if told.value is None or told.direction == "switch":
        return None
    return threshold_of(found, float(told.value))


def _feasible_thresholds(found: Comparison, suggestion: Suggestion) -> Spans:
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


def why(recording: Recording, suspect: Suspect | Accused, mark: Mark, window_s: float) -> str:
    """What the suspect's comparison did before the mark, in one sentence; empty if it did nothing.

    Type I: its last flop. Type II: its results in the window of ``window_s`` seconds, and the
    evaluation that came nearest to the other outcome.
    """
    if suspect.type == "I":
        return _last_flop(recording, suspect, mark)
    return _window(recording, suspect, mark, window_s)


def _last_flop(recording: Recording, suspect: Suspect | Accused, mark: Mark) -> str:
    events = recording.events
    rows = events.rows_of(suspect.key)
    flops = rows[events.flop[rows] & (events.time_ns[rows] <= mark.time_ns)]
    if not flops.size:
        return ""
    row = int(flops[-1])
    age = (mark.time_ns - int(events.time_ns[row])) / 1e9
    truth = "true" if events.result[row] else "false"
    text = f"It became {truth} {age:.2f} s before the mark"
    if suspect.comparison.relation == "flag":
        return f"{text}."
    cmp, thresh = float(events.cmp[row]), float(events.thresh[row])
    return f"{text}, with {show(cmp)} against {show(thresh)}."


def _window(recording: Recording, suspect: Suspect | Accused, mark: Mark, window_s: float) -> str:
    begin = f"In the {window_s:g} s before the mark it was"
    begin_ns = mark.time_ns - round(window_s * 1e9)
    events = recording.events
    rows = events.rows_of(suspect.key)
    rows = rows[(events.time_ns[rows] >= begin_ns) & (events.time_ns[rows] <= mark.time_ns)]
    cmp, thresh = events.cmp[rows], events.thresh[rows]
    count, true = int(rows.size), int(events.result[rows].sum())
    one = true in (0, count)
    summaries = recording.summaries
    own = summaries.take(summaries.rows_of(suspect.key))
    if len(own):
        # They count the events, too.
        own = own.take((own.begin_ns >= begin_ns) & (own.end_ns <= mark.time_ns))
        if len(own):
            count = int(own.count.sum())
            one = not own.flops.any() and bool(own.result.all() or not own.result.any())
            true = count if own.result.all() else 0
            cmp = np.concatenate([own.thresh + own.diff_min, own.thresh + own.diff_max])
            thresh = np.tile(own.thresh, 2)
            if not one:
                return f"{begin} evaluated {many(count, 'time')}{_near(cmp, thresh)}"
    if not count:
        return ""
    each = f"all {many(count, 'time')}" if count > 1 else "the one time it was evaluated"
    truth = f"{'true' if true else 'false'} {each}"
    counted = truth if one else f"true {true:,} of {many(count, 'time')}"
    flag = suspect.comparison.relation == "flag"
    return f"{begin} {counted}{'.' if flag else _near(cmp, thresh)}"


def _near(cmp: Floats, thresh: Floats) -> str:
    """The end of the sentence: the values that were nearest to one another."""
    with np.errstate(invalid="ignore", over="ignore"):
        away = np.abs(cmp - thresh)
    if not np.any(np.isfinite(away)):
        return "."
    nearest = int(np.nanargmin(away))
    values = show(float(cmp[nearest])), show(float(thresh[nearest]))
    return f"; the compared value came closest at {values[0]}, against {values[1]}."
