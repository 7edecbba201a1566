"""The advice for the parameters that all marks of a mission blame together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.results.advice import BlamedAdvice, Remedy
from pytpc.diagnosis.results.suspects import Blame
from pytpc.diagnosis.suggestion.declared import declared_for
from pytpc.diagnosis.suggestion.remedy import remedy, restored
from pytpc.diagnosis.suggestion.what_if import what_if
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo


def advise_blamed(
    blame: Blame, recording: Recording, static_info: StaticInfo, question: Question = PLAIN
) -> list[BlamedAdvice]:
    """The first of them with the value to try, as `remedy.remedy` has it.

    All marks count, without the types that were said: most people confuse them (thesis, table
    6.13), and the value depends on the type more than on all else. The type is what the log says
    for this parameter (`Remedy.kind`). The value of before a change, or of the reference, comes
    before what the log says: with it the robot went right.
    """
    found = []
    for accused in blame.suspects[: question.top]:
        name = accused.parameter
        about = declared_for(question.declared, accused, static_info.source_path(accused.key))
        untyped = [replace(mark, type=None) for mark in blame.marks]
        value = remedy(recording, static_info, name, untyped, question.about(about))
        value = _as_before(value, question.changes)
        then = None
        if value.value is not None:
            kind = value.kind or accused.type
            marks = [replace(mark, type=kind) for mark in blame.marks]
            replay = question.replayed(kind, marks)
            then = what_if(recording, static_info, name, value.value, replay)
        found.append(BlamedAdvice(accused, value, then))
    return found


def _as_before(found: Remedy, changes: Sequence[Change]) -> Remedy:
    """The remedy with the value that the parameter had before it was changed, if that is known."""
    for one in changes:
        known = math.isfinite(one.old) and one.old != one.new
        if known and same_parameter(one.parameter, found.parameter):
            return restored(found, one.old, "before", "the value before it was changed")
    return found
