"""Answers as JSON: what ``rank``, ``suggest``, ``watch`` and ``marks`` print with ``--json``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict

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
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.differences import Difference, RunDifferences, SetValue
from pytpc.diagnosis.results.live import LiveRow, Look
from pytpc.diagnosis.results.suspects import Accused, MarkRanking, Suspect, Uncompared
from pytpc.diagnosis.results.turn_groups import SuspectGroup, TurnGroup
from pytpc.present.watch_screen import Status
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording

Json = dict[str, object]


def finite(value: Number | None) -> Number | None:
    """The number, or None where JSON has none for it: NaN and infinity."""
    return value if value is not None and math.isfinite(value) else None


def fields_json(found: Suggestion | WhatIf | Declared) -> Json:
    """All fields, those of what is inside, too; a number that JSON lacks is null."""
    return {name: without_nan(value) for name, value in asdict(found).items()}


def without_nan(value: object) -> object:
    """A value whose numbers, also those inside, are null where JSON lacks them."""
    if isinstance(value, float):
        return finite(value)
    if isinstance(value, dict):
        return {name: without_nan(one) for name, one in value.items()}
    return [without_nan(one) for one in value] if isinstance(value, list | tuple) else value


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


def _declared(found: Declared) -> Json:
    """A declaration; ``choices`` is a list of ``{name, value}``."""
    fields = fields_json(found)
    del fields["package"]
    return {**fields, "choices": [{"name": name, "value": value} for name, value in found.choices]}


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
        "suggestion": fields_json(found.suggestion),
        "what_if": None if found.what_if is None else fields_json(found.what_if),
        "declared": None if found.declared is None else _declared(found.declared),
    }


def ranking_json(ranking: MarkRanking, recording: Recording, rows: Sequence[Suggested]) -> Json:
    """The ranking at a mark, with the smallest change for each of ``rows``."""
    mark = ranking.mark
    return {
        "mission": recording.name,
        **mark_json(mark, recording.start_ns),
        "parameters": ranking.parameters,
        "enough": ranking.enough,
        "reason": ranking.reason,
        "suspects": [_suspected(row) for row in rows],
    }


def _suspected(row: Suggested) -> Json:
    suspect, advice = row.suspect, row.suggestion
    return {
        **_ranked(suspect),
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


def _ranked(suspect: Suspect) -> Json:
    """The place of a suspect in a ranking."""
    return {
        "position": suspect.position,
        "tied": suspect.tied,
        "parameter": suspect.parameter,
        "key": suspect.key,
        "score": suspect.score,
        "score_type": suspect.type,
        "rank": suspect.rank,
        "rank1": suspect.rank1,
        "rank2": suspect.rank2,
    }


def group_json(group: MarkGroup, start_ns: int) -> Json:
    """Marks that say the same, with what is advised; ``start_ns`` is the begin of the mission."""
    return {
        "type": group.type,
        "marks": [mark_json(mark, start_ns) for mark in group.marks],
        "reasons": list(group.reasons),
        "suspects": [_joined(joined) for joined in group.suspects],
    }


def diagnosis_json(found: Diagnosis) -> Json:
    """What all marks say together, with the suspects that have an advice."""
    blame = found.blame
    return {
        "text": found.headline,
        "action": found.action,
        "accused": found.accused,
        "confidence": blame.confidence,
        "none": blame.none,
        "parameters": blame.parameters,
        "notes": list(blame.notes),
        "suspects": [_blamed(one) for one in found.advice],
        "groups": [_suspect_group(one) for one in blame.groups],
        "differences": None if found.differences is None else differences_json(found.differences),
    }


def _suspect_group(found: SuspectGroup) -> Json:
    return {
        "parameters": list(found.parameters),
        "probability": found.probability,
        **turn_group_json(found.turning),
    }


def turn_group_json(found: TurnGroup) -> Json:
    """Comparisons that turn as one."""
    return {
        "kind": found.kind,
        "turns": found.turns,
        "members": [asdict(one) for one in found.members],
    }


def differences_json(found: RunDifferences) -> Json:
    """What differs from good runs."""
    return {
        "good": list(found.good),
        "bad": found.bad,
        "complete": found.is_complete,
        "notes": list(found.notes),
        "code": None if found.code is None else {"same": found.code.is_same, **asdict(found.code)},
        "parameters": [_difference(one) for one in found.found],
    }


def _difference(found: Difference) -> Json:
    def value(one: SetValue) -> Json:
        return {"value": without_nan(one.value), "place": one.place}

    return {
        "parameter": found.parameter,
        "name": found.name,
        "good": value(found.good),
        "bad": value(found.bad),
        "state": found.state,
        "effect": found.effect,
        "reads": list(found.reads),
        "compared_at": list(found.compared_at),
        "evaluations": found.evaluations,
        "turned": found.turned,
        "turned_near": found.turned_near,
        "comparisons": [asdict(one) for one in found.replayed],
    }


def _blamed(found: BlamedAdvice) -> Json:
    accused = found.accused
    tried = None if found.what_if is None else fields_json(found.what_if)
    silent = accused if isinstance(accused, Uncompared) else None
    compared = accused if isinstance(accused, Accused) else None
    comparison = compared and compared.comparison
    return {
        "position": accused.position,
        "tied": accused.tied,
        "parameter": accused.parameter,
        "probability": accused.probability,
        "type": accused.type,
        "key": accused.key,
        "file": comparison and comparison.file,
        "lineno": comparison and comparison.lineno,
        "source_code": comparison and comparison.source_code,
        "topic": comparison and comparison.topic,
        "node": compared and compared.last.node,
        "uncompared": silent and silent.difference.effect,
        "followed": [asdict(one) for one in accused.followed],
        "remedy": {**remedy_json(found.remedy), "what_if": tried},
    }


def _joined(found: JoinedAdvice) -> Json:
    tried = None if found.what_if is None else fields_json(found.what_if)
    return {
        **advice_json(found.advice),
        "named": found.named,
        "agreed": found.agreed,
        "remedy": {**remedy_json(found.remedy), "what_if": tried},
    }


def mark_json(mark: Mark, start_ns: int) -> Json:
    """A mark; ``start_ns`` is the begin of the mission."""
    seconds = (mark.time_ns - start_ns) / 1e9
    return {
        "time_ns": mark.time_ns,
        "seconds": seconds,
        "type": mark.type,
        "observer": mark.observer,
        "note": mark.note,
        "where": list(mark.where),
        "began": mark.began and [seconds - ago for ago in mark.began],
    }


def look_json(look: Look, status: Status, into_ns: int | None) -> Json:
    """The rankings of an instant, ``into_ns`` after the begin of a recording."""
    return {
        "time_ns": look.now_ns,
        "seconds": None if into_ns is None else into_ns / 1e9,
        "evaluations": status.evaluations,
        "nodes": status.nodes,
        "unknown_keys": status.unknown,
        "lost": status.lost,
        "fault": status.fault,
        "parameters": look.parameters,
        "rankings": {
            kind or "combined": {
                "reason": look.reasons[kind],
                "suspects": [_row(row) for row in rows],
            }
            for kind, rows in look.rows.items()
        },
    }


def _row(row: LiveRow) -> Json:
    suspect, last = row.suspect, row.last
    found = suspect.comparison
    return {
        **_ranked(suspect),
        "cmp": None if last is None else finite(last.cmp),
        "relation": found.relation,
        "thresh": None if last is None else finite(last.thresh),
        "result": None if last is None else last.result,
        "node": None if last is None else last.node,
        "seconds_since_flop": row.flop_s,
        "topic": found.topic,
        "file": found.file,
        "lineno": found.lineno,
    }
