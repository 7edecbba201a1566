"""Reads declarations of parameters: in ``.cfg`` files, and in recorded messages.

``read_declared`` is the entrance. It reads the ``.cfg`` files of dynamic_reconfigure below folders
of sources, and the descriptions that its servers published, where a bag has them. Descriptors of
ROS 2 are not read: they exist in the running program only, and no topic carries them.

No ``.cfg`` file is run. Nearly all of these files consist of constants and arithmetic with them,
names, lists, groups, ``const``, ``enum`` and ``add``, and loops over known values, which are
followed. Everything else (calls of other functions with the generator, values from elsewhere) is
reported and left out.
"""

from __future__ import annotations

import ast
import math
import operator
import os
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from stat import S_ISREG

from pytpc.ingest.declared_bag import read_declared_bag
from pytpc.ingest.magic import BAG_MAGIC
from pytpc.recording.declaration import Declared, RawValues, make_declared
from pytpc.static.static_info import StaticInfo

_LARGEST_FILE = 1 << 20
_DECLARING = (".cfg", ".bag")
_NOT_SOURCES = frozenset({"build", "devel", "install", "log", "node_modules", "__pycache__"})

_TYPES = {"str_t": "str", "bool_t": "bool", "int_t": "int", "double_t": "double"}
_ADD = ("name", "paramtype", "level", "description", "default", "min", "max", "edit_method")
_CONST = ("name", "type", "value", "descr")
_ENUM = ("constants", "description")
_GENERATOR = "ParameterGenerator"
_MOST_STEPS = 10_000
_LONGEST = 10_000
_WIDTH = re.compile("[0-9]{4}|[*]")

_BINARY: dict[type[ast.operator], Callable[..., object]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
}
_UNARY: dict[type[ast.unaryop], Callable[..., object]] = {
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Not: operator.not_,
}
_FUNCTIONS: dict[str, Callable[..., object]] = {
    "exit": lambda *_: None,
    "sys.exit": lambda *_: None,
    "print": lambda *_: None,
    "float": float,
    "int": int,
    "str": str,
    "bool": bool,
    "abs": abs,
    "min": min,
    "max": max,
    "math.radians": math.radians,
    "math.degrees": math.degrees,
    "math.sqrt": math.sqrt,
}
_NAMES: dict[str, object] = {
    "math.pi": math.pi,
    "pi": math.pi,
    "numpy.pi": math.pi,
    "np.pi": math.pi,
}


class _UnknownError(Exception):
    """A value that cannot be worked out."""


@dataclass(frozen=True, slots=True)
class _Generator:
    """A ParameterGenerator, or a group of one."""


def read_declared(
    paths: Iterable[Path], on_skipped: Callable[[str], None] | None = None
) -> list[Declared]:
    """The declarations in files and below folders, in the order of the paths.

    Args:
        paths: ``.cfg`` files, ROS 1 bags, and folders that have such files: sources (hidden and
            build folders are skipped) or a recorded mission. A path that does not exist has none.
        on_skipped: called with one line for each declaration or file that could not be read.
    """
    found: list[Declared] = []
    for path in dict.fromkeys(file for given in paths for file in _declaring_files(given)):
        try:
            some, skipped = _read(path)
        except OSError as error:
            some, skipped = [], [f"{path}: {error.strerror or error}"]
        found += some
        for line in skipped if on_skipped is not None else ():
            on_skipped(line)  # type: ignore[misc]
    return found


def declared_in(
    static_info: StaticInfo,
    recordings: Iterable[Path] = (),
    on_skipped: Callable[[str], None] | None = None,
) -> list[Declared]:
    """The declarations in the packages of ``static_info``, and in what was recorded."""
    roots = sorted({Path(unit.source_root) for unit in static_info.units})
    tops = [root for root in roots if not any(above in roots for above in root.parents)]
    return read_declared([*tops, *recordings], on_skipped)


def _read(path: Path) -> tuple[list[Declared], list[str]]:
    """The declarations of one file, and a line for each that could not be read.

    Raises:
        OSError: the file cannot be read.
    """
    if _is_bag(path):
        return read_declared_bag(path)
    status = path.stat()
    if not S_ISREG(status.st_mode):
        return [], [f"{path}: not a file"]
    if status.st_size > _LARGEST_FILE:
        return [], [f"{path}: too large"]
    text = path.read_bytes()
    if _GENERATOR.encode() not in text:
        return [], []
    found, skipped = read_cfg(text, path)
    package = str(_package_of(path))
    return [replace(one, package=package) for one in found], skipped


