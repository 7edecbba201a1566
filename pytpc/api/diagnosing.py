"""Which parameter is to blame, by all marks of a mission together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TypedDict, Unpack

from pytpc.api.missions import Source, find_declared, load_static, read, read_marked
from pytpc.base.errors import InputError
from pytpc.diagnosis.question import Question, Types
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.suggestion.blamed_advice import advise_blamed
from pytpc.present.answers import Diagnosed
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.ros.mission_run import PARAMS_FILE
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.changes import changes_between


class DiagnoseSettings(TypedDict, total=False):
    """The settings of ``diagnose`` as keywords."""

    types: Types
    reference: Recording | Source | None
    changes: Sequence[Change]
    top: int


def diagnose(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    question: Question | None = None,
    **settings: Unpack[DiagnoseSettings],
) -> Diagnosed:
    """How likely each parameter is to blame, by all marks of a mission, and which value to try.

    Args:
        mission: the mission with its marks.
        static_info: what the analysis found.
        question: all settings at once. Without it the declared ranges of parameters are looked for
            in the sources of the static information, and beside a mission that is given by its
            path.
        **settings: in place of ``question``. ``types``: with ``ignore`` the types of the marks do
            not count. ``reference``: a good run of the same build. ``changes``: what was changed
            since the last good run, see `pytpc.values.changes.read_changes` and
            `pytpc.values.changes.changes_between`. ``top``: for how many suspects there is a value
            to try.

    Raises:
        InputError: the mission has no marks, or something cannot be read.
        TypeError: both ``question`` and other settings are given, or a setting that there is not.
    """
    if question is not None and settings:
        raise TypeError("give a question or single settings, not both")
    recording, static = read_marked(mission), load_static(static_info)
    unknown = sorted(set(settings) - DiagnoseSettings.__annotations__.keys())
    if unknown:
        raise TypeError(f"diagnose() has no setting {', '.join(unknown)}")
    if question is None:
        source = None if isinstance(mission, Recording) else Path(mission)
        question = _question(static, source, settings)
    found = blame(recording, static, question)
    return Diagnosed(found, tuple(advise_blamed(found, recording, static, question)))


def changes_since(before: Path, mission: Path) -> tuple[Change, ...]:
    """What differs between a params.yaml of earlier and the one in a mission's folder.

    Raises:
        InputError: one of them is not there or cannot be read.
    """
    folder = mission if mission.is_dir() else mission.parent
    after = folder / PARAMS_FILE
    if not after.is_file():
        raise InputError(f"has no {PARAMS_FILE} beside it to compare with --before", mission)
    return changes_between(before, after)


def is_compared(changes: Sequence[Change], static_info: StaticInfo) -> bool:
    """Whether one of the changed parameters is compared anywhere: else they say nothing."""
    names = Tpcs.of(static_info).names
    return any(same_parameter(one.parameter, name) for one in changes for name in names)


def _question(static: StaticInfo, source: Path | None, settings: DiagnoseSettings) -> Question:
    reference = settings.get("reference")
    return Question(
        types=settings.get("types", "believe"),
        top=settings.get("top", Question().top),
        reference=None if reference is None else read(reference),
        changes=settings.get("changes", ()),
        declared=find_declared(static, source),
    )
