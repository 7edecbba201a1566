"""The study's missions as cases for the methods; those that are held back only where asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, Literal, get_args

import pyarrow as pa

from pytpc.api.wired_robot import with_wiring
from pytpc.base.checked_json import parse_json
from pytpc.base.columns import read_table
from pytpc.base.errors import InputError, TpcError
from pytpc.diagnosis.thinned import thinned
from pytpc.recording.marks import MARK_TYPES, Mark, MarkType, with_where
from pytpc.recording.mission import Recording, load_recording
from pytpc.recording.parameter_change import Change
from pytpc.static.static_info import StaticInfo
from pytpc.values.changes import read_changes
from pytpc_evaluation.study.case import Case
from pytpc_evaluation.study.changes import CHANGES_FILE
from pytpc_evaluation.study.dataset import (
    CAUSES_FILE,
    DONE_FILE,
    MARKED_FILE,
    STUDY_FILE,
    Cause,
    load_causes,
)
from pytpc_evaluation.study.plan import Half
from pytpc_evaluation.study.where import place_of
from pytpc_evaluation.treatment import TREATMENT_FILE

Labels = Literal["typed", "untyped", "confused"]
LABELS: tuple[Labels, ...] = get_args(Labels)
ALL = "all"
MISSIONS = "missions"


@dataclass(frozen=True)
class UserMark:
    """A row of ``marks.parquet``: the visible kind of the error, and the type that was said.

    ``note`` is what else the observer said; the study's own say nothing.
    """

    time_ns: int
    observer: str
    cause: int
    right: MarkType
    said: MarkType
    note: str = ""

    def mark(self, labels: Labels, where: str = "") -> Mark:
        """The mark as a method gets it; ``where`` is what the observer says of the place."""
        types: dict[Labels, MarkType | None] = {"typed": self.right, "confused": self.said}
        note = with_where(self.note, [where] if where else [])
        return Mark(self.time_ns, types.get(labels), self.observer, note)


@dataclass(frozen=True, eq=False)
class Mission:
    """A mission of the study.

    ``type`` is that of the treatment; ``parameter`` and ``node`` are what it changed, None where
    nothing was; ``round`` is when the treatment was made. ``good`` are good runs with other
    settings, as they are learned; ``causes`` is what was seen to be wrong.
    """

    system: str
    treatment: str
    type: str
    half: Half
    seed: int
    parameter: str | None
    node: str | None
    recording: Recording
    static_info: StaticInfo
    marks: tuple[UserMark, ...]
    reference: Recording | None
    changes: tuple[Change, ...]
    round: int = 1
    good: tuple[Recording, ...] = ()
    causes: tuple[Cause, ...] = ()

    def case(self, labels: Labels, who: str = ALL) -> Case:
        """What a method gets to see, with the marks of all users or of one."""
        own = [m for m in self.marks if who in {ALL, m.observer}]
        plain = sorted((m.mark(labels) for m in own), key=Mark.order)
        placed = sorted((m.mark(labels, self._where(m)) for m in own), key=Mark.order)
        return Case(
            replace(self.recording, marks=tuple(plain)),
            self.static_info,
            self.reference,
            self.changes,
            self.good,
            tuple(placed),
        )

    def _where(self, mark: UserMark) -> str:
        """What the observer of a mark says of the place; nothing of a false alarm."""
        if not 0 <= mark.cause < len(self.causes):
            return ""
        return place_of(self.system, self.causes[mark.cause].reason)


def missions(
    out: Path,
    wanted: Sequence[Half] = ("tuning",),
    on_progress: Callable[[int, int], None] | None = None,
) -> Iterator[Mission]:
    """Read the missions of a study's folder, one at a time, sorted.

    Nothing is read of a mission whose half is not wanted.

    Args:
        out: the study's folder.
        wanted: the halves; who works on a ranking leaves this as it is.
        on_progress: called with (missions read, missions in all).

    Raises:
        InputError: a file is missing or broken.
    """
    found = places(out, wanted)
    for number, (path, half) in enumerate(found, start=1):
        yield load_mission(out, path, half)
        if on_progress is not None:
            on_progress(number, len(found))


def load_mission(out: Path, path: Path, half: Half) -> Mission:
    """Read one mission of the study in ``out``.

    Raises:
        InputError: a file is missing or broken.
    """
    system = path.parent.parent.name
    treatment = _treatment(path / TREATMENT_FILE)
    return Mission(
        system=system,
        treatment=path.parent.name,
        type=treatment["type"],
        half=half,
        seed=seed_of(path),
        parameter=treatment["parameter"],
        node=treatment["node"],
        recording=with_wiring(load_recording(path), path),
        static_info=_static(out / "systems" / system / "static.json"),
        marks=user_marks(path / MARKED_FILE),
        reference=_reference(out / "reference" / system),
        changes=_changes(path / CHANGES_FILE),
        round=treatment.get("round", 1),
        good=tuple(_thinned(one) for one in drawn_good_runs(out, path)),
        causes=_causes(path / CAUSES_FILE),
    )


def user_marks(path: Path) -> tuple[UserMark, ...]:
    """Read ``marks.parquet``.

    Raises:
        InputError: the file cannot be read, or a mark in it has no such type.
    """

    def rows(table: pa.Table) -> tuple[UserMark, ...]:
        names = ["time_ns", "observer", "cause", "right", "said"]
        missing = sorted({*names} - {*table.column_names})
        if missing:
            raise InputError(f"no column {missing[0]}")
        found = [UserMark(**row) for row in table.select(names).to_pylist()]
        wrong = [m for m in found if m.right not in MARK_TYPES or m.said not in MARK_TYPES]
        if wrong:
            raise InputError(f"a mark of type {wrong[0].right!r}, said to be {wrong[0].said!r}")
        return tuple(sorted(found, key=lambda m: (m.time_ns, m.observer)))

    return read_table(path, "marks", rows)


def places(out: Path, wanted: Sequence[Half]) -> list[tuple[Path, Half]]:
    """The folders of the flown missions in the wanted halves, sorted, each with its half.

    The halves are those that the study was begun with: worked out from what has been flown so far
    they would change as it grows.

    Raises:
        InputError: ``study.json`` is missing or broken.
    """
    document = parse_json(out / STUDY_FILE)
    rows = document.get("missions") if isinstance(document, dict) else None
    try:
        if not isinstance(rows, list):
            raise ValueError("it does not say which missions there are")
        halves: dict[Path, Half] = {out / row["folder"]: row["half"] for row in rows}
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"not a study's file: {error}", out / STUDY_FILE) from error
    return sorted(
        (path, half)
        for path, half in halves.items()
        if half in wanted
        and path.parent.parent.parent == out / MISSIONS
        and (path / DONE_FILE).is_file()
    )


def _treatment(path: Path) -> dict[str, Any]:
    document = parse_json(path)
    if not isinstance(document, dict):
        raise InputError("not a treatment: an object is expected", path)
    missing = {"type", "parameter", "node"} - set(document)
    if missing:
        raise InputError(f"not a treatment: no {min(missing)}", path)
    return document


def _changes(path: Path) -> tuple[Change, ...]:
    return read_changes(path) if path.is_file() else ()


def _causes(path: Path) -> tuple[Cause, ...]:
    """What was seen to be wrong; nothing where only marks are known."""
    return tuple(load_causes(path)) if path.is_file() else ()


@cache
def _static(path: Path) -> StaticInfo:
    return StaticInfo.load(path)


@cache
def _reference(path: Path) -> Recording | None:
    return load_recording(path) if path.is_dir() else None


@cache
def _thinned(path: Path) -> Recording:
    """A good run, as it is learned."""
    return thinned(load_recording(path))


def drawn_good_runs(out: Path, mission: Path) -> list[Path]:
    """The good runs of a mission's robot, in an order that is drawn for each mission.

    A method takes the first ones.
    """
    system, name = mission.parent.parent.name, f"{mission.parent.name}/{mission.name}"
    every = sorted((out / "good" / system).glob("seed-*"))
    runs = [one for one in every if (one / DONE_FILE).is_file()]
    drawn = [
        sha256(f"{system}/{name}/{number}".encode()).hexdigest() for number in range(len(runs))
    ]
    return [run for _, run in sorted(zip(drawn, runs, strict=True))]


def seed_of(path: Path) -> int:
    """The seed of a mission, from its folder.

    Raises:
        TpcError: the folder is not called after one.
    """
    try:
        return int(path.name.removeprefix("seed-"))
    except ValueError as error:
        raise TpcError(f"{path}: a mission's folder is called seed-N") from error