def _declaring_files(path: Path) -> list[Path]:
    if path.is_file():
        return [path] if path.suffix in _DECLARING or _is_bag(path) else []
    found = []
    for folder, below, files in os.walk(path):
        below[:] = sorted(b for b in below if not b.startswith(".") and b not in _NOT_SOURCES)
        found += [Path(folder, name) for name in sorted(files) if name.endswith(_DECLARING)]
    return found


def _is_bag(path: Path) -> bool:
    if path.suffix == ".bag":
        return True
    try:
        with path.open("rb") as stream:
            return stream.read(len(BAG_MAGIC)) == BAG_MAGIC
    except OSError:
        return False


def _package_of(source: Path) -> Path:
    """The folder of the package that a file belongs to; its own folder if there is no package."""
    above = (folder for folder in source.parents if (folder / "package.xml").is_file())
    return next(above, source.parent)


def read_cfg(text: bytes, path: Path) -> tuple[list[Declared], list[str]]:
    """The declarations of a file, in its order, and a line for each that cannot be followed.

    Args:
        text: the file.
        path: where it is, for the places.
    """
    try:
        tree = ast.parse(text, filename=str(path))
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        line = getattr(error, "lineno", None) or 1
        return [], [f"{path}:{line}: not Python 3: {getattr(error, 'msg', None) or error}"]
    reader = _CfgReader(path)
    try:
        reader.run(tree.body)
    except RecursionError:
        reader.skip(1, "it is nested too deeply")
    return reader.found, reader.skipped


