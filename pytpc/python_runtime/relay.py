"""catkin's relays: scripts and packages of a devel space that run a file of the source space.

They read the file and hand its text to ``compile`` or ``exec``. In a relay, and there alone, these
calls are given the code of the instrumented file in the place of the text.
"""

from __future__ import annotations

import ast
from types import CodeType
from typing import TYPE_CHECKING, TextIO

from pytpc.python_runtime.rewrite import constant_text, with_constants

if TYPE_CHECKING:
    from pytpc.python_runtime.instrument import Instrument

_SIGNS = (
    b"generated from catkin/cmake/template/script.py.in",
    b"generated from catkin/cmake/template/__init__.py.in",
)


class _RelayReader:
    """Stands in a relay in the place of what it calls."""

    def __init__(self, instrument: Instrument) -> None:
        self._instrument = instrument

    def compiled(self, source: str, path: str, mode: str) -> CodeType:
        """In the place of ``compile(text, path, 'exec')``."""
        with open(path, "rb") as stream:
            code = self._instrument.code(stream.read(), path)
        return code or compile(source, path, mode, dont_inherit=True)

    def read(self, stream: TextIO) -> CodeType | str:
        """In the place of ``stream.read()``, whose text is handed to ``exec``."""
        with open(stream.name, "rb") as again:
            code = self._instrument.code(again.read(), stream.name)
        return code or stream.read()


class _Calls(ast.NodeTransformer):
    def __init__(self, reader: str) -> None:
        self._reader = reader

    def visit_Call(self, node: ast.Call) -> ast.AST:
        if isinstance(node.func, ast.Name) and node.func.id == "compile":
            return self._replaced(node, "compiled", node.args)
        if isinstance(node.func, ast.Name) and node.func.id == "exec" and node.args:
            given = node.args[0]
            is_read = isinstance(given, ast.Call) and isinstance(given.func, ast.Attribute)
            if is_read and given.func.attr == "read":  # type: ignore[attr-defined]
                stream = given.func.value  # type: ignore[attr-defined]
                node.args[0] = self._replaced(given, "read", [stream])
                return node
        self.generic_visit(node)
        return node

    def _replaced(self, node: ast.expr, method: str, arguments: list[ast.expr]) -> ast.expr:
        constant = ast.copy_location(ast.Constant(value=self._reader, kind=None), node)
        function = ast.Attribute(value=constant, attr=method, ctx=ast.Load())
        call = ast.Call(func=ast.copy_location(function, node), args=arguments, keywords=[])
        return ast.copy_location(call, node)


def relayed(data: bytes, path: str, instrument: Instrument) -> CodeType | None:
    """The code of a relay that runs instrumented files; None where ``data`` is no relay."""
    if not any(sign in data[:1000] for sign in _SIGNS):
        return None
    tree = ast.parse(data, path)
    mark = constant_text(0)
    constants: dict[str, object] = {mark: _RelayReader(instrument)}
    _Calls(mark).visit(tree)
    return with_constants(compile(tree, path, "exec", dont_inherit=True), constants)
