"""Finds the whole condition that a comparison is part of, as written in the source.

The static information has a comparison's line and column; libclang finds the condition, however
many lines it has, and the macro it comes from. The bindings are PyPI's ``clang``; the library is
that of Debian's clang-19, which also compiled the file.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from clang import cindex
from clang.cindex import Cursor, CursorKind, SourceLocation, TranslationUnit

_LIBRARIES = ("libclang-19.so.1", "/usr/lib/llvm-19/lib/libclang-19.so.1", "libclang-19.so")
_BLANK = re.compile(rb"(?:\s|\\\n|//[^\n]*|/\*.*?\*/)*", re.DOTALL)
_PREFIX = "".join(
    f"#if __has_include(<{header}>)\n#include <{header}>\n#endif\n"
    for header in ("ros/ros.h", "rclcpp/rclcpp.hpp")
)
_HEADS = {
    CursorKind.IF_STMT: "if",
    CursorKind.WHILE_STMT: "while",
    CursorKind.SWITCH_STMT: "switch",
    CursorKind.FOR_STMT: "for",
    CursorKind.DO_STMT: "do",
    CursorKind.CONDITIONAL_OPERATOR: "?:",
}
# Operators that join comparisons into a larger condition; a cast has no kind of its own.
_JOINING = frozenset(
    {
        CursorKind.BINARY_OPERATOR,
        CursorKind.UNARY_OPERATOR,
        CursorKind.PAREN_EXPR,
        CursorKind.UNEXPOSED_EXPR,
        CursorKind.MEMBER_REF_EXPR,
        CursorKind.ARRAY_SUBSCRIPT_EXPR,
    }
)
_OPERATORS = ("<", "<=", ">", ">=", "==", "!=", "&&", "||", "!")
_OWN_OPERATORS = frozenset(f"operator{sign}" for sign in _OPERATORS)
_BORDERS = frozenset({CursorKind.COMPOUND_STMT, CursorKind.LAMBDA_EXPR})


@dataclass(frozen=True, slots=True)
class Macro:
    """A macro that a condition is expanded from, with the text of its definition."""

    name: str
    file: str
    lineno: int
    text: str


@dataclass(frozen=True, slots=True)
class Condition:
    """A condition in a source file.

    ``kind`` is ``if``, ``while``, ``for``, ``do``, ``switch``, ``?:``, or ``expression`` where the
    outcome is kept or returned. Columns count bytes from 1, and ``end_column`` is behind the last.
    """

    kind: str
    text: str
    lineno: int
    column: int
    end_lineno: int
    end_column: int
    macro: Macro | None = None


@dataclass(frozen=True, slots=True)
class Parsed:
    """The conditions at the places asked for; None where none was found.

    ``included`` are the files that the answer depends on besides the file itself.
    """

    conditions: tuple[Condition | None, ...]
    included: tuple[str, ...]


@cache
def libclang() -> bool:
    """Whether libclang is on this machine; the first call loads it."""
    for name in _LIBRARIES:
        try:
            ctypes.CDLL(name)
        except OSError:
            continue
        cindex.Config.set_library_file(name)
        return True
    return False


def precompile(arguments: Sequence[str], target: Path) -> bool:
    """Precompile the headers that nearly every C++ file of a ROS package includes.

    Args:
        arguments: for clang; the files that ``target`` is used for must have the same.
        target: the file to be written, in a folder of its own.

    Returns:
        False if that is not possible.
    """
    header = str(target.with_suffix(".hpp"))
    as_header = ["c++-header" if argument == "c++" else argument for argument in arguments]
    options = TranslationUnit.PARSE_INCOMPLETE | TranslationUnit.PARSE_DETAILED_PROCESSING_RECORD
    try:
        unit = cindex.Index.create().parse(
            header, ["-w", *as_header], unsaved_files=[(header, _PREFIX)], options=options
        )
        unit.save(str(target))
    except (cindex.TranslationUnitLoadError, cindex.TranslationUnitSaveError):
        return False
    return True


def parse_conditions(
    file: str, data: bytes, arguments: Sequence[str], places: Iterable[tuple[int, int]]
) -> Parsed | None:
    """The conditions at ``places`` of one file, which is parsed once; it takes seconds.

    Args:
        file: absolute path.
        data: its content.
        arguments: for clang, see ``compile_flags``.
        places: lines and columns, both from 1.

    Returns:
        None where libclang cannot parse the file at all.
    """
    # Most of the time goes into ROS's headers. Their function bodies can be skipped only with a
    # precompiled preamble of this file, which takes longer than it saves (5 s where this takes 3);
    # ``precompile`` is for several files.
    options = TranslationUnit.PARSE_DETAILED_PROCESSING_RECORD
    try:
        # What is precompiled is not looked through for conditions.
        index = cindex.Index.create(excludeDecls=True)
        unit = index.parse(file, ["-w", *arguments], options=options)
    except cindex.TranslationUnitLoadError:
        return None
    source = _Source(file, data, unit)
    found = tuple(source.condition(line, column) for line, column in places)
    included = sorted({each.include.name for each in unit.get_includes()} - {file})
    return Parsed(found, tuple(included))


class _Source:
    """A parsed file and its bytes."""

    def __init__(self, file: str, data: bytes, unit: TranslationUnit) -> None:
        self._data = data
        self._unit = unit
        self._file = unit.get_file(file)
        self._top = [
            each
            for each in unit.cursor.get_children()
            if each.location.file is not None
            and each.location.file.name == file
            and each.kind not in (CursorKind.MACRO_DEFINITION, CursorKind.MACRO_INSTANTIATION)
        ]

    def condition(self, line: int, column: int) -> Condition | None:
        """The condition that the place is a part of."""
        place = SourceLocation.from_position(self._unit, self._file, line, column)
        way = self._way_to(place.offset)
        macro = self._macro(place)
        top: Cursor | None = None
        joined = True
        for index in range(len(way) - 1, -1, -1):
            node = way[index]
            child = way[index + 1] if index + 1 < len(way) else None
            if node.kind in _HEADS:
                within = self._condition_of(node, child, macro is not None)
                if within is not None:
                    return self._made(_HEADS[node.kind], within, macro)
                if node.kind != CursorKind.CONDITIONAL_OPERATOR:
                    break
                joined = False
            elif node.kind in _BORDERS:
                break
            elif node.kind.is_expression() and joined and (child is None or _joins(node, child)):
                top = node
            elif not node.kind.is_reference():
                joined = False
        return None if top is None else self._made("expression", top, macro)

    def _way_to(self, offset: int) -> list[Cursor]:
        """The cursors around a byte of the file, the outermost first."""
        way: list[Cursor] = []
        children: Iterable[Cursor] = self._top
        while True:
            around = [each for each in children if _covers(each, offset)]
            if not around:
                return way
            # A called operator's name also spans its operands.
            way.append(min(around, key=_length))
            children = way[-1].get_children()

    def _condition_of(self, node: Cursor, child: Cursor | None, in_macro: bool) -> Cursor | None:
        """``child``, if it is the condition of ``node``.

        Without a child the place is the keyword of the statement, whose condition is meant.
        """
        if child is None:
            children = node.get_children()
            return next((each for each in children if self._is_condition(node, each)), None)
        # Within a macro everything has one place, and the first child there is the condition.
        whole = in_macro and node.extent.start.offset == child.extent.start.offset
        return child if whole or self._is_condition(node, child) else None

    def _is_condition(self, node: Cursor, child: Cursor) -> bool:
        if node.kind == CursorKind.CONDITIONAL_OPERATOR:
            return bool(child == next(iter(node.get_children())))
        if node.kind == CursorKind.DO_STMT:
            return bool(child == list(node.get_children())[-1])
        if node.kind == CursorKind.FOR_STMT:
            return self._is_second_in_head(node, child)
        # A body ends before a semicolon or with a brace, an initialisation ends with its semicolon.
        blank = _BLANK.match(self._data, child.extent.end.offset)
        end = blank.end() if blank is not None else 0
        return self._data[end : end + 1] == b")"

    def _is_second_in_head(self, node: Cursor, child: Cursor) -> bool:
        """Whether ``child`` stands between the two semicolons of a ``for``."""
        extent = cindex.SourceRange.from_locations(node.extent.start, child.extent.start)
        depth = semicolons = 0
        for token in self._unit.get_tokens(extent=extent):
            if token.extent.start.offset >= child.extent.start.offset:
                break
            depth += {"(": 1, ")": -1}.get(token.spelling, 0)
            semicolons += token.spelling == ";" and depth == 1
            if depth == 0 and token.spelling == ")":
                return False
        return semicolons == 1

    def _macro(self, place: SourceLocation) -> Macro | None:
        cursor = Cursor.from_location(self._unit, place)
        definition = cursor.referenced if cursor.kind == CursorKind.MACRO_INSTANTIATION else None
        if definition is None or definition.location.file is None:
            return None
        start, end = definition.extent.start, definition.extent.end
        file = start.file.name
        data = self._data if file == self._file.name else _read(file)
        text = data[start.offset : end.offset].decode("utf-8", "replace")
        return Macro(cursor.spelling, file, start.line, f"#define {text}" if text else "")

    def _made(self, kind: str, cursor: Cursor, macro: Macro | None) -> Condition:
        start, end = cursor.extent.start, cursor.extent.end
        text = self._data[start.offset : end.offset].decode("utf-8", "replace")
        return Condition(kind, text, start.line, start.column, end.line, end.column, macro)


def _covers(cursor: Cursor, offset: int) -> bool:
    extent = cursor.extent
    return bool(extent.start.offset <= offset < extent.end.offset)


def _length(cursor: Cursor) -> int:
    return int(cursor.extent.end.offset - cursor.extent.start.offset)


def _joins(cursor: Cursor, part: Cursor) -> bool:
    """Whether ``part`` is meant as a part of ``cursor``."""
    if cursor.kind == CursorKind.CALL_EXPR:
        # Classes have operators of their own. Of a call whose function is pointed at the outcome
        # is meant; what std::min and its kind compare inside has the place of their call, too.
        called = next(iter(cursor.get_children()), None)
        return cursor.spelling in _OWN_OPERATORS or bool(part == called)
    return cursor.kind in _JOINING and cursor.spelling != "="


def _read(file: str) -> bytes:
    try:
        return Path(file).read_bytes()
    except OSError:
        return b""


def lines_of(condition: Condition) -> Iterator[str]:
    """The text a line at a time, without the indentation that all lines but the first have."""
    first, *rest = condition.text.expandtabs(4).split("\n")
    yield first.rstrip()
    indents = [len(line) - len(line.lstrip()) for line in rest if line.strip()]
    for line in rest:
        yield line[min(indents) :].rstrip() if indents else ""
