"""Finds the missions in the files and folders that somebody wants to add to a fleet's data set."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from pytpc.base.closest import path_hint
from pytpc.base.errors import InputError
from pytpc.fleet.data_set import FLEET_FILE
from pytpc.ingest.reading import holds_mission
from pytpc.recording.mission import RUN_FILE, is_converted, is_ros2_folder

BAGS = (".bag", ".mcap", ".db3")


class Given(NamedTuple):
    """A mission to add: its path, and the name of its robot.

    A folder that cannot be searched for missions stands for them; ``why`` says why then.
    """

    path: Path
    robot: str
    why: str = ""


def missions_at(paths: Iterable[Path], robot: str | None = None) -> list[Given]:
    """The missions at paths, each once: recordings, and all that lie in folders, at any depth.

    A folder that is one mission by its form is one, also with several files; in other folders each
    bag is a mission. Links to folders are not followed.

    Args:
        paths: files and folders.
        robot: the name of their robot. None: the first folder below the given one, if the missions
            lie deeper; else the name of the given folder, or of that with the file.

    Raises:
        InputError: a path is not there, or has no mission.
    """
    found: dict[Path, Given] = {}
    for path in paths:
        if not path.exists():
            raise InputError(f"no such bag, file or folder{path_hint(path)}", path)
        before = len(found)
        for one, why in _below(path) if path.is_dir() else [(path, "")]:
            if why and one == path:
                raise InputError(why, path)
            name = (robot or _robot_of(one, path)).encode("utf-8", "surrogateescape")
            found.setdefault(one.absolute(), Given(one, name.decode("utf-8", "replace"), why))
        if len(found) == before and not any(path.absolute() in one.parents for one in found):
            raise InputError("no recordings in this folder, or in those in it", path)
    return [found[path] for path in sorted(found)]


def _below(folder: Path) -> Iterator[tuple[Path, str]]:
    """The missions in a folder, at any depth; and folders that cannot be read, with the reason."""
    left = [folder]
    while left:
        one = left.pop()
        try:
            missions, folders = _in(one)
        except OSError as error:
            yield one, f"cannot be read: {error.strerror or error}"
            continue
        yield from ((mission, "") for mission in missions)
        left += reversed(folders)


def _in(folder: Path) -> tuple[list[Path], list[Path]]:
    """The missions in a folder, and the folders that may have more.

    Raises:
        OSError: it cannot be read.
    """
    entries = sorted(one for one in folder.iterdir() if not one.name.startswith("."))
    names = {one.name for one in entries}
    if RUN_FILE in names or is_converted(folder) or is_ros2_folder(folder):
        return [folder], []
    if FLEET_FILE in names:
        return [], []
    bags = [one for one in entries if one.suffix in BAGS and one.is_file()]
    if not bags and holds_mission(folder):
        return [folder], []
    return bags, [one for one in entries if one.is_dir() and not one.is_symlink()]


def _robot_of(mission: Path, given: Path) -> str:
    given, mission = given.absolute(), mission.absolute()
    if mission == given:
        return given.parent.name or "robot"
    between = mission.relative_to(given).parts[:-1]
    return between[0] if between else given.name or "robot"
