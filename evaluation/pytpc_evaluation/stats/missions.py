"""The missions of a study: recordings, with the treatment that each was flown under.

``load_missions`` finds them in folders; ``in_order`` gives each its name among the trials.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.ingest.reading import read
from pytpc.recording.marks import Mark
from pytpc.recording.mission import RUN_FILE, Recording, is_converted
from pytpc_evaluation.treatment import TREATMENT_FILE, Treatment, TreatmentType, load_treatment

UNNAMED = "unnamed"
"""The user whose marks have no namespace."""

_ORDER: Sequence[TreatmentType | None] = ("type1", "type2", "fault", "clean", None)
_BAG = ".bag"
_SIGHTS_FILE = "sights.parquet"


@dataclass(frozen=True, eq=False)
class StudyMission:
    """One mission of a study.

    ``name`` is that of its folder or file. ``treatment`` and ``seed`` are None where nobody wrote
    them down. ``bag`` has the topics that were recorded besides the reports, ``sights`` what a
    person beside the field sees of the robot; None without one. ``source`` is the folder or file
    that it was read from.
    """

    name: str
    recording: Recording
    treatment: Treatment | None = None
    seed: int | None = None
    bag: Path | None = None
    sights: Path | None = None
    source: Path | None = None

    @property
    def kind(self) -> TreatmentType | None:
        """What sort of treatment it is, None where that is not known."""
        return None if self.treatment is None else self.treatment.type


@dataclass(frozen=True, eq=False)
class Trial:
    """A mission with its name among those of the study: ``TREATMENT trial 2``."""

    label: str
    mission: StudyMission


def in_order(missions: Iterable[StudyMission]) -> list[Trial]:
    """The missions as the thesis lists them: type I, type II, source-code fault, clean, others.

    Treatments of one type are sorted by name; the trials of one by seed, then as they are given.
    """
    known = sorted(missions, key=_place)
    groups = Counter(_group(mission) for mission in known)
    number: Counter[str] = Counter()
    trials = []
    for mission in known:
        group = _group(mission)
        number[group] += 1
        counted = mission.treatment is not None or groups[group] > 1
        trials.append(Trial(f"{group} trial {number[group]}" if counted else group, mission))
    return trials


def users_of(missions: Iterable[StudyMission]) -> list[str]:
    """The users who marked in any of the missions, ``marks2`` before ``marks10``."""
    found = {user_of(mark) for mission in missions for mark in mission.recording.marks}
    return sorted(found, key=_natural)


def user_of(mark: Mark) -> str:
    """Who set a mark: the namespace of its topic."""
    return mark.observer or UNNAMED


def load_missions(
    paths: Sequence[Path],
    treatments: Path | None = None,
    reader: Callable[[Path], Recording] = read,
) -> list[StudyMission]:
    """Read missions.

    Args:
        paths: what `pytpc.ingest.reading.read` takes; a folder that is no recording stands for
            the missions in its folders.
        treatments: a folder of treatments, each in a folder of its name. A mission's treatment is
            what ``treatment.json`` in its folder says; else that of ``treatments`` which run.json
            names, or which the mission's folder or the one above is called after; else the one
            that run.json names, if it is still where it was.
        reader: reads a recording, `pytpc.ingest.reading.read` or what shows its progress.

    Raises:
        InputError: a recording or a treatment cannot be read, or a mission is given twice.
    """
    known = {} if treatments is None else _treatments(treatments)
    found = [mission for path in paths for mission in _expanded(path)]
    twice = [path for path, count in Counter(path.resolve() for path in found).items() if count > 1]
    if twice:
        raise InputError("this mission is given twice", twice[0])
    return [_load(path, known, reader) for path in found]


def _load(
    path: Path, known: dict[str, Treatment], reader: Callable[[Path], Recording]
) -> StudyMission:
    folder = path if path.is_dir() else path.parent
    run = _run(folder / RUN_FILE)
    whole = path.is_dir() or bool(run)
    name = folder.name if whole else path.stem
    recording = replace(reader(path), name=name)
    args = run.get("args")
    given = args if isinstance(args, dict) else {}
    # A bag in a folder of many says nothing about the mission by its folder's name.
    treatment = _treatment(folder, given, known) if whole else None
    seed = str(given.get("seed", ""))
    return StudyMission(
        name=name,
        recording=recording,
        treatment=treatment,
        seed=int(seed) if re.fullmatch(r"[0-9]{1,18}", seed) else None,
        bag=_bag(path, run),
        sights=sights if whole and (sights := folder / _SIGHTS_FILE).is_file() else None,
        source=path,
    )


def _treatment(folder: Path, args: dict[str, Any], known: dict[str, Treatment]) -> Treatment | None:
    if (folder / TREATMENT_FILE).is_file():
        return load_treatment(folder)
    overlay = args.get("treatment")
    named = Path(overlay).parent if isinstance(overlay, str) and overlay else None
    absolute = folder.resolve()
    names = [absolute.name, absolute.parent.name]
    for name in [named.name, *names] if named is not None else names:
        if name in known:
            return known[name]
    if named is not None and (named / TREATMENT_FILE).is_file():
        return load_treatment(named)
    return None


def _treatments(folder: Path) -> dict[str, Treatment]:
    """The treatments in a folder, or the one that it is, by the names of their folders."""
    if (folder / TREATMENT_FILE).is_file():
        return {folder.name: load_treatment(folder)}
    if not folder.is_dir():
        raise InputError("no such folder of treatments", folder)
    found = sorted(path.parent for path in folder.glob(f"*/{TREATMENT_FILE}"))
    if not found:
        raise InputError(f"no folder in it has a {TREATMENT_FILE}", folder)
    return {path.name: load_treatment(path) for path in found}


def _expanded(path: Path) -> list[Path]:
    if not path.is_dir() or is_converted(path) or (path / RUN_FILE).is_file():
        return [path]
    below = sorted({run.parent for run in path.rglob(RUN_FILE)})
    return below or [path]


def _run(path: Path) -> dict[str, Any]:
    """run.json, empty where there is none.

    Raises:
        InputError: it is no JSON.
    """
    if not path.exists():
        return {}
    document = parse_json(path)
    if not isinstance(document, dict):
        raise InputError("not a run's file: an object is expected", path)
    return document


def _bag(path: Path, run: dict[str, Any]) -> Path | None:
    if not path.is_dir():
        return path if path.suffix == _BAG else None
    if (path / "metadata.yaml").is_file():
        return path
    named = run.get("bag")
    if isinstance(named, str) and (path / named).is_file():
        return path / named
    bags = [entry for entry in sorted(path.iterdir()) if entry.suffix == _BAG]
    return bags[0] if bags else None


def _group(mission: StudyMission) -> str:
    return mission.name if mission.treatment is None else mission.treatment.name


def _place(mission: StudyMission) -> tuple[int, list[tuple[int, str]], int]:
    seed = -1 if mission.seed is None else mission.seed
    return (_ORDER.index(mission.kind), _natural(_group(mission)), seed)


def _natural(name: str) -> list[tuple[int, str]]:
    """Digits count as numbers."""
    parts = re.findall(r"[0-9]+|[^0-9]+", name)
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in parts]
