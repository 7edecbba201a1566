"""The study's folder, read: its systems and their missions (docs/reference/study-data.md).

Whatever is missing or broken is said in a sentence and left out: a page of a part of the study is
better than none.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError, TpcError
from pytpc.base.wording import many
from pytpc.recording.marks import Mark
from pytpc.recording.parameter_change import Change
from pytpc.static.parameters import parameter_name, same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.changes import read_changes
from pytpc_evaluation.stats.missions import StudyMission, load_missions
from pytpc_evaluation.study.changes import CHANGES_FILE
from pytpc_evaluation.study.data import MISSIONS, user_marks
from pytpc_evaluation.study.dataset import (
    CAUSES_FILE,
    DONE_FILE,
    MARKED_FILE,
    STUDY_FILE,
    load_causes,
)
from pytpc_evaluation.survey.source_lines import count_lines
from pytpc_evaluation.treatment import Treatment

UNKNOWN = "unknown"
_SEED = "seed-"

Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class FlownMission:
    """A mission of the study; ``said`` are its marks with the types that the users gave.

    ``changes`` are the treatment's own and the harmless ones.

    The recording's own marks have the types that were right to give. ``half`` is a ``Half``, or
    ``UNKNOWN``. ``strayed``: the first error that was seen is not of the treatment's type, so that
    it may be one of the flight's own and not the treatment's.
    """

    system: str
    half: str
    seed: int
    mission: StudyMission
    treatment: Treatment
    said: tuple[Mark, ...]
    changes: tuple[Change, ...] = ()
    strayed: bool = False

    def as_said(self) -> StudyMission:
        """The mission with the marks as the users set them."""
        return replace(self.mission, recording=replace(self.mission.recording, marks=self.said))


@dataclass(frozen=True, eq=False)
class FlownSystem:
    """A robot of the study: what the analysis found in it, its missions, and a clean one apart.

    ``remarks`` say in sentences where a mission did not go as its treatment demands.
    """

    name: str
    static_info: StaticInfo
    flights: tuple[FlownMission, ...]
    reference: StudyMission | None
    sources: Path | None
    remarks: tuple[str, ...] = ()

    @cached_property
    def lines(self) -> int | None:
        """Lines of code of the workspace's sources, None where they are not there."""
        if self.sources is None:
            return None
        return sum(count.code for count in count_lines(self.sources).languages.values())

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """All parameters with which something is compared, sorted."""
        found = self.static_info.thresholds.values()
        return tuple(sorted({parameter_name(comparison) for comparison in found}))

    @property
    def clean(self) -> list[StudyMission]:
        """The missions in which nothing was wrong."""
        flown = [flight.mission for flight in self.flights if flight.treatment.type == "clean"]
        return flown or ([self.reference] if self.reference is not None else [])

    def language(self, parameter: str) -> str:
        """In which language a parameter is compared; ``both``, or ``-`` where nowhere."""
        info = self.static_info
        found = {
            "Python" if info.unit_of(key).is_python else "C++"
            for key, comparison in info.thresholds.items()
            if same_parameter(parameter, parameter_name(comparison))
        }
        return "both" if len(found) > 1 else next(iter(found), "-")


@dataclass(frozen=True, eq=False)
class FlownStudy:
    """All that is read of a study but its results; ``troubles`` are sentences."""

    systems: tuple[FlownSystem, ...]
    troubles: tuple[str, ...]


def load_study(folder: Path, on_progress: Progress | None = None) -> FlownStudy:
    """Read a study's folder.

    Args:
        folder: with ``systems`` and ``missions``.
        on_progress: called with (missions read, missions in all).

    Raises:
        InputError: there is no such folder, or ``study.json`` is missing or broken.
    """
    if not folder.is_dir():
        raise InputError("no such folder; `pytpc study run` makes it", folder)
    document = parse_json(folder / STUDY_FILE)
    if not isinstance(document, dict):
        raise InputError("not a study's file: an object is expected", folder / STUDY_FILE)
    troubles: list[str] = []
    names = sorted(path.name for path in (folder / MISSIONS).glob("*") if path.is_dir())
    paths = {name: sorted((folder / MISSIONS / name).glob(f"*/{_SEED}[0-9]")) for name in names}
    total, done = sum(map(len, paths.values())), 0
    systems = []
    for name in names:
        try:
            static_info = StaticInfo.load(folder / "systems" / name / "static.json")
        except TpcError as error:
            troubles.append(f"{name} is left out: {told(error, folder)}.")
            continue
        planned = _planned(document, name)
        troubles += _unflown(planned, name)
        unflown = {row["folder"] for row in planned if row.get("state") != "done"}
        halves = _halves(planned)
        flights = []
        for path in paths[name]:
            done += 1
            if on_progress is not None:
                on_progress(done, total)
            if _place(path, folder) in unflown and not (path / DONE_FILE).is_file():
                continue
            try:
                flights.append(_flight(path, name, halves))
            except TpcError as error:
                troubles.append(f"{_place(path, folder)} is left out: {told(error, folder)}.")
        systems.append(
            FlownSystem(
                name,
                static_info,
                tuple(flights),
                _reference(folder, name, troubles),
                _sources(folder / "systems" / name / "ws" / "src"),
                _remarks(planned),
            )
        )
    troubles += [
        f"No mission of {name} has been flown." for name in _systems(document) if name not in names
    ]
    if not names:
        troubles.append("No mission has been flown.")
    return FlownStudy(tuple(systems), tuple(troubles))


