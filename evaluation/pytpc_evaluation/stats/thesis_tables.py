"""The tables of a study by name and by the thesis's number, and what is wrong with its data."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import TypeVar

from pytpc.diagnosis.full_names import with_full_names
from pytpc.diagnosis.question import WINDOW_S
from pytpc.recording.faults import faults_of
from pytpc.static.parameters import parameter_name, same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.stats.delays import delays_of, delays_table
from pytpc_evaluation.stats.found import found_in, found_table
from pytpc_evaluation.stats.marked import MarksOfTrial, confusion_table, marks_table
from pytpc_evaluation.stats.missions import StudyMission, Trial, in_order, users_of
from pytpc_evaluation.stats.runtime import runtime_statistics, runtime_table
from pytpc_evaluation.tables import Table

Result = TypeVar("Result")

NUMBERS: Mapping[str, str] = {
    "runtime": "6.12",
    "confusion": "6.13",
    "delays": "6.14",
    "marks": "6.15",
    "found": "6.16",
}
"""The tables, by name, and which of the thesis each is."""


def thesis_tables(
    missions: Sequence[StudyMission],
    static_info: StaticInfo,
    names: Sequence[str] = tuple(NUMBERS),
    on_progress: Callable[[int, int], None] | None = None,
    *,
    window_s: float = WINDOW_S,
) -> list[Table]:
    """The tables of a study.

    Args:
        missions: in any order.
        static_info: of the build that flew them.
        names: of ``NUMBERS``, in the order in which the tables are wanted.
        on_progress: called with (tables done, tables in all).
        window_s: the window of type II in seconds, for table 6.16.

    Raises:
        KeyError: there is no table of such a name.
    """
    trials, users = in_order(missions), users_of(missions)
    makers: dict[str, Callable[[], Table]] = {
        "runtime": lambda: runtime_table(
            runtime_statistics([trial.mission.recording for trial in trials], static_info)
        ),
        "confusion": lambda: confusion_table([MarksOfTrial.of(trial) for trial in trials]),
        "delays": lambda: delays_table(_some(trials, static_info, delays_of), users),
        "marks": lambda: marks_table([MarksOfTrial.of(trial) for trial in trials], users),
        "found": lambda: found_table(
            _some(trials, static_info, partial(found_in, window_s=window_s))
        ),
    }
    tables = []
    for number, name in enumerate(names, start=1):
        tables.append(makers[name]())
        if on_progress is not None:
            on_progress(number, len(names))
    return tables


def study_complaints(mission: StudyMission, static_info: StaticInfo) -> Iterator[str]:
    """What a reader of the tables has to know about a mission, in sentences."""
    yield from faults_of(mission.recording, static_info)
    if not len(mission.recording.events) and not len(mission.recording.summaries):
        yield "no threshold reports: was the workspace built with TPC?"
    if mission.treatment is None:
        yield "its treatment is unknown, so it is left out of the tables about changed parameters"
    elif mission.treatment.parameter is not None and not any(
        same_parameter(mission.treatment.parameter, parameter_name(comparison))
        for comparison in with_full_names(static_info, mission.recording, {}).thresholds.values()
    ):
        yield (
            f"its treatment changed {mission.treatment.parameter}, with which nothing in the"
            " static information is compared"
        )


def _some(
    trials: Sequence[Trial],
    static_info: StaticInfo,
    of: Callable[[Trial, StaticInfo], Result | None],
) -> list[Result]:
    found = (of(trial, static_info) for trial in trials)
    return [result for result in found if result is not None]
