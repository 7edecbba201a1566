"""The static information of a mission: the one that it was recorded with, or one that fits."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pytpc.api.missions import check_has_reports, reported_keys
from pytpc.base.errors import InputError, TpcError
from pytpc.base.paths import MERGED_FILE, OWN_FOLDER, sourced_prefixes
from pytpc.base.wording import many
from pytpc.recording.mission import RUN_FILE, Recording, read_run
from pytpc.static.parameters import base_key
from pytpc.static.static_info import StaticInfo, read_static

_STATIC_PATHS = "TPC_STATIC"
_PACKAGE_PATHS = "ROS_PACKAGE_PATH"
_BUILT_BY = ("COLCON_IGNORE", ".built_by", "CMakeCache.txt")
"""A build folder of a workspace has one of these files, by colcon, catkin tools or catkin_make."""
GIVE = "give it with --static WORKSPACE, the one that `pytpc build` built"
"""What to type where no static information is found."""
NONE_FOUND = "no static information in this folder, or in a sourced workspace"


@dataclass(frozen=True, slots=True)
class FoundStatic:
    """Static information, and the file or workspace that it was read from.

    ``is_own`` says that it lies in the recording's own folder. Otherwise ``known`` of the
    ``reported`` comparisons are in it; both are 0 where nothing was reported so far.
    """

    static: StaticInfo
    path: Path
    is_own: bool = False
    known: int = 0
    reported: int = 0

    @property
    def words(self) -> str:
        """Which one it is, in a line."""
        fits = f" (it has {self.known:,} of {many(self.reported, 'reported comparison')})"
        return f"static information: {self.path}{fits if self.reported else ''}"


def own_static(mission: Path) -> Path | None:
    """The static information in the folder of a mission, given by its folder or its bag.

    None if a recorder guessed it, before anything was reported: another one may fit better.
    """
    folder = _folder_of(mission)
    file = folder / MERGED_FILE
    is_recorded = mission.is_dir() or (folder / RUN_FILE).is_file()
    is_own = is_recorded and file.is_file() and _static_in(folder).get("guessed") is not True
    return file if is_own else None


def recorded_static(mission: Path, recording: Recording) -> Path | None:
    """The static information of the build that a mission was recorded with; None: not known.

    It is the recording's own. A copy that a recorder guessed counts, too, if it has all that was
    reported: it was copied while these nodes ran.
    """
    own = own_static(mission)
    file = _folder_of(mission) / MERGED_FILE
    if own is not None or _static_in(file.parent).get("guessed") is not True:
        return own
    try:
        known = StaticInfo.load(file).comparisons.keys()
    except TpcError:
        return None
    reported = set(map(base_key, reported_keys(recording)))
    return file if reported and reported <= known else None


def static_to_keep(given: Path | None) -> FoundStatic | None:
    """The static information that the recording of a running robot is to keep.

    Args:
        given: a file, a build base or a workspace; None: what ``find_static`` finds.

    Returns:
        None where nothing was given and none is found.

    Raises:
        InputError: what was given is broken, or is not there.
    """
    if given is None:
        try:
            return find_static()
        except InputError:
            return None
    place = next(_at(given), given)
    static = _read(place) if place.exists() else read_static(place)
    return FoundStatic(static, place)


def find_static(
    mission: Path | None = None,
    recording: Recording | None = None,
    env: Mapping[str, str] = os.environ,
) -> FoundStatic:
    """The static information of a mission.

    The recording's own counts. Without it, that is taken which has most of the reported
    comparisons: of the place that run.json names, the folders above the recording and above this
    one, TPC_STATIC, and the sourced workspaces, in this order.

    Args:
        mission: its folder or file; None: a running robot.
        recording: what was read from it; None: nothing was reported so far, and the first place
            that has static information counts.
        env: says what is sourced.

    Raises:
        InputError: there is none, none fits, or the recording's own is broken.
    """
    own = None if mission is None else own_static(mission)
    if own is not None:
        return FoundStatic(StaticInfo.load(own), own, is_own=True)
    reported = frozenset[str]()
    if recording is not None and mission is not None:
        check_has_reports(recording, mission)
        reported = frozenset(map(base_key, reported_keys(recording)))
    best: FoundStatic | None = None
    seen: list[Path] = []
    for place in _places(mission, env):
        seen.append(place)
        try:
            static = _read(place)
        except TpcError:
            continue
        known = len(reported.intersection(static.comparisons))
        if best is None or known > best.known:
            best = FoundStatic(static, place, known=known, reported=len(reported))
        if known == len(reported):
            break
    if best is None or (reported and not best.known):
        raise InputError(_why_none(seen, mission), mission)
    return best


def static_near(path: Path) -> StaticInfo | None:
    """The static information of a mission, or of the workspace that a file or folder is in.

    Other than ``find_static`` it does not look in this folder or in sourced workspaces, because
    nothing says whether that fits. None if there is none, or it cannot be read.
    """
    own = own_static(path)
    for place in (own,) if own is not None else _near(path):
        try:
            return _read(place)
        except TpcError:
            continue
    return None


def _why_none(seen: list[Path], mission: Path | None) -> str:
    if not seen:
        near = "" if mission is None else "its folder, above it, in "
        return f"no static information in {near}this folder, or in a sourced workspace; {GIVE}"
    places = f"{seen[0]}" + (f" and {len(seen) - 1} more" if len(seen) > 1 else "")
    return f"no static information that was found knows its reports ({places}); {GIVE}"


def _read(place: Path) -> StaticInfo:
    if place.is_file():
        return StaticInfo.load(place)
    # Its import takes longer than to read a file, and needs the analysis of Python.
    from pytpc.build.collect import collect_sources  # noqa: PLC0415

    return collect_sources([place]).static


def _folder_of(mission: Path) -> Path:
    return mission if mission.is_dir() else mission.parent


def _places(mission: Path | None, env: Mapping[str, str]) -> Iterator[Path]:
    """Files and workspaces with static information, each once, the likeliest first."""
    found = dict[str, Path]()
    for place in _candidates(mission, env):
        real = os.path.realpath(place)
        if real not in found:
            found[real] = place
            yield place


def _candidates(mission: Path | None, env: Mapping[str, str]) -> Iterator[Path]:
    if mission is not None:
        yield from _near(mission)
    yield from _above(Path.cwd())
    for text in env.get(_STATIC_PATHS, "").split(os.pathsep):
        if text:
            yield from (Path(text),) if Path(text).is_file() else _at(Path(text))
    sources = [Path(text) for text in env.get(_PACKAGE_PATHS, "").split(os.pathsep) if text]
    for prefix in (*sourced_prefixes(env), *sources):
        yield from _above(prefix)


def _near(path: Path) -> Iterator[Path]:
    """Of the copy beside it, what run.json names, and of the folders above."""
    folder = _folder_of(path)
    if (folder / MERGED_FILE).is_file():
        yield folder / MERGED_FILE
    named = _named_in(folder)
    if named is not None:
        yield from (named,) if named.is_file() else _at(named.parent.parent)
    yield from _above(folder.absolute())


def _above(folder: Path) -> Iterator[Path]:
    for up in _with_parents(folder):
        yield from _at(up)


def _with_parents(folder: Path) -> Iterable[Path]:
    """The folder and those above it; never the root, which is nobody's workspace."""
    return [up for up in (folder, *folder.parents) if up != up.parent]


def _at(folder: Path) -> Iterator[Path]:
    """What a folder has: a file of its own, what `pytpc build` left, or a build of another tool."""
    for file in (folder / MERGED_FILE, folder / OWN_FOLDER / MERGED_FILE):
        if file.is_file():
            yield file
            return
    if (folder / "src").is_dir() and any((folder / "build" / n).is_file() for n in _BUILT_BY):
        yield folder


def _named_in(folder: Path) -> Path | None:
    """The file of static information that run.json names; None if it names none."""
    named = _static_in(folder).get("path")
    return Path(named) if isinstance(named, str) and named.startswith("/") else None


def _static_in(folder: Path) -> dict[str, Any]:
    """What run.json says of the static information; empty if it says nothing."""
    static = read_run(folder).get("static")
    return static if isinstance(static, dict) else {}
