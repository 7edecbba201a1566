"""Files of link units that are no longer built.

A target may have been renamed or removed, or linked again without TPC; its file stays behind, and
its keys would be listed but never reported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from mmap import mmap
from pathlib import Path

from pytpc.static.link_unit import LinkUnit


@dataclass(frozen=True, slots=True)
class UnitFile:
    """The file of a link unit, ``<build folder>/tpc/<target>.json``; ``written_ns`` its time."""

    path: Path
    unit: LinkUnit
    written_ns: int = 0

    @property
    def build_folder(self) -> Path:
        """CMake's build folder."""
        own = self.unit.build_folder
        return self.path.parent.parent if own is None else Path(own)


@dataclass(frozen=True, slots=True)
class BuiltTarget:
    """A target that CMake knows; ``content`` is that of its file, None where it is not built."""

    name: str
    content: bytes | mmap | None


@dataclass(frozen=True, slots=True)
class Stale:
    """A file that was left out, and why."""

    file: UnitFile
    reason: str


def drop_stale(
    files: Iterable[UnitFile], targets: Mapping[Path, Sequence[BuiltTarget] | None]
) -> tuple[list[UnitFile], list[Stale]]:
    """Split files into those that are still built and those that are not.

    A unit is left out if CMake no longer knows its target, or if the target's file has none of the
    keys that were put into it. It stays if CMake was not asked, if the target is not built at
    present, if it has no keys to look for, and if it is a script, which has no target.

    Args:
        files: of any number of build folders.
        targets: build folder -> its targets; None where CMake left no answer.
    """

    def why(file: UnitFile) -> str | None:
        known = None if file.unit.is_python else targets.get(file.build_folder)
        return None if known is None else _why_stale(file, known)

    return _split(files, why)


def drop_without_sources(
    files: Iterable[UnitFile], workspaces: Iterable[str], gone: Callable[[str], bool]
) -> tuple[list[UnitFile], list[Stale]]:
    """Split files by whether their package is still there or was removed.

    Only packages inside one of ``workspaces`` are looked for, and only where another package of
    that workspace is found: a robot may have what was built without the sources.

    Args:
        files: of any number of build folders.
        workspaces: absolute folders.
        gone: whether a folder, a unit's ``source_root``, is missing.
    """
    files = list(files)
    roots = {file.unit.source_root for file in files}
    removed: set[str] = set()
    for workspace in workspaces:
        inside = {root for root in roots if Path(root).is_relative_to(workspace)}
        missing = {root for root in inside if gone(root)}
        removed |= missing if missing != inside else set()

    def why(file: UnitFile) -> str | None:
        root = file.unit.source_root
        return f"its sources, {root}, no longer exist" if root in removed else None

    return _split(files, why)


def drop_without_scripts(
    files: Iterable[UnitFile], gone: Callable[[str], bool]
) -> tuple[list[UnitFile], list[Stale]]:
    """Split files by whether their script was removed; units of targets have none and stay.

    Where all sources are missing, the script is not missed: a robot may have what was built
    without them.

    Args:
        files: of any number of build folders.
        gone: whether a file, or a folder, is missing.
    """

    def why(file: UnitFile) -> str | None:
        script = file.unit.script_path
        if script is None or not gone(script) or gone(file.unit.source_root):
            return None
        return f"its script, {script}, no longer exists"

    return _split(files, why)


def _split(
    files: Iterable[UnitFile], why: Callable[[UnitFile], str | None]
) -> tuple[list[UnitFile], list[Stale]]:
    """The files that stay, and those for which ``why`` gives a reason to leave them out."""
    kept: list[UnitFile] = []
    dropped: list[Stale] = []
    for file in files:
        reason = why(file)
        if reason is None:
            kept.append(file)
        else:
            dropped.append(Stale(file, reason))
    return kept, dropped


def drop_repeated(files: Iterable[UnitFile]) -> tuple[list[UnitFile], list[Stale]]:
    """The newest file of each link unit; of two equally old ones the first by path.

    A script and a target of one name are two.
    """
    newest: dict[tuple[str, str, str | None], UnitFile] = {}
    ordered = sorted(files, key=lambda file: (-file.written_ns, file.path))
    for file in ordered:
        newest.setdefault(_identity(file.unit), file)

    def why(file: UnitFile) -> str | None:
        last = newest[_identity(file.unit)]
        return None if last is file else f"built later in {last.build_folder}"

    kept, dropped = _split(ordered, why)
    return sorted(kept, key=lambda file: file.path), dropped


def _identity(unit: LinkUnit) -> tuple[str, str, str | None]:
    """The key by which two files of one link unit are recognised.

    A script's unit is called after its path where a target has its name, and that may change.
    """
    if unit.script is None:
        return unit.package, unit.link_unit, "python" if unit.is_python else None
    is_path = unit.link_unit.removeprefix("./") == unit.script
    name = Path(unit.script).name.removesuffix(".py") if is_path else unit.link_unit
    return unit.package, name, unit.script


def _why_stale(file: UnitFile, targets: Sequence[BuiltTarget]) -> str | None:
    target = next((each for each in targets if each.name == file.unit.link_unit), None)
    if target is None:
        return "its target no longer exists"
    unit, content = file.unit, target.content
    keys = [found.key for found in unit.comparisons if found.type != "constant"]
    if content is None or len(keys) <= unit.counts.not_instrumented:
        return None
    if any(content.find(key.encode()) >= 0 for key in keys):
        return None
    return "it was linked again without TPC"
