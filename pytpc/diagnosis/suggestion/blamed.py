"""What to do with those whom all marks of a mission accuse together."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from pytpc.diagnosis.ranking.blame import Accused, Blame
from pytpc.diagnosis.ranking.diagnosing import Changed
from pytpc.diagnosis.scores.scores import WINDOW_S
from pytpc.diagnosis.suggestion.declared import Declared, declared_for
from pytpc.diagnosis.suggestion.known import Source
from pytpc.diagnosis.suggestion.remedy import EVERY_SOURCE, Remedy, remedy, restored
from pytpc.diagnosis.suggestion.what_if import WhatIf, what_if
from pytpc.recording.mission import Recording
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True, slots=True)
class BlamedAdvice:
    """One of them with the value to try; ``what_if`` is None where there is none."""

    accused: Accused
    remedy: Remedy
    what_if: WhatIf | None


def advise_blamed(
    blame: Blame,
    recording: Recording,
    static_info: StaticInfo,
    *,
    top: int = 5,
    declared: Sequence[Declared] = (),
    reference: Recording | None = None,
    changes: Sequence[Changed] = (),
    sources: Collection[Source] = EVERY_SOURCE,
    flown: Sequence[float] = (),
    window_s: float = WINDOW_S,
) -> list[BlamedAdvice]:
    """The first ``top`` of them with the value to try, as `remedy.remedy` has it.

    All marks count, without the types that were said: most people confuse them (thesis, table
    6.13), and the value depends on the type more than on all else. The type is what the log says
    for this parameter (`Remedy.kind`). ``declared`` is what is declared of
    parameters, ``reference`` a mission that went right, ``changes`` what was changed since, newest
    last. The value of before a change, or of the reference, comes before what the log says: with it
    the robot went right; of several changes of one parameter that is the oldest. ``sources`` are
    the known values that may be taken, ``flown`` values of the one suspect that did not help.
    """
    found = []
    for accused in blame.suspects[:top]:
        name = accused.parameter
        about = declared_for(declared, accused, static_info.source_path(accused.key))
        value = remedy(
            recording,
            static_info,
            name,
            [replace(mark, type=None) for mark in blame.marks],
            sources=sources,
            reference=reference,
            declared=about,
            flown=flown,
            window_s=window_s,
        )
        value = _as_before(value, changes)
        then = None
        if value.value is not None:
            kind = value.kind or accused.type
            marks = [replace(mark, type=kind) for mark in blame.marks]
            then = what_if(
                recording, static_info, name, value.value, kind=kind, marks=marks, window_s=window_s
            )
        found.append(BlamedAdvice(accused, value, then))
    return found


def _as_before(found: Remedy, changes: Sequence[Changed]) -> Remedy:
    """The remedy with the value that the parameter had before it was changed, if that is known."""
    for name, old, new in changes:
        if same_parameter(name, found.parameter) and math.isfinite(old) and old != new:
            return restored(found, old, "before", "the value before it was changed")
    return found
