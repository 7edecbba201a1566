"""The modules of a link unit of Python, loaded and lowered."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.python_analysis.ir.instructions import Function, Instr, Module
from pytpc.python_analysis.ir.lower import lower_module
from pytpc.python_analysis.sources.scripts import Entry
from pytpc.python_analysis.sources.source_files import folder_above, module_files, parse


@dataclass(frozen=True)
class Unread:
    """An imported module that cannot be read or parsed; ``path`` as in `Module`."""

    path: str
    error: InputError


class Program:
    """A script and the modules of the workspace that it imports, the script first in ``modules``.

    ``name`` and ``package`` are those of the JSON. ``faults``: the modules that cannot be read.
    """

    def __init__(self, entry: Entry) -> None:
        """``entry`` says where the program begins and where modules are looked for."""
        self.entry = entry
        self.name, self.package, self.root = entry.name, entry.package, entry.root
        self.modules: list[Module] = []
        self.faults: list[Unread] = []
        self._known: dict[Path, Module | None] = {}
        self._numbers = [0]

    @property
    def functions(self) -> list[Function]:
        """The functions of all modules."""
        return [function for module in self.modules for function in module.functions]

    @cached_property
    def attributes(self) -> list[str]:
        """The names of all attributes that are stored, sorted; use it when all is loaded."""
        names = {str(instr.data) for instr in self.instructions() if instr.op == "setattr"}
        return sorted(names)

    def instructions(self) -> list[Instr]:
        """The instructions of all functions, in order."""
        return [instr for function in self.functions for instr in function.instructions()]

    def load(self) -> None:
        """Load the script and, as it is lowered, what it imports.

        Raises:
            InputError: the script cannot be read or parsed.
        """
        script = self.entry.script.absolute()
        source, tree = parse(script)
        self._add(script, self.entry.module, source, _begun(tree, self.entry.begin))
        for module in self.modules:
            lower_module(module, self.resolve, self._numbers)

    def _relative(self, path: Path) -> str:
        """A file as static information names it: by its absolute path outside the package."""
        return str(path.relative_to(self.root) if path.is_relative_to(self.root) else path)

    def _add(self, path: Path, name: str, source: str, tree: ast.Module) -> Module:
        module = Module(name, self._relative(path), source, tree)
        self._known[path] = module
        self.modules.append(module)
        return module

    def _module(self, path: Path, name: str) -> Module | None:
        """The module of a file; None where it cannot be parsed, which is tried once."""
        path = path.absolute()
        if path not in self._known:
            try:
                return self._add(path, name, *parse(path))
            except InputError as error:
                self._known[path] = None
                self.faults.append(Unread(self._relative(path), error))
        return self._known[path]

    def resolve(self, user: Module, name: str, dots: int) -> Module | str:
        """What an import in ``user`` means: a module of the workspace, else a dotted name."""
        if dots == 0:
            for path in self.entry.places(name):
                return self._module(path, name) or name
            return name
        folder = folder_above(self.root / user.path, dots)
        if not name:
            start = folder / "__init__.py"
            found = self._module(start, folder.name) if start.is_file() else None
            return found or folder.name
        full = f"{folder.name}.{name}"
        for path in module_files(folder.joinpath(*name.split("."))):
            return self._module(path, full) or full
        return full


def _begun(tree: ast.Module, begin: str) -> ast.Module:
    """The module with a call of the function ``begin`` at its end, as for an entry point.

    The call has the position at which the function's name is bound.
    """
    if not begin:
        return tree
    first, *rest = begin.split(".")
    where = next((each for each in tree.body if first in _bound_by(each)), None)
    if where is None:
        return tree
    function: ast.expr = ast.Name(first, ast.Load())
    for name in rest:
        function = ast.Attribute(function, name, ast.Load())
    call = ast.Expr(ast.Call(function, [], []))
    for node in ast.walk(call):
        ast.copy_location(node, where)
    return ast.Module([*tree.body, call], tree.type_ignores)


def _bound_by(statement: ast.stmt) -> Iterator[str]:
    if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield statement.name
    elif isinstance(statement, ast.Import | ast.ImportFrom):
        yield from (alias.asname or alias.name.split(".")[0] for alias in statement.names)
    elif isinstance(statement, ast.Assign):
        yield from (part.id for part in statement.targets if isinstance(part, ast.Name))
