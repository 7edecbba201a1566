"""The Python nodes of a workspace that is built: analysed, written beside what C++ has, and read.

``pytpc.python_units`` says how; this says which, and what of an earlier build still holds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from pytpc.link_unit import LinkUnit
from pytpc.pynodes.rules_file import Rules
from pytpc.python_units import (
    Name,
    PythonUnits,
    analyse_scripts,
    named_beside,
    scripts_of,
    write_units,
)
from pytpc.reconcile import target_names
from pytpc.static_info import is_python_file, load_link_unit, python_unit_file, unit_files
from pytpc.workspace import Package


def python_of_build(
    workspace: Path,
    build_base: Path,
    packages: Sequence[Package],
    taken: Iterable[Name],
    *,
    chosen: Sequence[Package],
    rules: Rules | None,
    tests: bool = False,
    on_progress: Callable[[int, int], None] | None = None,
) -> PythonUnits:
    """Analyse the scripts of ``chosen``; of the other packages take what was written before.

    Each unit is written to its file below ``build_base``, and files of scripts that are no more
    are removed.

    Args:
        workspace: the folder with all packages.
        build_base: with a build folder for each package.
        packages: all of the workspace.
        taken: package and name of the link units that are no scripts.
        chosen: the packages that were built.
        rules: None to analyse nothing, and to forget what was written of ``chosen``.
        tests: take scripts in folders of tests, too.
        on_progress: called with (scripts done, scripts in all).

    Raises:
        InputError: a file of an earlier build is broken.
        TpcError: a file cannot be written.
    """
    built = {package.name for package in chosen}
    if rules is None:
        found = PythonUnits()
    else:
        scripts = scripts_of(workspace, [one.path for one in chosen], rules, tests=tests)
        found = analyse_scripts(scripts, rules, on_progress)
    names = set(taken).union(*(target_names(build_base / package.name) for package in chosen))
    units = write_units(build_base, named_beside(found.units, names))
    written = {python_unit_file(build_base / unit.package, unit.link_unit) for unit in units}
    for package in packages:
        for path in _files(build_base / package.name):
            if package.name not in built:
                unit = load_link_unit(path)
                if not _is_gone(unit):
                    units.append(unit)
                    written.add(path)
            if path not in written:
                path.unlink()
    return PythonUnits(tuple(units), found.left_out)


def _is_gone(unit: LinkUnit) -> bool:
    """Whether the script of a package that is there was removed or renamed."""
    return unit.script_path is not None and not Path(unit.script_path).exists()


def _files(build_folder: Path) -> list[Path]:
    if not build_folder.is_dir():
        return []
    return [path for path in unit_files(build_folder) if is_python_file(path)]
