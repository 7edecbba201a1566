"""Merges the static information of workspaces and build folders, without stale files."""

from __future__ import annotations

import filecmp
import mmap
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from pathlib import Path

from pytpc.base.errors import InputError, WorkspaceError
from pytpc.base.paths import MERGED_FILE, OWN_FOLDER
from pytpc.build.doubled import doubled_sources
from pytpc.build.python_units import PythonUnits, named_beside, names_of
from pytpc.build.reconcile import build_folders, known_targets, left_out_units, target_names
from pytpc.build.stale import (
    BuiltTarget,
    Stale,
    UnitFile,
    drop_repeated,
    drop_stale,
    drop_without_scripts,
    drop_without_sources,
)
from pytpc.static.link_unit import LeftOut, LinkUnit
from pytpc.static.static_info import StaticInfo, load_link_unit, not_built, unit_files

_NOT_SOURCES = frozenset({".git", ".hg", ".svn", OWN_FOLDER})


@dataclass(frozen=True, slots=True)
class Collected:
    """The merged static information, and the files that were left out."""

    static: StaticInfo
    dropped: tuple[Stale, ...]


def collect_sources(
    sources: Sequence[Path],
    on_progress: Callable[[int, int], None] | None = None,
    python: PythonUnits | None = None,
) -> Collected:
    """Read, sort out and merge the files of all link units below ``sources``.

    Args:
        sources: workspaces, build bases, build folders, or files with static information. Of a
            workspace both ``.tpc/build`` and its own ``build`` are read; of a unit that was built
            in both, the later one counts.
        on_progress: called with (files read, files in all).
        python: what takes the place of all Python units of its folders; see
            `pytpc.build.python_units.analyse_workspaces`.

    Raises:
        InputError: no such folder, a file that is broken, or a key that occurs twice.
        WorkspaceError: there is no static information in one of them.
    """
    fresh = python or PythonUnits()
    files, copies, digests = _read(sources, on_progress, required=not fresh.units)
    files = [file for file in files if not _is_replaced(file.unit, fresh)]
    folders = sorted({file.build_folder for file in files})
    kept, stale = drop_stale(files, {folder: _built_targets(folder) for folder in folders})
    kept, scriptless = drop_without_scripts(kept, _is_gone)
    workspaces = [os.path.abspath(source) for source in sources if source.is_dir()]  # noqa: PTH100
    kept, orphans = drop_without_sources(kept, workspaces, _is_gone)
    kept, repeated = drop_repeated(kept)
    compiled = [file.unit for file in kept if not file.unit.is_python]
    nodes = [*(file.unit for file in kept if file.unit.is_python), *fresh.units]
    bases = [base for source in sources if source.is_dir() for base in _build_bases(source)]
    every = {folder.absolute() for base in bases for folder in build_folders(base)}.union(folders)
    left_out = _left_out(every, compiled)
    taken = names_of(compiled).union(*(target_names(folder) for folder in every))
    units = [*compiled, *named_beside(nodes, taken)]
    copies.update(find_copies(units))
    static = StaticInfo.of(
        units,
        sources[0] if len(sources) == 1 else None,
        copies,
        (*left_out, *fresh.left_out),
        doubled_sources(sorted(every), units),
    )
    static = replace(static, sources=tuple(sorted(digests.items())))
    return Collected(static, (*stale, *scriptless, *orphans, *repeated))


def _is_replaced(unit: LinkUnit, fresh: PythonUnits) -> bool:
    if not unit.is_python:
        return False
    root = Path(os.path.realpath(unit.source_root))
    return any(root.is_relative_to(folder) for folder in fresh.folders)


def _read(
    sources: Sequence[Path], on_progress: Callable[[int, int], None] | None, *, required: bool
) -> tuple[list[UnitFile], dict[str, str], dict[str, str]]:
    """All files of link units, and the copies and digests of sources that documents know.

    Args:
        sources: as for ``collect_sources``.
        on_progress: the same.
        required: whether each folder must contain static information.

    Raises:
        InputError: a file is broken.
        WorkspaceError: a folder has none.
    """
    copies: dict[str, str] = {}
    digests: dict[str, str] = {}
    files: list[UnitFile] = []
    paths: set[Path] = set()
    for source in sources:
        if source.is_file():
            document = StaticInfo.load(source)
            copies.update(document.copies)
            digests.update(document.sources)
            written = source.stat().st_mtime_ns
            files += [UnitFile(source.absolute(), unit, written) for unit in document.units]
            continue
        below = [path.absolute() for base in _build_bases(source) for path in unit_files(base)]
        if not below and required:
            raise WorkspaceError(not_built(source), source)
        paths.update(below)
        digests.update(_digests_of_build(source, below))
    for number, path in enumerate(sorted(paths), start=1):
        files.append(UnitFile(path, load_link_unit(path), path.stat().st_mtime_ns))
        if on_progress is not None:
            on_progress(number, len(paths))
    return files, copies, digests


