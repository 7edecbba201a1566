"""Analyses the Python nodes of a workspace and writes them beside the link units of C++.

``pytpc.build.python_units`` does the work. This module decides which scripts are analysed. It
reuses the result of an earlier build while everything that the analysis reads is the same, byte for
byte: the Python of all packages, what says which of it is a program, the rules, and the analysis.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import dump_json, parse_json
from pytpc.base.errors import InputError
from pytpc.build.python_units import (
    Name,
    PythonUnits,
    analyse_scripts,
    analysis_files,
    named_beside,
    scripts_of,
    write_units,
)
from pytpc.build.reconcile import target_names
from pytpc.python_analysis.rules_file import Rules
from pytpc.python_analysis.sources.scripts import is_python
from pytpc.static.link_unit import LeftOut, LinkUnit
from pytpc.static.static_info import is_python_file, load_link_unit, python_unit_file, unit_files
from pytpc.workspace.packages import Package

_KEPT_FILE = "python.json"
_PRODUCTS = frozenset({"__pycache__", "node_modules"})
# Files that give a package its name, and say which of its files are programs or modules.
_DECLARING = frozenset({"package.xml", "setup.cfg", "pyproject.toml", "CMakeLists.txt"})


@dataclass(frozen=True, slots=True)
class PythonBuild:
    """Which scripts of a workspace are analysed.

    Attributes:
        workspace: the folder with all packages.
        build_base: with a build folder for each package.
        packages: all of the workspace.
        chosen: the packages that were built.
        rules: None to analyse nothing, and to forget the units of ``chosen``.
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
    """Analyse the scripts of ``chosen``; take those of other packages from an earlier build.

    If nothing has changed since, the units of ``chosen`` are taken from the earlier build, too.
    Each unit is written to its file below ``build_base``; files of removed scripts are deleted.

    Args:
        asked: which scripts.
        taken: package and name of the link units that are no scripts.
        on_progress: called with (scripts done, scripts in all).

    Raises:
        InputError: a file of an earlier build is broken.
        TpcError: a file cannot be written.
    """
    build_base, chosen, rules = asked.build_base, asked.chosen, asked.rules
    kept_file = build_base.parent / _KEPT_FILE
    if rules is None:
        kept_file.unlink(missing_ok=True)
        found = PythonUnits()
    else:
        names = set(taken).union(*(target_names(build_base / package.name) for package in chosen))
        chosen_names = [package.name for package in chosen]
        inputs = (str(build_base), str(asked.tests), str(chosen_names), str(sorted(names)))
        digest = _digest_of([package.path for package in asked.packages], rules, inputs)
        kept = _load_kept(kept_file, build_base, digest)
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
                _save_kept(kept_file, build_base, digest, found)
    others = _others(build_base, asked.packages, chosen, found)
    return PythonUnits((*found.units, *others), found.left_out)


def _others(
    build_base: Path, packages: Iterable[Package], chosen: Iterable[Package], found: PythonUnits
) -> Iterator[LinkUnit]:
    """The units of packages that were not built; files of removed scripts are deleted."""
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


def _digest_of(roots: Iterable[Path], rules: Rules, asked: Iterable[str]) -> str:
    """A digest that changes when the result of the analysis may change.

    Args:
        roots: the folders of all packages that may be imported from.
        rules: what reads and what exposes.
        asked: what else the result depends on.
    """
    digest = hashlib.sha256()
    said = json.dumps(asdict(rules), sort_keys=True, default=sorted)
    for text in (sys.version, said, *asked):
        digest.update(text.encode("utf-8", "surrogateescape") + b"\0")
    for path in (*analysis_files(), *(file for root in roots for file in _read_files(root))):
        try:
            content = path.read_bytes()
        except OSError:
            content = b"unreadable"
        digest.update(os.fsencode(path) + b"\0" + hashlib.sha256(content).digest())
    return digest.hexdigest()


def _load_kept(path: Path, build_base: Path, digest: str) -> PythonUnits | None:
    """The units that a build wrote with the same ``digest``; None where they do not all hold."""
    try:
        data = parse_json(path)
        if not isinstance(data, dict) or data["digest"] != digest:
            return None
        units = tuple(
            _kept_unit(build_base / package, *which) for package, *which in data["written"]
        )
        return PythonUnits(units, tuple(LeftOut(*left_out) for left_out in data["left_out"]))
    except (OSError, InputError, KeyError, TypeError, ValueError):
        # Missing or edited: everything is analysed again.
        return None


def _kept_unit(folder: Path, name: str, digest: str) -> LinkUnit:
    """A unit as it was written; unchanged files need no second check.

    Raises:
        OSError: the file is gone.
        ValueError: it has changed.
    """
    data = python_unit_file(folder, name).read_bytes()
    if hashlib.sha256(data).hexdigest() != digest:
        raise ValueError("changed since it was written")
    return replace(LinkUnit.from_checked(json.loads(data)), build_folder=str(folder.absolute()))


def _save_kept(path: Path, build_base: Path, digest: str, found: PythonUnits) -> None:
    """Remember what was written.

    Raises:
        TpcError: the file cannot be written.
        OSError: one of the units' files cannot be read.
    """
    written = []
    for unit in found.units:
        data = python_unit_file(build_base / unit.package, unit.link_unit).read_bytes()
        written.append([unit.package, unit.link_unit, hashlib.sha256(data).hexdigest()])
    left_out = [[one.package, one.link_unit, one.reason] for one in found.left_out]
    write_atomic(path, dump_json({"digest": digest, "written": written, "left_out": left_out}))


def _read_files(root: Path) -> Iterator[Path]:
    """The files of a package that the analysis may read, in an order that stays."""
    seen: set[str] = set()
    for folder, below, files in os.walk(root, followlinks=True):
        real = os.path.realpath(folder)
        if real in seen:
            below.clear()
            continue
        seen.add(real)
        below[:] = sorted(name for name in below if name not in _PRODUCTS and name[0] != ".")
        for name in sorted(files):
            path = Path(folder, name)
            if name in _DECLARING or is_python(path):
                yield path
