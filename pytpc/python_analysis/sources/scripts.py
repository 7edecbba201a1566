"""Which scripts are nodes: they are run themselves, and use ROS."""

from __future__ import annotations

import ast
import os
import re
import stat
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.python_analysis.rules_file import Rules
from pytpc.python_analysis.sources.source_files import folder_above, module_files, parse
from pytpc.workspace.packages import IGNORE_MARKERS, MANIFEST, PRODUCT_MARKERS

_LEFT_OUT = {"build", "devel", "install", "log", "test", "tests", "node_modules", "__pycache__"}
_NOT_NODES = {"setup.py", "conftest.py"}
_SHEBANG = re.compile(rb"^(?:\xef\xbb\xbf)?#!.*\bpython")
_WORD = re.compile(r"[^\W\d]\w*")
_INITIALISING = {"init_node", "init"}
_LIVING = {"init_node", "init", "spin", "create_node"}


@dataclass(frozen=True)
class Entry:
    """A program: the name of its link unit, its package and where modules are searched.

    ``folders`` are searched first; ``packages`` has, by dotted name, the folder (or the file
    without ``.py``) of each package that the workspace installs. An entry point has the name of its
    ``module`` and of the function that it calls, ``begin``; a script is ``__main__``.
    """

    script: Path
    name: str
    package: str
    root: Path
    folders: tuple[Path, ...]
    packages: Mapping[str, Path] = field(default_factory=dict, compare=False)
    module: str = "__main__"
    begin: str = ""

    def places(self, name: str) -> Iterator[Path]:
        """The files that an import of the dotted ``name`` may mean, in order."""
        parts = name.split(".")
        for folder in self.folders:
            yield from module_files(folder.joinpath(*parts))
        for count in range(len(parts), 0, -1):
            known = self.packages.get(".".join(parts[:count]))
            if known is not None:
                yield from module_files(known.joinpath(*parts[count:]))


def python_files(folder: Path, on_fault: Callable[[InputError], None]) -> Iterator[Path]:
    """The Python scripts and modules below a folder, sorted, each real folder once.

    Left out are hidden folders, folders for tests and of builds (unless they are packages), and
    what colcon ignores. ``on_fault`` is called with files that cannot be read.
    """
    seen: set[str] = set()
    for here, below, files in os.walk(folder, followlinks=True):
        real = os.path.realpath(here)
        is_product = not PRODUCT_MARKERS.isdisjoint(files)
        is_ignored = here != str(folder) and not IGNORE_MARKERS.isdisjoint([*files, *below])
        if real in seen or is_product or is_ignored:
            below.clear()
            continue
        seen.add(real)
        below[:] = sorted(name for name in below if _is_searched(Path(here, name)))
        for name in sorted(files):
            path = Path(here, name)
            try:
                if name not in _NOT_NODES and is_python(path):
                    str(path).encode()
                    yield path
            except UnicodeEncodeError:
                shown = ascii(os.fsencode(path))[2:-1]
                on_fault(InputError(f"{shown}: the name of this file is not UTF-8"))


def _is_searched(folder: Path) -> bool:
    if folder.name.startswith("."):
        return False
    return folder.name not in _LEFT_OUT or (folder / MANIFEST).is_file()


def is_python(path: Path) -> bool:
    """True for a file that ends with ``.py``, or begins with a Python shebang."""
    return path.suffix == ".py" or _has_shebang(path)


def _has_shebang(path: Path) -> bool:
    try:
        # Opening a pipe would wait for a writer.
        if not stat.S_ISREG(path.stat().st_mode):
            return False
        with path.open("rb") as file:
            return _SHEBANG.match(file.read(256)) is not None
    except OSError:
        return False


@dataclass(frozen=True)
class _Facts:
    """The facts about a source file.

    ``imports``: the number of dots and the dotted name of each import. ``words``: all words of its
    text. ``is_guarded``: it has a ``__main__`` guard.
    """

    imports: tuple[tuple[int, str], ...]
    words: frozenset[str]
    is_guarded: bool
    initialises: bool


_NOTHING = _Facts((), frozenset(), False, False)


class Scripts:
    """Distinguishes nodes from other scripts; reads each file once."""

    def __init__(self, rules: Rules) -> None:
        """``rules`` name the functions of ROS."""
        self._known: dict[Path, _Facts] = {}
        self._faulty: set[Path] = set()
        self._libraries = {"rospy", "rclpy", *(path.split(".")[0] for path in rules.paths)}
        self._words = _LIVING | {path.rsplit(".", 1)[-1] for path in rules.paths}

    def is_run(self, program: Entry) -> bool:
        """True for a script that is made to be run.

        Raises:
            InputError: it cannot be read or parsed.
        """
        facts = self._read(program.script)
        return facts.is_guarded or (facts.initialises and _has_shebang(program.script))

    def has_to_do_with_ros(self, program: Entry) -> bool:
        """True where the program, or a module of the workspace that it imports, uses ROS.

        It imports a library of ROS and has a word for reading parameters, for exposing, or for
        starting a node.

        Raises:
            InputError: the script cannot be read or parsed.
        """
        self._read(program.script)
        for path in self.reached(program):
            facts = self._facts(path)
            roots = {name.split(".")[0] for dots, name in facts.imports if dots == 0}
            if roots & self._libraries and facts.words & self._words:
                return True
        return False

    def reached(self, program: Entry) -> Iterator[Path]:
        """The script, and the files of the workspace that it imports."""
        seen = {program.script}
        waiting = [program.script]
        while waiting:
            here = waiting.pop()
            yield here
            for dots, name in self._facts(here).imports:
                for path in _meant(program, here, dots, name):
                    if path not in seen:
                        seen.add(path)
                        waiting.append(path)

    def _read(self, path: Path) -> _Facts:
        if path not in self._known:
            self._known[path] = _facts_of(*parse(path))
        return self._known[path]

    def _facts(self, path: Path) -> _Facts:
        """Like `_read`; an unreadable file has no facts."""
        if path in self._faulty:
            return _NOTHING
        try:
            return self._read(path)
        except InputError:
            self._faulty.add(path)
            return _NOTHING


def _meant(program: Entry, user: Path, dots: int, name: str) -> Iterator[Path]:
    """The files that an import in the file ``user`` may mean."""
    if dots == 0:
        yield from program.places(name)
        return
    folder = folder_above(user, dots)
    yield from module_files(folder.joinpath(*name.split(".")) if name else folder)


def _facts_of(source: str, tree: ast.Module) -> _Facts:
    imports: dict[tuple[int, str], None] = {}
    for statement in _statements(tree.body):
        if isinstance(statement, ast.Import):
            imports.update(((0, alias.name), None) for alias in statement.names)
        elif isinstance(statement, ast.ImportFrom):
            name = statement.module or ""
            imports[statement.level, name] = None
            for alias in statement.names:
                inner = f"{name}.{alias.name}" if name else alias.name
                imports[statement.level, inner] = None
    words = frozenset(_WORD.findall(source))
    initialises = not words.isdisjoint(_INITIALISING) and any(map(_initialises, ast.walk(tree)))
    return _Facts(tuple(imports), words, any(map(_is_guard, tree.body)), initialises)


def _statements(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """All statements, nested ones included."""
    waiting: list[ast.AST] = [*body]
    while waiting:
        here = waiting.pop()
        if isinstance(here, ast.stmt):
            yield here
        for name in ("body", "orelse", "finalbody", "handlers", "cases"):
            inner = getattr(here, name, ())
            if isinstance(inner, list):
                waiting += inner


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
