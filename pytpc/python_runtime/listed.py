"""The comparisons that should report, read from the static information.

The hook does not check files against the schema; unusable content is an error that names the file.
"""

from __future__ import annotations

import glob
import json
import os
import re
from collections.abc import Iterable
from typing import Any, NamedTuple

from pytpc.python_runtime.errors import HookError

# `pytpc build` writes this file, with all units of the workspace.
BUILT = os.path.join(".tpc", "static.json")
# Where static information lies below a workspace, a build folder or a folder of packages.
_PLACES = ("*.json", "tpc/*.json", "*/tpc/*.json", "build/tpc/*.json", "build/*/tpc/*.json")
# The script of an entry point has less than 1,500 bytes.
_LONGEST = 4096
_BY_SETUPTOOLS = re.compile(
    r"^# EASY-INSTALL-ENTRY-SCRIPT: '([^'=]+)[^']*','console_scripts','([^']+)'", re.MULTILINE
)
_BY_PIP = re.compile(r"^from ([\w.]+) import \w+$", re.MULTILINE)
_NOT_PYTHON = (".c", ".cc", ".cpp", ".cxx", ".h", ".hh", ".hpp", ".hxx")


class Listed(NamedTuple):
    """One comparison of the static information; lines from 1, columns in bytes from 1."""

    key: str
    relation: str
    lineno: int
    column: int
    end_lineno: int | None
    end_column: int | None
    name: str | None
    operand: str | None
    source_code: str | None

    @property
    def is_inside(self) -> bool:
        """Whether the library function that is called there makes the comparison."""
        return self.operand is not None and self.operand not in ("left", "right")


class ListedFile(NamedTuple):
    """A source file and its comparisons. ``path`` is absolute, from the machine of the analysis."""

    path: str
    comparisons: tuple[Listed, ...]


class ListedFiles:
    """The source files with comparisons, found by their base names."""

    def __init__(self, files: Iterable[ListedFile]) -> None:
        """Keep ``files``, and merge those with the same path."""
        merged: dict[str, dict[tuple[str, int, int, str], Listed]] = {}
        for file in files:
            into = merged.setdefault(file.path, {})
            for listed in file.comparisons:
                into[(listed.key, listed.lineno, listed.column, listed.relation)] = listed
        self.by_name: dict[str, list[ListedFile]] = {}
        for path, found in sorted(merged.items()):
            entry = ListedFile(path, tuple(found.values()))
            self.by_name.setdefault(os.path.basename(path), []).append(entry)
        self._count = len(merged)

    def __len__(self) -> int:
        return self._count

    def is_exact(self, path: str) -> bool:
        """Whether ``path`` is one of these files itself, and not a copy."""
        return self._exact(path) is not None

    def candidates(self, path: str) -> list[ListedFile]:
        """The files that the one at ``path`` may be a copy of; only itself where it is one of them.

        `pytpc.python_runtime.find.matching` compares the text of a file that was installed or is on
        another machine.
        """
        exact = self._exact(path)
        return [exact] if exact is not None else next(filter(None, self._named(path)), [])

    def _named(self, path: str) -> list[list[ListedFile]]:
        """The files of this name, and those of the name that a symbolic link leads to."""
        names = dict.fromkeys((os.path.basename(path), os.path.basename(os.path.realpath(path))))
        return [self.by_name.get(name, []) for name in names]

    def _exact(self, path: str) -> ListedFile | None:
        # Of the files of these names alone: to resolve thousands would delay a node.
        real = os.path.realpath(path)
        for files in self._named(path):
            for file in files:
                if os.path.realpath(file.path) == real:
                    return file
        return None


class _Unit(NamedTuple):
    """One link unit: a script with the modules that it imports.

    ``script`` is its absolute path, None in files of earlier versions.
    """

    name: str
    package: str | None
    script: str | None
    root: str
    files: list[ListedFile]

    def is_called(self, stem: str) -> bool:
        """Whether its script, or in earlier files the unit, has this name, without ``.py``."""
        return stem in (self.name, stem_of(self.script or self.name))

    def is_of(self, real: str) -> bool:
        """Whether its script is the file with this path, with symbolic links resolved."""
        return self.script is not None and os.path.realpath(self.script) == real

    def runs(self, module: tuple[str, ...]) -> bool:
        """Whether the path of its script ends like this module's."""
        return self.script is not None and self.script.endswith(module)

    def has(self, module: tuple[str, ...]) -> bool:
        """Whether this module has comparisons."""
        return any(file.path.endswith(module) for file in self.files)


def read_table(paths: Iterable[str], script: str | None = None) -> ListedFiles:
    """Read static information: files of one unit, merged files, and folders with such files.

    Args:
        paths: what to read.
        script: the program to run. A module of several programs has a key for each of them; the
            keys of ``script`` are used, if there are any: they tell which program reports.

    Raises:
        HookError: a file cannot be read or is not static information; a folder has none.
    """
    units = _all_units(paths)
    running = _of_script(units, script) if script is not None else []
    return ListedFiles(file for unit in running or units for file in unit.files)


def names_script(paths: Iterable[str], script: str) -> bool:
    """Whether the static information has comparisons of this script, or of one with its name.

    For the script of an entry point, comparisons of the module that it runs count.

    Raises:
        HookError: as in `read_table`.
    """
    return bool(_of_script([unit for unit in _all_units(paths) if unit.files], script))


def _all_units(paths: Iterable[str]) -> list[_Unit]:
    units: list[_Unit] = []
    for path in paths:
        units += _of_folder(path) if os.path.isdir(path) else _units(_document(path), path)
    return units