def _flight(path: Path, system: str, halves: Mapping[tuple[str, int], str]) -> FlownMission:
    if not (path / DONE_FILE).is_file():
        raise TpcError("it was not flown to its end")
    (mission,) = load_missions([path])
    if mission.treatment is None:
        raise TpcError("it has no treatment.json")
    seed = int(path.name.removeprefix(_SEED))
    half = halves.get((mission.treatment.name, seed), UNKNOWN)
    said = [mark.mark("confused") for mark in user_marks(path / MARKED_FILE)]
    marks = tuple(sorted(said, key=Mark.order))
    changes = path / CHANGES_FILE
    made = read_changes(changes) if changes.is_file() else ()
    strayed = _strayed(path / CAUSES_FILE, mission.treatment)
    return FlownMission(system, half, seed, mission, mission.treatment, marks, made, strayed)


def _strayed(causes: Path, treatment: Treatment) -> bool:
    if treatment.mark_type is None or not causes.is_file():
        return False
    first = min(load_causes(causes), key=lambda cause: cause.start, default=None)
    return first is not None and first.kind != treatment.mark_type


def _reference(folder: Path, name: str, troubles: list[str]) -> StudyMission | None:
    path = folder / "reference" / name
    try:
        (mission,) = load_missions([path])
    except TpcError as error:
        troubles.append(f"The clean reference of {name} is missing: {told(error, folder)}.")
        return None
    return mission


def _systems(document: Mapping[str, Any]) -> list[str]:
    """The systems that the study is to have."""
    found = document.get("systems")
    rows: Sequence[Any] = found if isinstance(found, list) else []
    return [str(row.get("name")) for row in rows if isinstance(row, dict)]


def _planned(document: Mapping[str, Any], system: str) -> list[dict[str, Any]]:
    """What study.json says of the missions of a system."""
    found = document.get("missions")
    rows: Sequence[Any] = found if isinstance(found, list) else []
    own = [row for row in rows if isinstance(row, dict) and row.get("system") == system]
    return [row for row in own if str(row.get("folder", "")).startswith(f"{MISSIONS}/")]


def _halves(planned: Sequence[Mapping[str, Any]]) -> dict[tuple[str, int], str]:
    """The half of each mission by treatment and seed, as the study was planned."""
    return {
        (str(row.get("treatment")), int(row.get("seed") or 0)): str(row.get("half") or UNKNOWN)
        for row in planned
    }


def _unflown(planned: Sequence[Mapping[str, Any]], system: str) -> list[str]:
    """Sentences about missions that failed, or are still to be flown."""
    failed = [
        f"{row['folder']} failed: {str(row['error']).rstrip('.')}."
        for row in planned
        if row.get("error")
    ]
    missing = sum(row.get("state") == "planned" for row in planned)
    left = [f"Still to be flown: {many(missing, 'mission')} of {system}."] if missing else []
    return failed + left


def _remarks(planned: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    return tuple(
        f"{str(row['folder']).removeprefix(f'{MISSIONS}/')}: {remark}"
        for row in planned
        for remark in row.get("remarks") or ()
    )


def _sources(folder: Path) -> Path | None:
    return folder if folder.is_dir() else None


def _place(path: Path, folder: Path) -> str:
    return path.relative_to(folder).as_posix()


def told(error: TpcError, folder: Path) -> str:
    """An error without its full stop, and without where the study's folder happens to be."""
    return str(error).replace(f"{folder}/", "").rstrip(".")
