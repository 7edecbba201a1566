"""Advice as JSON: the output of ``suggest --json`` and ``rank --json``."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pytpc.base.wording import Number
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
from pytpc.diagnosis.results.suspects import Blame, MarkRanking
from pytpc.diagnosis.thresholds.intervals import Intervals
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording

Json = dict[str, object]


def finite(value: Number | None) -> Number | None:
    """JSON has neither NaN nor infinity: null."""
    return value if value is not None and math.isfinite(value) else None


def intervals_json(intervals: Intervals) -> list[Json]:
    """A list of ``{low, high, low_inclusive, high_inclusive}``; an end that is none is null."""
    return [
        {
            "low": finite(one.low),
            "high": finite(one.high),
            "low_inclusive": one.low_inclusive,
            "high_inclusive": one.high_inclusive,
        }
        for one in intervals
    ]


def suggestion_json(found: Suggestion) -> Json:
    """All fields of a suggestion."""
    return {
        "parameter": found.parameter,
        "current": finite(found.current),
        "direction": found.direction,
        "value": finite(found.value),
        "boundary": finite(found.boundary),
        "inclusive": found.inclusive,
        "text": found.text,
        "reason": found.reason,
        "feasible": intervals_json(found.feasible),
        "limited_by": found.limited_by,
    }


def remedy_json(found: Remedy) -> Json:
    """A value to try; ``known`` are ``{source, value}``."""
    return {
        "current": finite(found.current),
        "direction": found.direction,
        "value": finite(found.value),
        "basis": found.basis,
        "text": found.text,
        "reason": found.reason,
        "type": found.kind,
        "key": found.key,
        "known": [{"source": one.source, "value": finite(one.value)} for one in found.known],
    }


def what_if_json(found: WhatIf) -> Json:
    """All fields of a counterfactual."""
    return {
        "parameter": found.parameter,
        "value": finite(found.value),
        "marks": found.marks,
        "answered": found.answered,
        "evaluations": found.evaluations,
        "flipped_near": found.flipped_near,
        "flipped_away": found.flipped_away,
        "unsure": found.unsure,
        "text": found.text,
        "caveats": list(found.caveats),
    }


def declared_json(found: Declared) -> Json:
    """All fields of a declaration; ``choices`` is a list of ``{name, value}``."""
    return {
        "parameter": found.parameter,
        "type": found.type,
        "low": finite(found.low),
        "high": finite(found.high),
        "step": finite(found.step),
        "default": found.default if isinstance(found.default, str) else finite(found.default),
        "choices": [{"name": name, "value": value} for name, value in found.choices],
        "description": found.description,
        "place": found.place,
    }


def advice_json(found: Advice) -> Json:
    """A suspect with its suggestion, counterfactual and declaration; these may be null."""
    suspect = found.suspect
    return {
        "position": suspect.position,
        "parameter": suspect.parameter,
        "key": suspect.key,
        "score_type": suspect.type,
        "score": finite(suspect.score),
        "rank": suspect.rank,
        "file": suspect.comparison.file,
        "lineno": suspect.comparison.lineno,
        "source_code": suspect.comparison.source_code,
        "node": suspect.last.node,
        "suggestion": suggestion_json(found.suggestion),
        "what_if": None if found.what_if is None else what_if_json(found.what_if),
        "declared": None if found.declared is None else declared_json(found.declared),
    }


def ranking_json(ranking: MarkRanking, recording: Recording, rows: Sequence[Suggested]) -> Json:
    """The ranking at a mark, with the smallest change for each of ``rows``."""
    mark = ranking.mark
    return {
        "mission": recording.name,
        "time_ns": mark.time_ns,
        "seconds": (mark.time_ns - recording.start_ns) / 1e9,
        "type": mark.type,
        "observer": mark.observer,
        "parameters": ranking.parameters,
        "enough": ranking.enough,
        "reason": ranking.reason,
        "suspects": [_suspected(row) for row in rows],
    }


def _suspected(row: Suggested) -> Json:
    suspect, advice = row.suspect, row.suggestion
    return {
        "position": suspect.position,
        "tied": suspect.tied,
        "parameter": suspect.parameter,
        "key": suspect.key,
        "score": suspect.score,
        "rank": suspect.rank,
        "rank1": suspect.rank1,
        "rank2": suspect.rank2,
        "score_type": suspect.type,
        "current": finite(advice.current),
        "direction": advice.direction,
        "value": finite(advice.value),
        "boundary": finite(advice.boundary),
        "inclusive": advice.inclusive,
        "suggestion": advice.text,
        "file": suspect.comparison.file,
        "lineno": suspect.comparison.lineno,
        "source_code": suspect.comparison.source_code,
        "topic": suspect.comparison.topic,
        "node": suspect.last.node,
    }


def group_json(group: MarkGroup, start_ns: int) -> Json:
    """Marks that say the same, with what is advised; ``start_ns`` is the begin of the mission."""
    return {
        "type": group.type,
        "marks": [_mark(mark, start_ns) for mark in group.marks],
        "reasons": list(group.reasons),
        "suspects": [_joined(joined) for joined in group.suspects],
    }


def blame_json(blame: Blame, advice: Sequence[BlamedAdvice]) -> Json:
    """What all marks say together, with the suspects that have an advice."""
    return {
        "text": blame.text,
        "accused": blame.accused,
        "confidence": blame.confidence,
        "none": blame.none,
        "parameters": blame.parameters,
        "notes": list(blame.notes),
        "suspects": [_blamed(one) for one in advice],
    }


def _blamed(found: BlamedAdvice) -> Json:
    accused = found.accused
    tried = None if found.what_if is None else what_if_json(found.what_if)
    return {
        "position": accused.position,
        "tied": accused.tied,
        "parameter": accused.parameter,
        "probability": accused.probability,
        "type": accused.type,
        "key": accused.key,
        "file": accused.comparison.file,
        "lineno": accused.comparison.lineno,
        "source_code": accused.comparison.source_code,
        "topic": accused.comparison.topic,
        "node": accused.last.node,
        "remedy": {**remedy_json(found.remedy), "what_if": tried},
    }


def _joined(found: JoinedAdvice) -> Json:
    tried = None if found.what_if is None else what_if_json(found.what_if)
    return {
        **advice_json(found.advice),
        "named": found.named,
        "agreed": found.agreed,
        "remedy": {**remedy_json(found.remedy), "what_if": tried},
    }


def _mark(mark: Mark, start_ns: int) -> Json:
    return {
        "time_ns": mark.time_ns,
        "seconds": (mark.time_ns - start_ns) / 1e9,
        "type": mark.type,
        "observer": mark.observer,
        "note": mark.note,
    }
