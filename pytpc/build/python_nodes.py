"""Analyses the Python nodes of a workspace and writes them beside the link units of C++.

``pytpc.build.python_units`` does the work; this decides which scripts, and reuses what still holds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.build.python_kept import KEPT_FILE, digest_of, load_kept, save_kept
from pytpc.build.python_units import (
    Name,
    PythonUnits,
    analyse_scripts,
    named_beside,
    scripts_of,
    write_units,
)
from pytpc.build.reconcile import target_names
from pytpc.python_analysis.rules_file import Rules
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import is_python_file, load_link_unit, python_unit_file, unit_files
from pytpc.workspace.packages import Package


@dataclass(frozen=True, slots=True)
class PythonBuild:
    """Which scripts of a workspace are analysed.

    Attributes:
        workspace: the folder with all packages.
        build_base: with a build folder for each package.
        packages: all of the workspace.
        chosen: the packages that were built.
        rules: None to analyse nothing, and to forget what was written of ``chosen``.
        tests: take scripts in folders of tests, too.
    """

    workspace: Path
    build_base: Path
    packages: Sequence[Package]
    chosen: Sequence[Package]
    rules: Rules | None
    tests: bool = False


def python_of_build(
    asked: PythonBuild, taken: Iterable[Name], on_progress: Callable[[int, int], None] | None = None
) -> PythonUnits:
    """Analyse the scripts of ``chosen``; of the other packages take what was written before.

    Where nothing has changed since, what was written of ``chosen`` is taken, too. Each unit is
    written to its file below ``build_base``, and files of scripts that are no more are removed.

    Args:
        asked: which scripts.
        taken: package and name of the link units that are no scripts.
        on_progress: called with (scripts done, scripts in all).

    Raises:
        InputError: a file of an earlier build is broken.
        TpcError: a file cannot be written.
    """
    build_base, chosen, rules = asked.build_base, asked.chosen, asked.rules
    kept_file = build_base.parent / KEPT_FILE
    if rules is None:
        kept_file.unlink(missing_ok=True)
        found = PythonUnits()
    else:
        names = set(taken).union(*(target_names(build_base / package.name) for package in chosen))
        chosen_names = [package.name for package in chosen]
        inputs = (str(build_base), str(asked.tests), str(chosen_names), str(sorted(names)))
        digest = digest_of([package.path for package in asked.packages], rules, inputs)
        kept = load_kept(kept_file, build_base, digest)
        if kept is not None:
            found = kept
        else:
            roots = [package.path for package in chosen]
            scripts = scripts_of(asked.workspace, roots, rules, tests=asked.tests)
            fresh = analyse_scripts(scripts, rules, on_progress)
            units = write_units(build_base, named_beside(fresh.units, names))
            found = PythonUnits(tuple(units), fresh.left_out)
            if any(unit.status == "failed" for unit in units):
                # It may have been the time that it took: a machine is not always as busy.
                kept_file.unlink(missing_ok=True)
            else:
                save_kept(kept_file, build_base, digest, found)
    others = _others(build_base, asked.packages, chosen, found)
    return PythonUnits((*found.units, *others), found.left_out)


def _others(
    build_base: Path, packages: Iterable[Package], chosen: Iterable[Package], found: PythonUnits
) -> Iterator[LinkUnit]:
    """What stays of packages that were not built; files of scripts that are no more are removed."""
    built = {package.name for package in chosen}
    written = {python_unit_file(build_base / each.package, each.link_unit) for each in found.units}
    for package in packages:
        for path in _files(build_base / package.name):
            if path in written:
                continue
            unit = None if package.name in built else load_link_unit(path)
            if unit is None or _is_gone(unit):
                path.unlink()
            else:
                yield unit


def _is_gone(unit: LinkUnit) -> bool:
    """Whether the script of a package that is there was removed or renamed."""
    return unit.script_path is not None and not Path(unit.script_path).exists()


def _files(build_folder: Path) -> list[Path]:
    if not build_folder.is_dir():
        return []
    return [path for path in unit_files(build_folder) if is_python_file(path)]
