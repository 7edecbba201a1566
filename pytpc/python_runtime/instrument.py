"""The instrumentation of one process: which modules, what was done with them, what is missing."""

from __future__ import annotations

import tokenize
from io import BytesIO
from types import CodeType
from typing import TYPE_CHECKING, NamedTuple

from pytpc.python_runtime import quiet
from pytpc.python_runtime.find import matching
from pytpc.python_runtime.listed import ListedFile, ListedFiles
from pytpc.python_runtime.rewrite import rewrite
from pytpc.python_runtime.words import many, warn

if TYPE_CHECKING:
    from pytpc.python_runtime.rewrite import Register

# What a module that traces by itself has in its text.
_TRACING = (b"settrace", b"setprofile", b"sys.monitoring")


class Instrumented(NamedTuple):
    """One module that was rewritten, or was to be."""

    path: str
    instrumented: int
    missing: int


class Instrument:
    """Compiles the modules that have listed comparisons."""

    def __init__(self, table: ListedFiles, register: Register) -> None:
        self.table = table
        self._register = register
        self.done: list[Instrumented] = []

    def knows(self, path: str) -> bool:
        """Whether a file of this name has comparisons."""
        return bool(self.table.candidates(path))

    def code(self, data: bytes, path: str, *, optimize: int = -1) -> CodeType | None:
        """The code of a module that reports; None where it has nothing to report.

        What cannot be found in the module is said: the file was changed since it was analysed.

        Args:
            data: the bytes of the source.
            path: what the module calls itself.
            optimize: as of ``compile``.

        Raises:
            SyntaxError: as ``compile`` has it.
        """
        chosen = self._chosen(data, path)
        if chosen is None:
            return None
        if any(word in data for word in _TRACING):
            quiet.watch()
        rewritten = rewrite(data, path, chosen.comparisons, self._register, optimize=optimize)
        missing = len(rewritten.missing)
        if missing:
            first = rewritten.missing[0]
            warn(
                f"{path}:{first.lineno}: {many(missing, 'comparison')} not where the static"
                " information says, and not reported; analyse it again"
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
                warn(f"{path}: not as it was analysed, and not reported; analyse it again")
                self.done.append(Instrumented(path, 0, len(candidates[0].comparisons)))
            else:
                self.done.append(Instrumented(f"{path} (not {names})", 0, 0))
        return chosen


def _text(data: bytes) -> str:
    try:
        encoding, _ = tokenize.detect_encoding(BytesIO(data).readline)
        return data.decode(encoding, "replace")
    except (SyntaxError, LookupError):
        return ""