def _digests_of_build(workspace: Path, units: Iterable[Path]) -> dict[str, str]:
    """The digests that ``pytpc build`` noted, unless a unit was linked after it."""
    merged = workspace / OWN_FOLDER / MERGED_FILE
    if not merged.is_file():
        return {}
    written = merged.stat().st_mtime_ns
    if any(unit.stat().st_mtime_ns > written for unit in units):
        return {}
    try:
        return dict(StaticInfo.load(merged).sources)
    except InputError:
        return {}


def _left_out(folders: Iterable[Path], units: Iterable[LinkUnit]) -> list[LeftOut]:
    """The link units of all build folders that have no file, each once."""
    known = names_of(units)
    found = {
        (unit.package, unit.link_unit): unit
        for folder in sorted(folders)
        for unit in left_out_units(folder)
    }
    return [unit for name, unit in found.items() if name not in known]


def find_copies(units: Iterable[LinkUnit]) -> dict[str, str]:
    """Headers outside of all packages that are a package's own: installed copy -> original.

    A file is a package's own where a symbolic link leads to it, or where it has, byte for byte, the
    content of exactly one file of that name in the packages' folders. Where several have it, that
    one counts which has the most folder names at the end of the path in common, if there is one.
    """
    units = list(units)
    roots = {unit.source_root.rstrip("/") for unit in units}
    real = {os.path.realpath(root): root for root in sorted(roots, reverse=True)}
    seen = {unit.absolute(found.file) for unit in units for found in unit.comparisons}
    copies: dict[str, str] = {}
    unknown: list[str] = []
    for file in sorted(seen):
        target = Path(os.path.realpath(file))
        root = next((up for up in map(str, target.parents) if up in real), None)
        if root is not None:
            original = str(Path(real[root]) / target.relative_to(root))
            if original != file:
                copies[file] = original
        elif target.is_file() and not any(file.startswith(root + "/") for root in roots):
            unknown.append(file)
    candidates = _files_named({Path(file).name for file in unknown}, roots)
    for file in unknown:
        only = _original(file, candidates.get(Path(file).name, []))
        if only is not None:
            copies[file] = only
    return copies


def _original(file: str, candidates: Iterable[str]) -> str | None:
    same = [each for each in candidates if filecmp.cmp(file, each, shallow=False)]
    shared = [_common_end(Path(file).parts, Path(each).parts) for each in same]
    best = [each for each, tail in zip(same, shared, strict=True) if tail == max(shared)]
    return best[0] if len(best) == 1 else None


def _common_end(one: Sequence[str], other: Sequence[str]) -> int:
    pairs = zip(reversed(one), reversed(other), strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))


def _files_named(names: set[str], roots: Iterable[str]) -> dict[str, list[str]]:
    """Files with these names below ``roots``, each once, sorted."""
    found: dict[str, set[str]] = {name: set() for name in names}
    for root in sorted(roots) if names else ():
        for folder, below, files in os.walk(root):
            below[:] = [name for name in below if name not in _NOT_SOURCES]
            for name in names.intersection(files):
                found[name].add(str(Path(folder, name)))
    return {name: sorted(paths) for name, paths in found.items()}


def _build_bases(source: Path) -> list[Path]:
    """Where the build folders of a workspace are; any other folder is one itself."""
    bases = [source / OWN_FOLDER / "build", source / "build"]
    return [base for base in bases if base.is_dir()] or [source]


def _is_gone(folder: str) -> bool:
    """Whether a folder is missing; one without permission to look counts as present."""
    try:
        Path(folder).stat()
    except (FileNotFoundError, NotADirectoryError):
        return True
    except OSError:
        return False
    return False


def _built_targets(build_folder: Path) -> list[BuiltTarget] | None:
    targets = known_targets(build_folder)
    if targets is None:
        return None
    return [BuiltTarget(target.name, _content(target.artifact)) for target in targets]


def _content(artifact: Path | None) -> mmap.mmap | bytes | None:
    """A program's or library's bytes, read on first use."""
    if artifact is None or not artifact.is_file():
        return None
    with artifact.open("rb") as stream:
        if os.fstat(stream.fileno()).st_size == 0:
            return b""
        return mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)