class _CfgReader:
    """Interprets the statements as far as values are known."""

    def __init__(self, path: Path) -> None:
        self.found: list[Declared] = []
        self.skipped: list[str] = []
        self._path = path
        self._values: dict[str, object] = {**_NAMES, **_TYPES}
        self._steps = 0

    def skip(self, line: int, why: str) -> None:
        text = f"{self._path}:{line}: {why}"
        if text not in self.skipped:
            self.skipped.append(text)

    def run(self, statements: list[ast.stmt]) -> None:
        for statement in statements:
            self._steps += 1
            if self._steps > _MOST_STEPS:
                self.skip(statement.lineno, "it takes too many steps; the rest is left out")
                return
            self._statement(statement)

    def _statement(self, statement: ast.stmt) -> None:
        match statement:
            case ast.Assign(targets=targets, value=value):
                for target in targets:
                    self._assign(target, value)
            case ast.AnnAssign(target=target, value=ast.expr() as value):
                self._assign(target, value)
            case ast.Expr(value=ast.Call() as call):
                self._call_statement(call)
            case ast.For(target=ast.Name(id=name), iter=over, body=body):
                self._loop(name, over, body)
            case ast.If(test=test, body=body, orelse=orelse):
                self._branch(test, body, orelse)
            case ast.With(body=body) | ast.Try(body=body):
                self.run(body)
            case _:
                pass

    def _assign(self, target: ast.expr, value: ast.expr) -> None:
        if not isinstance(target, ast.Name):
            return
        try:
            self._values[target.id] = self._value(value)
        except _UnknownError:
            self._values.pop(target.id, None)

    def _call_statement(self, call: ast.Call) -> None:
        try:
            self._value(call)
        except _UnknownError as why:
            # What has nothing to do with the generator declares nothing.
            if self._mentions_generator([call]):
                self.skip(call.lineno, f"{_source(call)}: {why}")

    def _loop(self, name: str, over: ast.expr, body: list[ast.stmt]) -> None:
        try:
            values = self._value(over)
        except _UnknownError as why:
            self.skip(over.lineno, f"a loop over {_source(over)}: {why}")
            return
        for value in values if isinstance(values, list | tuple | range) else ():
            self._values[name] = value
            self.run(body)

    def _branch(self, test: ast.expr, body: list[ast.stmt], orelse: list[ast.stmt]) -> None:
        try:
            self.run(body if self._value(test) else orelse)
        except _UnknownError:
            if self._mentions_generator([*body, *orelse]):
                self.skip(test.lineno, f"it depends on {_source(test)}")

    def _mentions_generator(self, parts: Iterable[ast.AST]) -> bool:
        return any(self._is_generator(node) for part in parts for node in ast.walk(part))

    def _is_generator(self, node: ast.AST) -> bool:
        return isinstance(node, ast.Name) and isinstance(self._values.get(node.id), _Generator)

    def _value(self, node: ast.expr) -> object:
        """The value of an expression.

        Raises:
            _UnknownError: it is not followed.
        """
        name = _dotted(node)
        if name in self._values:
            return self._values[name]
        try:
            return self._compound(node)
        except (ArithmeticError, TypeError, ValueError, KeyError, IndexError) as error:
            raise _UnknownError(f"{_source(node)} has no value") from error

    def _compound(self, node: ast.expr) -> object:
        match node:
            case ast.Constant(value=value):
                return value
            case ast.List(elts=parts) | ast.Tuple(elts=parts):
                return [self._value(part) for part in parts]
            case ast.UnaryOp(op=op, operand=operand) if type(op) in _UNARY:
                return _UNARY[type(op)](self._value(operand))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                return self._binary(op, self._value(left), self._value(right))
            case ast.Call():
                return self._call(node)
            case _:
                raise _UnknownError(f"{_source(node)} is not known")

    def _binary(self, op: ast.operator, left: object, right: object) -> object:
        if isinstance(right, list) and isinstance(op, ast.Mod):
            right = tuple(right)
        if isinstance(left, str) and _WIDTH.search(left):
            raise _UnknownError("a long text")
        numbers = isinstance(left, int | float) and isinstance(right, int | float)
        if isinstance(op, ast.Pow | ast.Mult) and not numbers:
            raise _UnknownError("a product of other things than numbers")
        if isinstance(op, ast.Pow) and isinstance(right, int | float) and abs(right) > 64:
            raise _UnknownError("a large power")
        value = _BINARY[type(op)](left, right)
        if isinstance(value, str | list) and len(value) > _LONGEST:
            raise _UnknownError("a long text")
        return value

    def _call(self, call: ast.Call) -> object:
        name = _dotted(call.func)
        if name.rpartition(".")[2] == _GENERATOR:
            return _Generator()
        if isinstance(call.func, ast.Attribute) and self._is_generator(call.func.value):
            return self._of_generator(call.func.attr, call)
        arguments = [self._value(argument) for argument in call.args]
        if call.keywords or any(isinstance(one, _Generator) for one in arguments):
            raise _UnknownError("the function is not followed")
        if name == "range" and all(isinstance(one, int) for one in arguments):
            numbers = range(*(int(str(one)) for one in arguments))
            if len(numbers) <= _LONGEST:
                return numbers
        if name in _FUNCTIONS:
            return _FUNCTIONS[name](*arguments)
        raise _UnknownError("the function is not followed")

    def _of_generator(self, method: str, call: ast.Call) -> object:
        if method == "add":
            self._add(call)
            return None
        if method == "const":
            return self._arguments(call, _CONST)
        if method == "enum":
            return self._arguments(call, _ENUM)["constants"]
        # `generate` writes files.
        return _Generator() if method == "add_group" else None

    def _arguments(self, call: ast.Call, names: tuple[str, ...]) -> Mapping[str, object]:
        given = dict(zip(names, (self._value(one) for one in call.args), strict=False))
        for keyword in call.keywords:
            if keyword.arg is None:
                raise _UnknownError("arguments in a dictionary")
            given[keyword.arg] = self._value(keyword.value)
        return given

    def _add(self, call: ast.Call) -> None:
        given = self._arguments(call, _ADD)
        name, type_ = given.get("name"), given.get("paramtype")
        if not isinstance(name, str) or type_ not in _TYPES.values():
            raise _UnknownError("name and type are not both known")
        self.found.append(
            make_declared(
                name,
                str(type_),
                RawValues(*(given.get(what) for what in ("min", "max", "default", "description"))),
                constants=given.get("edit_method"),
                place=f"{self._path}:{call.lineno}",
            )
        )


def _dotted(node: ast.expr) -> str:
    """``a.b.c`` of names and attributes, else nothing."""
    if isinstance(node, ast.Attribute):
        before = _dotted(node.value)
        return f"{before}.{node.attr}" if before else ""
    return node.id if isinstance(node, ast.Name) else ""


def _source(node: ast.AST) -> str:
    text = " ".join(ast.unparse(node).split())
    return text if len(text) <= 60 else f"{text[:57]}..."
