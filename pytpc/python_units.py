"""The Python nodes of packages as link units: found, analysed, named, and kept in build folders.

The room between ``pynodes``, which analyses one script, and what builds and collects.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

from pytpc.atomic import write_atomic
from pytpc.errors import InputError
from pytpc.link_unit import LeftOut, LinkUnit
from pytpc.pynodes.analysis import analyse_entry
from pytpc.pynodes.packages import Entry, entries
from pytpc.pynodes.rules_file import Rules
from pytpc.static_info import python_unit_file
from pytpc.static_json import dump_json
from pytpc.words import plain

Name = tuple[str, str]
_TEST_FOLDERS = frozenset({"test", "tests"})
_PRODUCTS = frozenset({"build", "devel", "install", "log", "__pycache__", "node_modules"})


@dataclass(frozen=True, slots=True)
class Scripts:
    """The scripts that are nodes, and those of which nobody can say it, with the reason."""

    entries: tuple[Entry, ...]
    left_out: tuple[LeftOut, ...] = ()


@dataclass(frozen=True, slots=True)
class PythonUnits:
    """The link units of scripts, and the scripts that could not be analysed, with the reason."""

    units: tuple[LinkUnit, ...] = ()
    left_out: tuple[LeftOut, ...] = ()


def scripts_of(package: str, folder: Path, *, tests: bool = False) -> Scripts:
    """The scripts of one package, sorted by path.

    Args:
        package: its name.
        folder: its folder; a package within it is none of it.
        tests: take those in folders called test or tests, too.
    """
    root = folder.absolute()
    left_out: list[LeftOut] = []

    def note(error: InputError) -> None:
        script = root if error.path is None else Path(error.path)
        left_out.append(_left_out(package, _inside(script, root), error))

    found: dict[Path, Entry] = {}
    for place in (root, *(_test_folders(root) if tests else ())):
        for entry in entries(place, note):
            if entry.root == root:
                found.setdefault(entry.script, entry)
    return Scripts(tuple(_named_apart(found.values())), tuple(left_out))


def analyse_scripts(
    scripts: Scripts, rules: Rules, on_progress: Callable[[int, int], None] | None = None
) -> PythonUnits:
    """Analyse scripts; one that cannot be is left out with the reason.

    Args:
        scripts: of any number of packages.
        rules: what reads and what exposes.
        on_progress: called with (scripts done, scripts in all).
    """
    units: list[LinkUnit] = []
    left_out = list(scripts.left_out)
    for number, entry in enumerate(scripts.entries, start=1):
        script = _inside(entry.script, entry.root)
        try:
            unit = replace(analyse_entry(entry, rules), script=script)
            # A text of the source that no JSON can have would stop the whole build.
            LinkUnit.from_json(unit.to_json(), entry.script)
            dump_json(unit.to_json())
        except InputError as error:
            left_out.append(_left_out(entry.package, script, error))
        else:
            units.append(unit)
        if on_progress is not None:
            on_progress(number, len(scripts.entries))
    return PythonUnits(tuple(units), tuple(left_out))


def joined(parts: Iterable[Scripts]) -> Scripts:
    """The scripts of several packages as one."""
    parts = list(parts)
    return Scripts(
        tuple(entry for part in parts for entry in part.entries),
        tuple(one for part in parts for one in part.left_out),
    )


def named_beside(units: Iterable[LinkUnit], taken: Collection[Name]) -> list[LinkUnit]:
    """The units under names that nothing else has in their package; their keys stay.

    A script that is called as a C++ target is, or as a script before it, gets its path in the
    package for a name: ``scripts/mission.py``. A target's name cannot have a slash.

    Args:
        units: of scripts.
        taken: package and name of what there is besides.
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


def is_python(unit: LinkUnit) -> bool:
    """Whether the unit is a script's, and no target of CMake's."""
    return unit.tool.analysis == "python"


def _names(unit: LinkUnit) -> Iterator[str]:
    yield unit.link_unit
    if unit.script is not None:
        yield unit.script if "/" in unit.script else f"./{unit.script}"
    for number in count(2):
        yield f"{unit.link_unit}_{number}"


def _named_apart(found: Iterable[Entry]) -> Iterator[Entry]:
    """Scripts of tests get their path for a name where one that is no test has theirs."""
    used: set[str] = set()
    for entry in found:
        name = entry.name
        if name in used:
            name = _inside(entry.script, entry.root)
        used.add(name)
        yield entry if name == entry.name else replace(entry, name=name)


def _test_folders(root: Path) -> Iterator[Path]:
    for folder, below, _ in os.walk(root):
        below[:] = sorted(name for name in below if name not in _PRODUCTS and name[0] != ".")
        for name in below:
            if name in _TEST_FOLDERS:
                yield Path(folder, name)


def _inside(script: Path, root: Path) -> str:
    return str(script.relative_to(root) if script.is_relative_to(root) else script)


def _left_out(package: str, script: str, error: InputError) -> LeftOut:
    return LeftOut(package, plain(script), plain(str(error)))
