"""A link unit of Python: a script and the modules of its package that it imports."""

from __future__ import annotations

import ast
import tokenize
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from pytpc.errors import InputError
from pytpc.pynodes.ir import Function, Instr, Module
from pytpc.pynodes.lower import lower_module


@dataclass
class Program:
    """All modules of a link unit, the script's first; ``name`` and ``package`` as in the JSON."""

    name: str
    package: str
    root: Path
    modules: list[Module] = field(default_factory=list)

    @property
    def functions(self) -> list[Function]:
        """Those of all modules."""
        return [function for module in self.modules for function in module.functions]

    @cached_property
    def attributes(self) -> list[str]:
        """The names of all attributes that are stored into, sorted; for when all is loaded."""
        names = {str(instr.data) for instr in self.instructions() if instr.op == "setattr"}
        return sorted(names)

    def instructions(self) -> list[Instr]:
        """Those of all functions, in order."""
        return [instr for function in self.functions for instr in function.instructions()]


def read_source(path: Path) -> str:
    """The text of a source file, by the encoding that it declares.

    Raises:
        InputError: it cannot be read or decoded.
    """
    try:
        with tokenize.open(path) as file:
            return file.read()
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path) from None
    except (SyntaxError, UnicodeDecodeError, LookupError) as error:
        raise InputError(f"cannot be decoded: {error}", path) from None


def parse(path: Path) -> tuple[str, ast.Module]:
    """The text and the syntax tree of a source file.

    Raises:
        InputError: it cannot be read, or is no Python 3, with the line.
    """
    source = read_source(path)
    try:
        return source, ast.parse(source, str(path))
    except SyntaxError as error:
        raise InputError(f"not Python 3: {error.msg}", path, error.lineno) from None
    except (ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"cannot be parsed: {error}", path) from None


class Loader:
    """Loads a script and, as it is lowered, what it imports."""

    def __init__(self, program: Program, folders: list[Path]) -> None:
        """``folders`` are where the package's modules are looked for, the first one first."""
        self.program = program
        self.folders = folders
        self._known: dict[Path, Module] = {}
        self._numbers = [0]

    def load(self, script: Path) -> Program:
        """Load the script and all that follows from it.

        Raises:
            InputError: a file cannot be read or parsed.
        """
        self._module(script, "__main__")
        for module in self.program.modules:
            lower_module(module, self.resolve, self._numbers)
        return self.program

    def _module(self, path: Path, name: str) -> Module:
        path = path.absolute()
        if path not in self._known:
            source, tree = parse(path)
            relative = (
                path.relative_to(self.program.root)
                if path.is_relative_to(self.program.root)
                else path
            )
            module = Module(name, str(relative), source, tree, path.name == "__init__.py")
            self._known[path] = module
            self.program.modules.append(module)
        return self._known[path]

    def resolve(self, user: Module, name: str, dots: int) -> Module | str:
        """What an import in ``user`` means: a module of the package, else a dotted name."""
        if dots == 0:
            return self._found(self.folders, name) or name
        folder = (self.program.root / user.path).parent
        for _ in range(dots - 1):
            folder = folder.parent
        if not name:
            start = folder / "__init__.py"
            return self._module(start, folder.name) if start.is_file() else folder.name
        return self._found([folder], name, user) or f"{folder.name}.{name}"

    def _found(self, folders: list[Path], name: str, user: Module | None = None) -> Module | None:
        parts = name.split(".")
        for folder in folders:
            base = folder.joinpath(*parts)
            for path in (base / "__init__.py", base.with_name(base.name + ".py")):
                if path.is_file():
                    full = name if user is None else f"{folder.name}.{name}"
                    return self._module(path, full)
        return None
