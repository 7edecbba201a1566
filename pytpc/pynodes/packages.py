"""Which scripts of a package are nodes, and where its modules are."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from pytpc.errors import InputError
from pytpc.pynodes.program import parse
from pytpc.workspace import read_manifest

_LEFT_OUT = {"build", "devel", "install", "log", "test", "tests", "node_modules", "__pycache__"}
_SHEBANG = re.compile(rb"^#!.*\bpython")
_NOT_NODES = {"setup.py", "conftest.py"}
_INITIALISING = {"init_node", "init"}


@dataclass(frozen=True)
class Entry:
    """A script: the name of its link unit, its package and where modules are looked for."""

    script: Path
    name: str
    package: str
    root: Path
    folders: tuple[Path, ...]


def entries(path: Path, on_fault: Callable[[InputError], None] | None = None) -> list[Entry]:
    """The scripts that ``path`` means: itself, or all of the packages in a folder.

    Args:
        path: a script, or a folder.
        on_fault: is told of scripts in a folder that cannot be parsed; they are left out.

    Raises:
        InputError: there is no such file or folder.
    """
    path = path.absolute()
    if path.is_file():
        return [entry_of(path)]
    if not path.is_dir():
        raise InputError("no such file or folder", path)
    found = [entry_of(script) for script in _scripts(path, on_fault)]
    return _named_apart(found)


def entry_of(script: Path) -> Entry:
    """A script with its package: the nearest folder above with a package.xml, else its own."""
    root = next(
        (folder for folder in script.parents if (folder / "package.xml").is_file()), script.parent
    )
    package = root.name
    if (root / "package.xml").is_file():
        package = read_manifest(root).name
    candidates = [script.parent, root / "src", root]
    folders = tuple(dict.fromkeys(folder for folder in candidates if folder.is_dir()))
    return Entry(script, script.name.removesuffix(".py"), package or script.stem, root, folders)


def _named_apart(found: list[Entry]) -> list[Entry]:
    """Scripts of one package with the same name get their folder into theirs."""
    known: dict[tuple[str, str], int] = {}
    for entry in found:
        known[entry.package, entry.name] = known.get((entry.package, entry.name), 0) + 1
    return [
        entry
        if known[entry.package, entry.name] == 1
        else Entry(
            entry.script,
            str(entry.script.relative_to(entry.root)).removesuffix(".py"),
            entry.package,
            entry.root,
            entry.folders,
        )
        for entry in found
    ]


def _scripts(folder: Path, on_fault: Callable[[InputError], None] | None) -> Iterator[Path]:
    for here, below, files in os.walk(folder):
        below[:] = sorted(name for name in below if name not in _LEFT_OUT and name[0] != ".")
        for name in sorted(files):
            path = Path(here) / name
            try:
                if name not in _NOT_NODES and is_node(path):
                    yield path
            except InputError as error:
                if on_fault is not None:
                    on_fault(error)


def is_node(path: Path) -> bool:
    """True for a script that starts a node: run by itself, and it initialises ROS or could."""
    try:
        with path.open("rb") as file:
            start = file.read(256)
    except OSError:
        return False
    shebang = _SHEBANG.match(start) is not None
    if path.suffix != ".py" and not shebang:
        return False
    _, tree = parse(path)
    if any(map(_is_guard, tree.body)):
        return True
    return shebang and any(map(_initialises, ast.walk(tree)))


def _is_guard(node: ast.stmt) -> bool:
    """``if __name__ == "__main__":``"""
    if not isinstance(node, ast.If):
        return False
    return any(isinstance(part, ast.Name) and part.id == "__name__" for part in ast.walk(node.test))


def _initialises(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute | ast.Name)
        and (node.func.attr if isinstance(node.func, ast.Attribute) else node.func.id)
        in _INITIALISING
    )
