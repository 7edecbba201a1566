"""Which value to try, and what it would have changed in the recorded run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

from pytpc.api.diagnosing import Rankings
from pytpc.api.missions import Source, load_static, read, with_names_of
from pytpc.base.wording import Number
from pytpc.diagnosis.diagnose import diagnose_mission
from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.results.advice import MarkGroup, Suggested, WhatIf
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.suggestion.advise import (
    advise,
    join_advice,
    smallest_changes_at,
    with_remedies,
)
from pytpc.diagnosis.suggestion.what_if import what_if as replay
from pytpc.present.answers import Advices
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import MARK_TYPES, Mark, MarkType
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

if TYPE_CHECKING:
    from typing_extensions import Unpack


class ReplaySettings(TypedDict, total=False):
    """The settings of ``what_if`` as keywords."""

    kind: MarkType | None
    marks: Sequence[Mark] | None
    window_s: float


@dataclass(frozen=True, slots=True)
class Suggestions:
    """What to try by all marks of a mission, and by those that say the same.

    ``together`` has no suspect if the parameter in question is not suspected.
    """

    together: Diagnosis
    groups: tuple[MarkGroup, ...]


def suggest(
    rankings: Rankings,
    mark: int = 1,
    *,
    top: int = PLAIN.top,
    declared: Sequence[Declared] | None = None,
) -> Advices:
    """What to do with suspects at a mark, and what it would have changed in the recorded run.

    For each suspect: ``remedy``, the value to try by all marks that say the same (as in `pytpc
    suggest`), and ``suggestion``, the smallest change at this mark.

    Args:
        rankings: the answer of ``rank``.
        mark: which of them, counted from 1.
        top: how many suspects.
        declared: the declared ranges of parameters; None: those in the sources of the static
            information, and in the folder of a mission that was ranked by its path.

    Raises:
        IndexError: there is no such mark.
    """
    if not 1 <= mark <= len(rankings):
        raise IndexError(f"mark {mark} of {len(rankings)}")
    recording, static = rankings.recording, rankings.static_info
    about = rankings.declared if declared is None else declared
    question = replace(rankings.question, top=top, declared=about)
    lists = [advise(recording, static, ranking, question) for ranking in rankings]
    found = with_remedies(recording, static, list(rankings), lists, question)
    return Advices(tuple(found[mark - 1]), rankings[mark - 1])


def smallest_changes(rankings: Rankings) -> list[list[Suggested]]:
    """The first suspects at each mark, each with its smallest change."""
    recording, static, question = rankings.recording, rankings.static_info, rankings.question
    return [smallest_changes_at(recording, static, ranking, question) for ranking in rankings]


def suggest_together(rankings: Rankings, parameter: str | None = None) -> Suggestions:
    """What to try by all marks, and by each group of marks that say the same.

    Args:
        rankings: the answer of ``rank``; its question says how many suspects, and what is known.
        parameter: the one in question; None: the first suspects.

    Raises:
        InputError: no comparison with the parameter is known.
    """
    parameter = None if parameter is None else rankings.named(parameter)
    asked = rankings if parameter is None else rankings.only(parameter)
    recording, static, question = rankings.recording, rankings.static_info, rankings.question
    together = diagnose_mission(recording, static, question, parameter)
    groups = join_advice(recording, static, list(asked), question)
    return Suggestions(together, tuple(groups))


def what_if(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    parameter: str,
    value: Number,
    **settings: Unpack[ReplaySettings],
) -> WhatIf:
    """What another value of a parameter would have changed in a recorded run.

    Args:
        mission: the run.
        static_info: what the analysis found.
        parameter: its name in the source, or on the robot.
        value: in the parameter's own unit.
        **settings: ``kind``: the type of error; None: the type of each mark. ``marks``: the marks
            to answer; None: those of the mission of that type, or without a type. ``window_s``:
            how long before a mark counts as near to it, in seconds.

    Raises:
        InputError: no comparison is with that parameter, or something cannot be read.
    """
    question = Question(**settings)
    recording = read(mission)
    source = None if isinstance(mission, Recording) else Path(mission)
    named = with_names_of(recording, load_static(static_info), source)
    return replay(recording, named, parameter, value, question)


def what_if_by_type(
    recording: Recording,
    static_info: StaticInfo,
    parameter: str,
    value: Number,
    question: Question = PLAIN,
) -> list[tuple[MarkType | None, WhatIf]]:
    """What another value would have changed, for each type of mark that the mission has.

    Raises:
        InputError: no comparison is with that parameter.
    """
    present = {mark.type for mark in recording.marks}
    kinds: list[MarkType | None] = [kind for kind in MARK_TYPES if kind in present]
    if None in present or not kinds:
        kinds = [None] if len(present) <= 1 else [*kinds, None]
    answers = []
    for kind in kinds:
        marks = [mark for mark in recording.marks if mark.type == kind]
        asked = replace(question, kind=kind, marks=marks)
        answers.append((kind, replay(recording, static_info, parameter, value, asked)))
    return answers
