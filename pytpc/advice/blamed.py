"""What to do with those whom all marks of a mission accuse together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pytpc.advice.blame import Accused, Blame
from pytpc.advice.counterfactual import WhatIf, what_if
from pytpc.advice.declared import Declared, declared_for
from pytpc.advice.remedy import Remedy, remedy
from pytpc.ingest.recording import Recording
from pytpc.marks import Mark
from pytpc.scoring.scores import WINDOW_S
from pytpc.static_info import StaticInfo


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
    window_s: float = WINDOW_S,
) -> list[BlamedAdvice]:
    """The first ``top`` of them with the value to try, as `pytpc.advice.remedy.remedy` has it.

    Of the marks those count that can be of the kind of error that the parameter is suspected of;
    where none can, the observers were wrong, and all count. ``declared`` is what is declared of
    parameters, ``reference`` a mission that went right.
    """
    found = []
    for accused in blame.suspects[:top]:
        name, kind = accused.parameter, accused.type
        marks = _marks_for(blame.marks, accused)
        about = declared_for(declared, accused, static_info.source_path(accused.key))
        value = remedy(
            recording,
            static_info,
            name,
            marks,
            reference=reference,
            declared=about,
            window_s=window_s,
        )
        then = None
        if value.value is not None:
            then = what_if(
                recording, static_info, name, value.value, kind=kind, marks=marks, window_s=window_s
            )
        found.append(BlamedAdvice(accused, value, then))
    return found


def _marks_for(marks: Sequence[Mark], accused: Accused) -> list[Mark]:
    fitting = [mark for mark in marks if mark.type in {accused.type, None}]
    return [replace(mark, type=accused.type) for mark in fitting or marks]
