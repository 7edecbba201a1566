"""Which scripts are nodes: run by themselves, and with something to do with ROS."""

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
    """A program: the name of its link unit, its package and where modules are looked for.

    ``folders`` are looked into first; ``packages`` has, by dotted name, the folder (or the file
    without ``.py``) of each package of the workspace that is installed. An entry point has the name
    of its ``module`` and the function that is called, ``begin``; a script is ``__main__``.
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
        """The files that an import of the dotted ``name`` may mean, the first one first."""
        parts = name.split(".")
        for folder in self.folders:
            yield from module_files(folder.joinpath(*parts))
        for count in range(len(parts), 0, -1):
            known = self.packages.get(".".join(parts[:count]))
            if known is not None:
                yield from module_files(known.joinpath(*parts[count:]))


def python_files(folder: Path, on_fault: Callable[[InputError], None]) -> Iterator[Path]:
    """The Python scripts and modules below a folder, sorted, each real folder once.

    Left out are hidden folders and those for tests and for what a build makes, unless they are
    packages, and what colcon leaves out. ``on_fault`` is told of files that cannot be read.
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
    """True for a file that ends with ``.py``, or begins with a shebang of Python."""
    return path.suffix == ".py" or _has_shebang(path)


def _has_shebang(path: Path) -> bool:
    try:
        # To open a pipe would wait for who writes into it.
        if not stat.S_ISREG(path.stat().st_mode):
            return False
        with path.open("rb") as file:
            return _SHEBANG.match(file.read(256)) is not None
    except OSError:
        return False


@dataclass(frozen=True)
class _Facts:
    """What is asked of a source file.

    ``imports``: the number of dots and the dotted name of each import. ``words``: all words of its
    text. ``is_guarded``: it has a ``__main__`` guard.
    """

    imports: tuple[tuple[int, str], ...]
    words: frozenset[str]
    is_guarded: bool
    initialises: bool


_NOTHING = _Facts((), frozenset(), False, False)


class Scripts:
    """Tells nodes from other scripts; each file is read once."""

    def __init__(self, rules: Rules) -> None:
        """``rules`` say which functions are ROS's."""
        self._known: dict[Path, _Facts] = {}
        self._faulty: set[Path] = set()
        self._libraries = {"rospy", "rclpy", *(path.split(".")[0] for path in rules.paths)}
        self._words = _LIVING | {path.rsplit(".", 1)[-1] for path in rules.paths}

    def is_run(self, program: Entry) -> bool:
        """True for a script that says by itself that it is run.

        Raises:
            InputError: it cannot be read or parsed.
        """
        facts = self._read(program.script)
        return facts.is_guarded or (facts.initialises and _has_shebang(program.script))

    def has_to_do_with_ros(self, program: Entry) -> bool:
        """True where the program, or a module of the workspace that it imports, speaks to ROS.

        That is, it imports one of ROS's libraries and has a word of what reads parameters, exposes,
        makes what exposes, or starts a node.

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
        """The same; of a file that cannot be read there are none."""
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
    """All statements, those within others, too."""
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
