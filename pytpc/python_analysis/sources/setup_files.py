"""What setup.py, setup.cfg and pyproject.toml declare about a package's modules and programs.

setup.py is read, never run: it takes the arguments of ``setup`` and ``generate_distutils_setup``
(catkin) that are built from constants. For ``find_packages()`` each folder with an ``__init__.py``
counts.
"""

from __future__ import annotations

import ast
import configparser
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pytpc.base.errors import InputError
from pytpc.python_analysis.sources.source_files import parse

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_SETUP = {"setup", "generate_distutils_setup"}
# Errors of expressions that are not constant, or wrong.
_UNFIT = (AttributeError, LookupError, OverflowError, MemoryError, TypeError, ValueError)
_Fault = Callable[[InputError], None]


@dataclass
class Installed:
    """What the installation of a package installs.

    ``programs``: name of a program -> ``module:function``. ``scripts``: files, relative to the
    package. ``folders``: dotted name of a package -> its folder, relative to the package; the empty
    name is for all others. ``packages``, ``modules``: the names that are installed; ``packages`` is
    None where nothing is declared.
    """

    programs: dict[str, str] = field(default_factory=dict)
    scripts: list[str] = field(default_factory=list)
    folders: dict[str, str] = field(default_factory=dict)
    packages: list[str] | None = None
    modules: list[str] = field(default_factory=list)
    is_any: bool = False


def read_setup(root: Path, on_fault: _Fault) -> Installed:
    """What the files of the package in ``root`` declare together.

    Args:
        root: the package's folder.
        on_fault: called with a file that cannot be read, which is then ignored.
    """
    found = Installed()
    readers = (("setup.py", _setup_py), ("setup.cfg", _setup_cfg), ("pyproject.toml", _pyproject))
    for name, read in readers:
        path = root / name
        if path.is_file():
            try:
                read(path, found)
            except InputError as error:
                on_fault(error)
    return found


def _take(found: Installed, key: str, value: object) -> None:
    """One argument of ``setup``, or its counterpart in another file."""
    match key:
        case "package_dir" if isinstance(value, dict):
            found.folders.update((str(name), str(each)) for name, each in value.items())
        case "packages" if isinstance(value, list):
            found.packages = [*(found.packages or []), *_texts(value)]
        case "py_modules":
            found.modules += _texts(value)
        case "scripts":
            found.scripts += _texts(value)
        case "entry_points" if isinstance(value, dict):
            _programs(found, value.get("console_scripts"))
        case _:
            pass


def _programs(found: Installed, value: object) -> None:
    lines = value.splitlines() if isinstance(value, str) else _texts(value)
    for line in lines:
        name, sign, target = line.partition("=")
        if sign and ":" in target:
            found.programs[name.strip()] = target.partition("[")[0].strip()


def _texts(value: object) -> list[str]:
    items = value if isinstance(value, list | tuple) else [value]
    return [item for item in items if isinstance(item, str)]


# setup.py


def _setup_py(path: Path, found: Installed) -> None:
    _, tree = parse(path)
    names: dict[str, ast.expr] = {}
    for statement in tree.body:
        if isinstance(statement, ast.Assign):
            for target in statement.targets:
                if isinstance(target, ast.Name):
                    names[target.id] = statement.value
    constants = _Constants(names)
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and _name_of(node.func) in _SETUP:
            found.is_any = True
            for keyword in node.keywords:
                if keyword.arg is not None:
                    _take(found, keyword.arg, constants.value(keyword.value))
                    continue
                table = constants.value(keyword.value)
                for key, value in table.items() if isinstance(table, dict) else ():
                    _take(found, str(key), value)


def _name_of(node: ast.expr) -> str:
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


