"""Where the marks live that people make after a recording. No other module decides that.

A folder is one mission: all files of marks in it are its marks, and new ones go to ``marks.csv``.
A recording in a folder that is one mission by its form (of ``pytpc record``, of rosbag2, of
``pytpc convert``) has the marks of that folder. A recording anywhere else has ``NAME.marks.csv``
beside it, and those of the folder's marks that lie within its time. What is read and written for
which input: docs/reference/recordings.md#where-marks-live.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.errors import TpcError
from pytpc.recording.marks import Mark, is_marks_file, joined, marks_beside, read_marks
from pytpc.recording.mission import (
    REPORTS_FOLDER,
    RUN_FILE,
    is_converted,
    is_ros2_folder,
)

MARKS_CSV = "marks.csv"
"""The marks of a folder, in it: they go where it goes."""
_BESIDE = marks_beside(Path("NAME")).name.removeprefix("NAME")


@dataclass(frozen=True, slots=True)
class MarksHome:
    """The files of marks of one recording; they need not exist.

    ``file`` gets new marks. ``others`` have marks of the recording, too: of earlier versions, or
    put there by hand. ``nearby`` are of the folder in which the recording lies with others, so that
    only the marks within its time are its own.
    """

    file: Path
    others: tuple[Path, ...] = ()
    nearby: tuple[Path, ...] = ()

    def files(self) -> list[Path]:
        """The files of marks that exist, without those nearby."""
        return [path for path in (self.file, *self.others) if _has_marks(path)]

    def marks(self) -> tuple[Mark, ...]:
        """The marks in these files.

        Raises:
            InputError: a file is broken.
        """
        return _marks_in(self.files())

    def marks_nearby(self) -> tuple[Mark, ...]:
        """The marks of the folder that it lies in; only those within its time are its own.

        Raises:
            InputError: a file is broken.
        """
        return _marks_in(self.files_nearby())

    def files_nearby(self) -> list[Path]:
        """The files of marks of the folder that it lies in."""
        return [path for path in self.nearby if is_marks_file(path)]

    def has(self, path: Path) -> bool:
        """Whether the marks in this file are read with the recording."""
        real = os.path.realpath(path)
        return any(os.path.realpath(own) == real for own in (self.file, *self.others))


def marks_home(recording: Path) -> MarksHome:
    """Where the marks of a recording are, whichever of its paths is given.

    Args:
        recording: a file or folder. A link, ``.`` or a path with ``..`` stands for what it leads
            to; the name that a link has is looked at, too, since earlier versions wrote beside it.
    """
    real = Path(os.path.realpath(recording))
    given = recording.absolute()
    if is_marks_file(real):
        return MarksHome(real)
    folder = _mission_of(real)
    if folder is None:
        file = marks_beside(real)
        return MarksHome(file, _others(file, [given]), _of_folder(real.parent))
    inside = _files_in(folder)
    if (folder / RUN_FILE).is_file():
        inside += _files_in(folder / REPORTS_FOLDER)
    linked = [path for path in (given, given.parent) if _leads_to(path, folder)]
    names = [folder, real, *linked, given]
    file = folder / MARKS_CSV
    return MarksHome(file, _others(file, names, inside), _of_folder(folder.parent))


def is_same_mission(one: Path, other: Path) -> bool:
    """Whether two recordings have their marks in common."""
    return marks_home(one).file == marks_home(other).file


def set_marks_aside(folder: Path, replaced: Collection[str]) -> list[Path]:
    """Keep the marks of a mission whose folder gets another one, under new names with ``.old``.

    Args:
        folder: of the mission.
        replaced: names of its recordings that go; marks of a recording that stays, stay with it.

    Returns:
        The new names. Nothing that has such a name already is replaced.

    Raises:
        TpcError: a file cannot be renamed.
    """
    kept = []
    for file in marks_home(folder).files():
        of = file.name.removesuffix(_BESIDE)
        is_in = file.parent == Path(os.path.realpath(folder))
        if is_in and of not in {file.name, *replaced} and file.with_name(of).exists():
            continue
        # The folder of the nodes' files is going to be deleted.
        aside = file.parent.parent if file.parent.name == REPORTS_FOLDER else file.parent
        target = _free_name(aside / f"{file.name}.old")
        try:
            file.rename(target)
        except OSError as error:
            what = f"earlier marks cannot be kept as {target.name}: {error.strerror or error}"
            raise TpcError(what, file) from error
        kept.append(target)
    return kept


def _mission_of(real: Path) -> Path | None:
    """The folder that is one mission and is or contains ``real``, if there is one."""
    reports = real if real.name == REPORTS_FOLDER else real.parent
    if reports.name == REPORTS_FOLDER and (reports.parent / RUN_FILE).is_file():
        return reports.parent
    if real.is_dir():
        return real
    parent = real.parent
    is_one = is_converted(parent) or is_ros2_folder(parent) or (parent / RUN_FILE).is_file()
    return parent if is_one else None


def _files_in(folder: Path) -> list[Path]:
    """The files of marks in a folder, by name."""
    try:
        found = sorted(folder.glob("*.csv"))
    except OSError:
        return []
    return [path for path in found if not path.name.startswith(".") and _has_marks(path)]


def _has_marks(path: Path) -> bool:
    """Whether it must be a file of marks: by its name, or else by its content."""
    return path.is_file() if path.name.endswith(_BESIDE) else is_marks_file(path)


def _others(file: Path, names: Iterable[Path], inside: Iterable[Path] = ()) -> tuple[Path, ...]:
    """The files of ``inside`` and beside ``names``, each once and without ``file``."""
    found = [*inside, *(marks_beside(path) for path in names if path.name)]
    unique = {os.path.realpath(path): path for path in reversed(found)}
    unique.pop(os.path.realpath(file), None)
    return tuple(reversed(unique.values()))


def _of_folder(folder: Path) -> tuple[Path, ...]:
    """Where the marks of a folder of several recordings are, or were in earlier versions."""
    beside = [marks_beside(folder)] if folder.name else []
    return (folder / MARKS_CSV, *beside)


def _leads_to(path: Path, folder: Path) -> bool:
    return os.path.realpath(path) == str(folder)


def _marks_in(files: Iterable[Path]) -> tuple[Mark, ...]:
    return joined(mark for path in files for mark in read_marks(path))


def _free_name(path: Path) -> Path:
    """``path``, or the first of ``path.2``, ``path.3`` ... that does not exist."""
    number, free = 1, path
    while free.exists() or free.is_symlink():
        number += 1
        free = path.with_name(f"{path.name}.{number}")
    return free
