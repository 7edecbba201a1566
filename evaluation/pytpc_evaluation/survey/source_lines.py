"""Files and lines of code by language; what is a comment and what is code, pygments says."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from pygments.lexer import Lexer
from pygments.lexers import get_lexer_for_filename
from pygments.token import Comment, String
from pygments.util import ClassNotFound

from pytpc.workspace.packages import MANIFEST, PRODUCTS

CPP = "C++"
HEADER = "header"
PYTHON = "Python"
_SUFFIXES = {
    **dict.fromkeys((".cpp", ".cc", ".cxx", ".c++", ".cp", ".C", ".CPP", ".c"), CPP),
    **dict.fromkeys((".h", ".hpp", ".hh", ".hxx", ".h++", ".H"), HEADER),
    **dict.fromkeys((".ipp", ".tpp", ".txx", ".tcc", ".inl", ".icc"), HEADER),
    **dict.fromkeys((".py", ".pyw", ".pyi"), PYTHON),
}
# The name by which pygments is told what the text is.
_LEXED_AS = {CPP: "text.cpp", HEADER: "text.hpp", PYTHON: "text.py"}
_PYTHON_SCRIPT = re.compile(rb"#![^\n]*\bpython")
# A mesh or a recorded trajectory may be text of a language, too; nobody wrote it.
_LARGEST_OTHER = 1 << 20
_GENERATED = re.compile(
    r"\bdo not edit\b|auto-?generated|automatically generated|generated automatically"
    r"|\bis a generated file\b",
    re.IGNORECASE,
)
_FIRST_LINES = 15
_PRODUCT_MARKS = frozenset({"CMakeCache.txt", ".colcon_install_layout", ".built_by", ".catkin"})
_LEFT_OUT = frozenset({"__pycache__", "node_modules"})


@dataclass(frozen=True, slots=True)
class LineCount:
    """How many files of a language there are, and how many lines of code, comment and nothing."""

    files: int = 0
    code: int = 0
    comment: int = 0
    blank: int = 0

    def __add__(self, other: LineCount) -> LineCount:
        return LineCount(
            self.files + other.files,
            self.code + other.code,
            self.comment + other.comment,
            self.blank + other.blank,
        )


@dataclass(frozen=True, slots=True)
class SourceLines:
    """The counts of a folder by language, and how many files were left out for which reason."""

    languages: dict[str, LineCount]
    left_out: dict[str, int]

    def of(self, language: str) -> LineCount:
        """The count of a language, also of one that does not occur."""
        return self.languages.get(language, LineCount())


def source_files(folder: Path) -> Iterator[Path]:
    """The files of a source tree, sorted folder by folder, each file once.

    Symbolic links are followed. Left out are hidden files and folders, caches, and what is built:
    folders called build, install, log or devel beside packages (in a package they may have
    sources), and all with a file that CMake or colcon leaves in such folders.
    """
    seen: set[str] = set()
    in_package = {os.fspath(folder): False}
    for here, below, files in os.walk(folder, followlinks=True):
        real = os.path.realpath(here)
        inside = in_package.pop(here) or MANIFEST in files
        if real in seen or (Path(here) != folder and not _PRODUCT_MARKS.isdisjoint(files)):
            below.clear()
            continue
        seen.add(real)
        below[:] = sorted(name for name in below if _is_source_folder(Path(here, name), inside))
        in_package |= {os.path.join(here, name): inside for name in below}  # noqa: PTH118
        for name in sorted(files):
            path = Path(here, name)
            real = os.path.realpath(path)
            if name.startswith(".") or real in seen or not Path(real).is_file():
                continue
            seen.add(real)
            yield path


def count_lines(folder: Path, on_file: Callable[[Path], None] | None = None) -> SourceLines:
    """Count the lines of a source tree.

    C is counted as C++. Python is what is called so or says so in its first line. A file that is
    not UTF-8 is read as Latin-1. Files that say that they were generated are left out, as are
    binary files, those of no known language, and what cannot be read.

    Args:
        folder: the tree; see ``source_files``.
        on_file: called with each file before it is read.
    """
    languages: dict[str, LineCount] = {}
    left_out: Counter[str] = Counter()
    for path in source_files(folder):
        if on_file is not None:
            on_file(path)
        try:
            language, count = _count_file(path)
        except OSError:
            language, count = "unreadable", None
        if count is None:
            left_out[language] += 1
        else:
            languages[language] = languages.get(language, LineCount()) + count
    return SourceLines(dict(sorted(languages.items())), dict(sorted(left_out.items())))


def _is_source_folder(folder: Path, in_package: bool) -> bool:
    if folder.name.startswith(".") or folder.name in _LEFT_OUT:
        return False
    return in_package or folder.name not in PRODUCTS or (folder / MANIFEST).is_file()


def _count_file(path: Path) -> tuple[str, LineCount | None]:
    """The language and the count; or why there is no count, and None."""
    language = _SUFFIXES.get(path.suffix)
    if language is None:
        with path.open("rb") as stream:
            start = stream.read(256)
        if _PYTHON_SCRIPT.match(start):
            language = PYTHON
        elif path.stat().st_size > _LARGEST_OTHER:
            return "large", None
    raw = path.read_bytes()
    if b"\0" in raw:
        return "binary", None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    if language is not None:
        lexer = _lexer(_LEXED_AS[language])
    else:
        lexer = _lexer(path.name)
        if lexer is None or lexer.name == "Text only":
            return "unknown", None
        language = str(lexer.name)
    if _GENERATED.search("\n".join(text.splitlines()[:_FIRST_LINES])):
        return "generated", None
    return language, _count_text(text, lexer)


def _count_text(text: str, lexer: Lexer | None) -> LineCount:
    """A line with code and a comment is code; a bracket alone is code; docstrings are comments."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    if not lines[-1]:
        lines.pop()
    code: set[int] = set()
    number = 0
    for kind, piece in lexer.get_tokens("\n".join([*lines, ""])) if lexer is not None else ():
        parts = piece.split("\n")
        if not _is_comment(kind):
            code.update(number + at for at, part in enumerate(parts) if part.strip())
        number += len(parts) - 1
    blank = sum(not line.strip() for line in lines)
    return LineCount(1, len(code), len(lines) - blank - len(code), blank)


def _is_comment(kind: object) -> bool:
    if kind in Comment.Preproc or kind in Comment.PreprocFile:
        return False
    return kind in Comment or kind in String.Doc


@cache
def _lexer(name: str) -> Lexer | None:
    # What is in front of the first line stays, so that the lines have their numbers.
    try:
        return get_lexer_for_filename(name, stripnl=False, ensurenl=False)
    except ClassNotFound:
        return None