def _of_script(units: list[_Unit], script: str) -> list[_Unit]:
    """The link units that the running script may be.

    A script is identified by its path. An installed script is identified by its name and its
    package, which its folder is named after; the script of an entry point by the module that it
    runs.
    """
    program = program_of(script)
    real = os.path.realpath(script)
    if program.module is not None:
        running = [unit for unit in units if unit.runs(program.files)]
        # A module may have several entry points; each gives its name to a unit.
        begun = [unit for unit in running if unit.name == program.stem]
        others = [unit for unit in units if unit.has(program.files)]
        if begun or running or others:
            return begun or running or others
    named = [unit for unit in units if unit.is_called(program.stem)]
    exact = [unit for unit in units if unit.is_of(real)]
    inside = [
        unit
        for unit in named
        if unit.script is None and real.startswith(os.path.realpath(unit.root) + os.sep)
    ]
    folder = os.path.basename(os.path.dirname(os.path.abspath(script)))
    of_package = [unit for unit in named if unit.package == folder]
    return [unit for unit in exact if unit in named] or exact or inside or of_package or named


def _of_folder(folder: str) -> list[_Unit]:
    built = os.path.join(folder, BUILT)
    if os.path.isfile(built):
        return _units(_document(built), built)
    found = sorted({path for place in _PLACES for path in glob.glob(os.path.join(folder, place))})
    units: list[_Unit] = []
    is_any = False
    for path in found:
        document = _document(path)
        if isinstance(document, dict) and ("comparisons" in document or "units" in document):
            is_any = True
            units.extend(_units(document, path))
    if not is_any:
        raise HookError("no static information below this folder; run pytpc analyse", folder)
    return units


def _document(path: str) -> Any:  # noqa: ANN401
    try:
        with open(path, "rb") as stream:
            return json.loads(stream.read().decode("utf-8"))
    except OSError as error:
        raise HookError(f"cannot be read: {error.strerror or error}", path) from error
    except json.JSONDecodeError as error:
        raise HookError(f"not JSON: {error.msg}", path, error.lineno) from error
    except ValueError as error:
        raise HookError(f"not JSON: {error}", path) from error


def _units(document: Any, path: str) -> list[_Unit]:  # noqa: ANN401
    units = []
    try:
        for unit in document.get("units", [document]):
            files: dict[str, list[Listed]] = {}
            for comparison in unit["comparisons"]:
                if comparison["file"].endswith(_NOT_PYTHON):
                    continue
                file = os.path.normpath(os.path.join(unit["source_root"], comparison["file"]))
                files.setdefault(file, []).append(_listed(comparison))
            listed = [ListedFile(file, tuple(found)) for file, found in files.items()]
            script, root = unit.get("script"), unit["source_root"]
            if script is not None:
                script = os.path.join(root, script)
            if not _is_compiled(unit):
                units.append(_Unit(unit["link_unit"], unit.get("package"), script, root, listed))
    except (KeyError, TypeError, AttributeError) as error:
        raise HookError(f"not static information ({type(error).__name__}: {error})", path) from None
    return units


def _is_compiled(unit: dict[str, Any]) -> bool:
    """Whether it is a program or library in C++, which may have the name of a script."""
    tool = unit.get("tool")
    return tool is not None and tool.get("analysis") != "python"


def _listed(comparison: dict[str, Any]) -> Listed:
    return Listed(
        key=comparison["key"],
        relation=comparison["relation"],
        lineno=comparison["lineno"],
        column=comparison["column"],
        end_lineno=comparison.get("end_lineno"),
        end_column=comparison.get("end_column"),
        name=comparison["name"],
        operand=comparison.get("operand"),
        source_code=comparison["source_code"],
    )


class EntryPoint(NamedTuple):
    """A script's name without ``.py``, and for an entry point the module that it runs.

    setuptools or pip writes the script of an entry point (``console_scripts``) when it installs a
    package. The script has the name of the entry point, imports a module and calls a function of
    it.
    """

    stem: str
    module: str | None

    @property
    def files(self) -> tuple[str, ...]:
        """The endings that the module's path may have."""
        if self.module is None:
            return ()
        path = "/" + self.module.replace(".", "/")
        return (f"{path}.py", f"{path}/__init__.py")


def program_of(script: str) -> EntryPoint:
    """The name of a script and the module that it runs; None for an unreadable script."""
    return EntryPoint(stem_of(script), _module(script))


def stem_of(script: str) -> str:
    """The name of a script without ``.py``."""
    name = os.path.basename(script)
    return name[:-3] if name.endswith(".py") else name


def _module(script: str) -> str | None:
    try:
        with open(script, "rb") as stream:
            data = stream.read(_LONGEST + 1)
    except OSError:
        return None
    if len(data) > _LONGEST or not data.startswith(b"#!") or b"sys.exit(" not in data:
        return None
    text = data.decode("utf-8", "replace")
    by_setuptools = _BY_SETUPTOOLS.search(text)
    if by_setuptools:
        return _declared(*by_setuptools.groups())
    by_pip = _BY_PIP.search(text)
    return by_pip.group(1) if by_pip else None


def _declared(distribution: str, name: str) -> str | None:
    """The module of an entry point, from the metadata of the installed package."""
    from importlib import metadata  # noqa: PLC0415

    try:
        points = metadata.distribution(distribution).entry_points
    except metadata.PackageNotFoundError:
        return None
    for point in points:
        if point.group == "console_scripts" and point.name == name:
            return point.value.partition(":")[0].strip()
    return None