class _Constants:
    """The values of constant expressions; None for others."""

    def __init__(self, names: dict[str, ast.expr]) -> None:
        self._names = names
        self._active: set[str] = set()

    def value(self, node: ast.expr) -> Any:  # noqa: ANN401
        match node:
            case ast.Constant(value=value):
                return value
            case ast.Name(id=name) if name in self._names and name not in self._active:
                self._active.add(name)
                found = self.value(self._names[name])
                self._active.discard(name)
                return found
            case ast.List(elts=parts) | ast.Tuple(elts=parts) | ast.Set(elts=parts):
                return [self.value(part) for part in parts]
            case ast.Dict():
                return self._table(node)
            case ast.Call(func=ast.Name(id="dict"), args=[], keywords=keywords):
                return {each.arg: self.value(each.value) for each in keywords if each.arg}
            case ast.JoinedStr(values=parts):
                return self._joined([self.value(part) for part in parts])
            case ast.FormattedValue(value=inner, conversion=-1, format_spec=None):
                return self.value(inner)
            case ast.BinOp(left=left, op=ast.Add() | ast.Mod() as op, right=right):
                return self._put_together(self.value(left), op, self.value(right))
            case ast.Call(func=ast.Attribute(value=text, attr="format"), args=args, keywords=[]):
                return self._formatted(self.value(text), [self.value(arg) for arg in args])
            case _:
                return None

    def _table(self, node: ast.Dict) -> dict[Any, Any]:
        found: dict[Any, Any] = {}
        for key, value in zip(node.keys, node.values, strict=True):
            known = self.value(value)
            if key is None:
                found.update(known if isinstance(known, dict) else {})
            elif isinstance(name := self.value(key), str):
                found[name] = known
        return found

    @staticmethod
    def _joined(parts: list[Any]) -> str | None:
        return None if any(part is None for part in parts) else "".join(map(str, parts))

    @staticmethod
    def _put_together(left: Any, op: ast.operator, right: Any) -> Any:  # noqa: ANN401
        try:
            if isinstance(op, ast.Mod):
                given = tuple(right) if isinstance(right, list) else right
                return left % given if isinstance(left, str) and right is not None else None
            return left + right
        except _UNFIT:
            return None

    @staticmethod
    def _formatted(text: Any, args: list[Any]) -> str | None:  # noqa: ANN401
        try:
            return text.format(*args) if isinstance(text, str) and None not in args else None
        except _UNFIT:
            return None


# setup.cfg and pyproject.toml


def _setup_cfg(path: Path, found: Installed) -> None:
    parser = configparser.ConfigParser(interpolation=None)
    try:
        parser.read_string(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError, configparser.Error) as error:
        raise InputError(f"cannot be read: {error}", path) from None
    if parser.has_section("options"):
        options = parser["options"]
        found.is_any = True
        lines = options.get("package_dir", "").splitlines()
        pairs = (line.partition("=") for line in lines if "=" in line)
        _take(found, "package_dir", {name.strip(): each.strip() for name, _, each in pairs})
        names = options.get("packages", "").replace(",", "\n").split()
        if names and not names[0].startswith("find"):
            _take(found, "packages", names)
        _take(found, "py_modules", options.get("py_modules", "").replace(",", "\n").split())
        _take(found, "scripts", options.get("scripts", "").replace(",", "\n").split())
    if parser.has_section("options.entry_points"):
        _programs(found, parser["options.entry_points"].get("console_scripts", ""))


def _pyproject(path: Path, found: Installed) -> None:
    try:
        data: Any = tomllib.loads(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"cannot be read: {error}", path) from None
    project, tool = _of(data, "project"), _of(data, "tool")
    setuptools = _of(tool, "setuptools")
    found.is_any |= bool(project or setuptools)
    tables = (
        _of(project, "scripts"),
        _of(_of(project, "entry-points"), "console_scripts"),
        _of(_of(tool, "poetry"), "scripts"),
    )
    for table in tables:
        _programs(found, [f"{name} = {target}" for name, target in table.items()])
    _take(found, "package_dir", _of(setuptools, "package-dir"))
    _take(found, "packages", setuptools.get("packages"))
    _take(found, "py_modules", setuptools.get("py-modules"))
    where = _of(_of(setuptools, "packages"), "find").get("where")
    if isinstance(where, list) and where and isinstance(where[0], str):
        _take(found, "package_dir", {"": where[0]})


def _of(table: object, name: str) -> dict[str, Any]:
    value = table.get(name) if isinstance(table, dict) else None
    return value if isinstance(value, dict) else {}
