"""Python source files: their text, their syntax tree, and why there is none."""

from __future__ import annotations

import ast
import re
import stat
import tokenize
import warnings
from collections.abc import Iterator
from pathlib import Path

from pytpc.base.errors import InputError

# Lines that are not Python 3, each with a name.
_PYTHON_2 = [
    (re.compile(r"^[^#'\"]*?(?:^|[\s:;])print\s+(?!=)[\w'\"(%>]"), "print without parentheses"),
    (re.compile(r"^\s*except\s+[\w.()\s,]*\w\s*,\s*\w+\s*:"), "except with a comma"),
    (re.compile(r"^\s*raise\s+[\w.]+\s*,"), "raise with a comma"),
    (re.compile(r"^\s*exec\s+[\w'\"]"), "exec without parentheses"),
    (re.compile(r"^[^#'\"]*<>"), "<>"),
    (re.compile(r"^[^#'\"]*`[^`]+`"), "backquotes"),
    (re.compile(r"^[^#'\"]*(?<![\w.])0[0-7]+(?![\w.])"), "an octal number"),
    (re.compile(r"^[^#'\"]*(?<!\w)\d+[lL](?!\w)"), "a long integer"),
    (re.compile(r"^[^#'\"]*(?<!\w)[uU][rR]['\"]"), "a string literal of Python 2"),
    (re.compile(r"^\s*def\s+\w+\s*\([^)]*\([\w\s,]+\)\s*[,)=]"), "a tuple parameter"),
]


def _text(path: Path) -> str:
    """The text of a source file in its declared encoding."""
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise InputError("not a regular file", path)
        with tokenize.open(path) as file:
            return file.read()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from None
    except (SyntaxError, UnicodeDecodeError, LookupError) as error:
        raise InputError(f"cannot be decoded: {error}", path) from None


def folder_above(path: Path, dots: int) -> Path:
    """The folder that this many dots mean in an import of the file at ``path``."""
    return path.parents[min(dots, len(path.parents)) - 1]


def module_files(base: Path) -> Iterator[Path]:
    """The files of the module with the path ``base``: a folder, or a file without its suffix."""
    # The root folder has no name; the dots of a relative import may lead there.
    for path in (base / "__init__.py", base.parent / f"{base.name}.py"):
        if path.is_file():
            yield path


def parse(path: Path) -> tuple[str, ast.Module]:
    r"""The text of a source file, whose lines end with ``\n``, and its syntax tree.

    Raises:
        InputError: it is not a file, cannot be read or decoded, or is not Python 3, with the line.
    """
    source = _text(path)
    try:
        with warnings.catch_warnings():
            # TPC does not pass on Python's warnings about the user's texts (`"\d"`).
            warnings.simplefilter("ignore")
            return source, ast.parse(source, str(path))
    except SyntaxError as error:
        raise InputError(f"not Python 3: {_why(source, error)}", path, error.lineno) from None
    except (ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"cannot be parsed: {error}", path) from None


def _why(source: str, error: SyntaxError) -> str:
    said = error.msg or "it cannot be parsed"
    old = _python_2(source, error.lineno)
    return f"it looks like Python 2 ({old}) and needs Python 3" if old else said


def _python_2(source: str, lineno: int | None) -> str | None:
    """What is Python 2 on the faulty line, or else on the line before it."""
    lines = source.split("\n")
    number = lineno or 0
    for line in (lines[number - 1 : number], lines[max(number - 2, 0) : number - 1]):
        for pattern, name in _PYTHON_2:
            if line and pattern.search(line[0]):
                return name
    return None
