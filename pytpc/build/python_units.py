"""The Python nodes of packages as link units: found, analysed, named, and kept in build folders.

It stands between ``python_analysis``, which analyses one script, and build and collect.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

import pytpc
from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import dump_json
from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.python_analysis.analysis import analyse_entry
from pytpc.python_analysis.budget import SECONDS
from pytpc.python_analysis.rules_file import Rules
from pytpc.python_analysis.sources.packages import entries, entry_of
from pytpc.python_analysis.sources.scripts import Entry
from pytpc.static.link_unit import LeftOut, LinkUnit
from pytpc.static.static_info import python_unit_file
from pytpc.workspace.packages import package_folders

Name = tuple[str, str]
_USED_BY_ANALYSIS = (
    "static/arithmetic.py",
    "static/link_unit.py",
    "workspace/cmake_syntax.py",
    "workspace/packages.py",
)
_TEST_FOLDERS = frozenset({"test", "tests"})
_PRODUCTS = frozenset({"build", "devel", "install", "log", "__pycache__", "node_modules"})


@dataclass(frozen=True, slots=True)
class PackageScripts:
    """The scripts that are nodes, and those that could not be classified, with the reason."""

    entries: tuple[Entry, ...]
    left_out: tuple[LeftOut, ...] = ()


@dataclass(frozen=True, slots=True)
class PythonUnits:
    """The link units of scripts, and the scripts that could not be analysed, with the reason.

    ``folders`` are the workspaces whose scripts were all looked at, without links in their paths.
    """

    units: tuple[LinkUnit, ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    folders: tuple[Path, ...] = ()


def scripts_at(path: Path, rules: Rules, beside: Sequence[Path] = ()) -> PackageScripts:
    """The scripts that a path means: itself, or all nodes in a folder.

    Args:
        path: a script, or a folder.
        rules: what reads and what exposes.
        beside: further folders, whose packages may be imported from.

    Raises:
        InputError: there is no such file or folder.
        MissingToolError: catkin_pkg is not installed.
    """
    faults: list[InputError] = []
    found = entries(path, faults.append, rules, beside)
    left_out = [_fault(path, error)[1] for error in faults]
    return PackageScripts(tuple(found), tuple(dict.fromkeys(left_out)))


def scripts_of(
    workspace: Path, packages: Iterable[Path], rules: Rules, *, tests: bool = False
) -> PackageScripts:
    """The scripts of packages of a workspace; all of it is looked at for what they import.

    Args:
        workspace: the folder with all packages.
        packages: the folders of some.
        rules: what reads and what exposes.
        tests: take scripts in folders called test or tests, too.
    """
    roots = {os.path.realpath(package): package.absolute() for package in packages}
    faults: list[InputError] = []
    found: dict[tuple[Path, str], Entry] = {}
    below = (folder for root in roots.values() for folder in _test_folders(root))
    for place in (workspace, *(below if tests else ())):
        for entry in entries(place, faults.append, rules, [workspace]):
            if os.path.realpath(entry.root) in roots:
                found.setdefault((entry.script, entry.name), entry)
    left_out = [
        one
        for root, one in (_fault(workspace, error) for error in faults)
        if os.path.realpath(root) in roots
    ]
    return PackageScripts(tuple(_named_apart(found.values())), tuple(dict.fromkeys(left_out)))


def analyse_scripts(
    scripts: PackageScripts,
    rules: Rules,
    on_progress: Callable[[int, int], None] | None = None,
    seconds: float = SECONDS,
) -> PythonUnits:
    """Analyse scripts; one that cannot be is left out with the reason.

    Args:
        scripts: of any number of packages.
        rules: what reads and what exposes.
        on_progress: called with (scripts done, scripts in all).
        seconds: what each script may take; 0 is no limit.
    """
    units: list[LinkUnit] = []
    left_out = dict.fromkeys(scripts.left_out)
    for number, entry in enumerate(scripts.entries, start=1):
        script = _inside(entry.script, entry.root)
        try:
            faults: list[InputError] = []
            unit = replace(analyse_entry(entry, rules, seconds, faults.append), script=script)
            # Source text that JSON cannot hold must not stop the whole build.
            dump_json(unit.to_json())
        except InputError as error:
            left_out[_left_out(entry.package, script, error)] = None
        else:
            units.append(unit)
            left_out.update((_fault(entry.root, fault)[1], None) for fault in faults)
        if on_progress is not None:
            on_progress(number, len(scripts.entries))
    return PythonUnits(tuple(units), tuple(left_out))


def analysis_files() -> list[Path]:
    """The source files of the analysis, sorted: when they change, its results may change."""
    own = Path(pytpc.__file__).parent
    found = (path for end in ("*.py", "*.json") for path in (own / "python_analysis").rglob(end))
    return sorted([Path(__file__), *(own / name for name in _USED_BY_ANALYSIS), *found])


def analyse_workspaces(
    folders: Iterable[Path], rules: Rules, on_progress: Callable[[int, int], None] | None = None
) -> PythonUnits:
    """Analyse the scripts of all packages in those ``folders`` that are workspaces.

    A build folder is no workspace, though tools put manifests there.

    Args:
        folders: files and other folders among them are skipped.
        rules: what reads and what exposes.
        on_progress: called with (scripts done, scripts in all).
    """
    found = [folder for folder in folders if _is_workspace(folder)]
    scripts = joined(scripts_of(folder, package_folders(folder), rules) for folder in found)
    units = analyse_scripts(scripts, rules, on_progress)
    return replace(units, folders=tuple(Path(os.path.realpath(folder)) for folder in found))


def joined(parts: Iterable[PackageScripts]) -> PackageScripts:
    """The scripts of several packages, each once."""
    found: dict[tuple[Path, str], Entry] = {}
    left_out: dict[LeftOut, None] = {}
    for part in parts:
        found.update(((entry.script, entry.name), entry) for entry in part.entries)
        left_out.update(dict.fromkeys(part.left_out))
    return PackageScripts(tuple(found.values()), tuple(left_out))


def names_of(units: Iterable[LinkUnit | LeftOut]) -> set[Name]:
    """Package and name of each."""
    return {(unit.package, unit.link_unit) for unit in units}


def named_beside(units: Iterable[LinkUnit], taken: Collection[Name]) -> list[LinkUnit]:
    """The units under names that nothing else has in their package; their keys stay.

    A script that is called as a C++ target is, or as a script before it, gets its path in the
    package for a name: ``scripts/mission.py``. A target's name cannot have a slash.

    Args:
        units: of scripts.
        taken: package and name of the other link units.
    """
    used = set(taken)
    named = []
    for unit in units:
        free = (name for name in _names(unit) if (unit.package, name) not in used)
        name = next(free)
        used.add((unit.package, name))
        named.append(unit if name == unit.link_unit else replace(unit, link_unit=name))
    return named


def write_units(build_base: Path, units: Iterable[LinkUnit]) -> list[LinkUnit]:
    """Write each unit's file below ``build_base``, as colcon has it, where ``unit_files`` finds it.

    Returns:
        The units as they are read from there: they know their build folders.

    Raises:
        TpcError: a file cannot be written.
    """
    written = []
    for unit in units:
        folder = build_base / unit.package
        data = replace(unit, build_folder=None).to_json()
        write_atomic(python_unit_file(folder, unit.link_unit), dump_json(data))
        written.append(replace(unit, build_folder=str(folder.absolute())))
    return written


def _names(unit: LinkUnit) -> Iterator[str]:
    yield unit.link_unit
    if unit.script is not None:
        yield unit.script if "/" in unit.script else f"./{unit.script}"
    for number in count(2):
        yield f"{unit.link_unit}_{number}"


def _named_apart(found: Iterable[Entry]) -> Iterator[Entry]:
    """Scripts of tests get their path for a name where one that is no test has theirs."""
    used: set[Name] = set()
    for entry in found:
        name = entry.name
        if (entry.package, name) in used:
            name = _inside(entry.script, entry.root)
        used.add((entry.package, name))
        yield entry if name == entry.name else replace(entry, name=name)


def _is_workspace(folder: Path) -> bool:
    if not folder.is_dir() or (folder / "CMakeCache.txt").is_file():
        return False
    return next(package_folders(folder), None) is not None


def _test_folders(root: Path) -> Iterator[Path]:
    for folder, below, _ in os.walk(root):
        below[:] = sorted(name for name in below if name not in _PRODUCTS and name[0] != ".")
        for name in below:
            if name in _TEST_FOLDERS:
                yield Path(folder, name)


def _inside(script: Path, root: Path) -> str:
    return str(script.relative_to(root) if script.is_relative_to(root) else script)


def _fault(path: Path, error: InputError) -> tuple[Path, LeftOut]:
    """A file below ``path`` that cannot be read, with the folder of its package."""
    file = path.absolute() if error.path is None else Path(error.path)
    entry = entry_of(file)
    return entry.root, _left_out(entry.package, _inside(file, entry.root), error)


def _left_out(package: str, script: str, error: InputError) -> LeftOut:
    return LeftOut(package, plain(script), plain(str(error)))
