"""The instrumentation of one process: which modules report, and which comparisons are missing.

A devel space of catkin has relays: scripts and packages that read a file of the source space and
pass its text to ``compile`` or ``exec``. In relays alone, these calls get the code of the
instrumented file instead of the text.
"""

from __future__ import annotations

import ast
import tokenize
from io import BytesIO
from types import CodeType
from typing import TYPE_CHECKING, NamedTuple, TextIO

from pytpc.python_runtime import quiet
from pytpc.python_runtime.errors import many, warn
from pytpc.python_runtime.find import matching
from pytpc.python_runtime.listed import ListedFile, ListedFiles
from pytpc.python_runtime.rewrite import constant_text, rewrite, with_constants

if TYPE_CHECKING:
    from pytpc.python_runtime.rewrite import Register

# A module that traces has one of these in its text.
_TRACING = (b"settrace", b"setprofile", b"sys.monitoring")
# A relay has one of these near its beginning.
_RELAYING = (
    b"generated from catkin/cmake/template/script.py.in",
    b"generated from catkin/cmake/template/__init__.py.in",
)


class Instrumented(NamedTuple):
    """One module that was rewritten, or should have been."""

    path: str
    instrumented: int
    missing: int


class Instrument:
    """Compiles the modules that have listed comparisons."""

    def __init__(self, table: ListedFiles, register: Register) -> None:
        self.table = table
        self._register = register
        self.done: list[Instrumented] = []

    def code(self, data: bytes, path: str) -> CodeType | None:
        """The code of a module that reports, or of a relay; None where it has nothing to report.

        A warning names comparisons that are not in the module because it has changed since it was
        analysed.

        Args:
            data: the bytes of the source.
            path: the module's ``__file__``.

        Raises:
            SyntaxError: as in ``compile``.
        """
        chosen = self._chosen(data, path)
        if chosen is None:
            return self._relayed(data, path)
        if any(word in data for word in _TRACING):
            quiet.watch()
        rewritten = rewrite(data, path, chosen.comparisons, self._register)
        missing = len(rewritten.missing)
        if missing:
            first = rewritten.missing[0]
            warn(
                f"{path}:{first.lineno}: {many(missing, 'comparison')} not found: the file has"
                " changed since it was analysed; run pytpc analyse again"
            )
        for listed in rewritten.unsupported:
            is_flag = listed.relation == "flag"
            what = "choice between conditions" if is_flag else "value within a pattern"
            warn(f"{path}:{listed.lineno}: a {what} is not reported")
        missing += len(rewritten.unsupported)
        self.done.append(Instrumented(path, rewritten.instrumented, missing))
        return rewritten.code

    def _chosen(self, data: bytes, path: str) -> ListedFile | None:
        candidates = self.table.candidates(path)
        if not candidates:
            return None
        chosen = matching(candidates, _text(data))
        if chosen is None:
            names = ", ".join(sorted({candidate.path for candidate in candidates})[:2])
            if self.table.is_exact(path):
                warn(
                    f"{path} does not report: it has changed since it was analysed; run pytpc"
                    " analyse again"
                )
                self.done.append(Instrumented(path, 0, len(candidates[0].comparisons)))
            else:
                self.done.append(Instrumented(f"{path} (not {names})", 0, 0))
        return chosen

    def _relayed(self, data: bytes, path: str) -> CodeType | None:
        """The code of a relay that runs instrumented files; None where ``data`` is no relay."""
        if not any(sign in data[:1000] for sign in _RELAYING):
            return None
        tree = ast.parse(data, path)
        mark = constant_text(0)
        _RelayCalls(mark).visit(tree)
        code = compile(tree, path, "exec", dont_inherit=True)
        return with_constants(code, {mark: _RelayReader(self)})


def _text(data: bytes) -> str:
    try:
        encoding, _ = tokenize.detect_encoding(BytesIO(data).readline)
        return data.decode(encoding, "replace")
    except (SyntaxError, LookupError):
        return ""


class _RelayReader:
    """Replaces what a relay calls."""

    def __init__(self, instrument: Instrument) -> None:
        self._instrument = instrument

    def compiled(self, source: str, path: str, mode: str) -> CodeType:
        """Replaces ``compile(text, path, 'exec')``."""
        with open(path, "rb") as stream:
            code = self._instrument.code(stream.read(), path)
        return code or compile(source, path, mode, dont_inherit=True)

    def read(self, stream: TextIO) -> CodeType | str:
        """Replaces ``stream.read()``, whose text is passed to ``exec``."""
        with open(stream.name, "rb") as again:
            code = self._instrument.code(again.read(), stream.name)
        return code or stream.read()


class _RelayCalls(ast.NodeTransformer):
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
