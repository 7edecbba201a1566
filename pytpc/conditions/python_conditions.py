"""Finds the whole condition that a comparison in Python is part of, in the syntax tree.

The analysis gives the begin and end of a comparison. For a link of a chain they enclose both
operands, for a loop's limit the call of ``range``.
"""

from __future__ import annotations

import ast
import re
import tokenize
from io import BytesIO

from pytpc.conditions.cpp_conditions import Condition

# Line and column of the begin and of the byte behind the end, from 1; columns count bytes in UTF-8.
# The end is None if it is not known.
Span = tuple[int, int, int | None, int | None]

_LINE_END = re.compile(r"\r\n|\r|\n")
_HEADS: tuple[tuple[type[ast.AST], str, str], ...] = (
    (ast.If, "test", "if"),
    (ast.While, "test", "while"),
    (ast.Assert, "test", "assert"),
    (ast.IfExp, "test", "conditional expression"),
    (ast.comprehension, "ifs", "if"),
    (ast.match_case, "guard", "if"),
    (ast.match_case, "pattern", "case"),
    (ast.Match, "subject", "match"),
    (ast.For, "iter", "for"),
    (ast.AsyncFor, "iter", "for"),
    (ast.comprehension, "iter", "for"),
)
# Nodes that join comparisons into a larger condition.
_JOINING = (
    ast.BoolOp, ast.UnaryOp, ast.BinOp, ast.Compare, ast.NamedExpr, ast.MatchValue, ast.MatchOr,
)  # fmt: skip


class PythonSource:
    """A Python file, parsed once."""

    def __init__(self, data: bytes) -> None:
        """Parse the bytes of a file.

        Raises:
            ValueError: it is no Python 3.
        """
        try:
            encoding, _ = tokenize.detect_encoding(BytesIO(data).readline)
            text = data.decode(encoding)
            tree = ast.parse(text)
        except (SyntaxError, ValueError, LookupError, RecursionError, MemoryError) as error:
            raise ValueError(f"no Python 3: {error}") from error
        self.lines = _LINE_END.split(text)
        self._parents: dict[ast.AST, ast.AST] = {}
        self._begun: dict[tuple[int, int], ast.expr] = {}
        for node in ast.walk(tree):
            for child in ast.iter_child_nodes(node):
                self._parents[child] = node
                if isinstance(child, ast.expr):
                    # Any of several that begin here will do: the others are around it, or in it.
                    self._begun.setdefault((child.lineno, child.col_offset + 1), child)

    def condition(self, span: Span) -> Condition | None:
        """The condition that the comparison at ``span`` is a part of; None where there is none."""
        found: ast.AST | None = self._begun.get(span[:2])
        while found is not None and not _covers(found, span):
            found = self._parents.get(found)
        if not isinstance(found, ast.expr):
            return None
        top: ast.expr | ast.pattern = found
        while True:
            parent = self._parents[top]
            kind = _head(parent, top)
            if kind is not None or not isinstance(parent, _JOINING):
                return self._made(kind or "expression", top)
            top = parent

    def _made(self, kind: str, node: ast.expr | ast.pattern) -> Condition:
        end_lineno, end_offset = node.end_lineno or node.lineno, node.end_col_offset or 0
        lines = [line.encode() for line in self.lines[node.lineno - 1 : end_lineno]]
        lines[-1] = lines[-1][:end_offset]
        lines[0] = lines[0][node.col_offset :]
        return Condition(
            kind=kind,
            text=b"\n".join(lines).decode("utf-8", "replace"),
            lineno=node.lineno,
            column=node.col_offset + 1,
            end_lineno=end_lineno,
            end_column=end_offset + 1,
        )


def _covers(node: ast.AST, span: Span) -> bool:
    if not isinstance(node, ast.expr):
        # A statement: no expression has this end.
        return True
    if span[2] is None or span[3] is None:
        return True
    end = (node.end_lineno or 0, (node.end_col_offset or 0) + 1)
    return end >= (span[2], span[3])


def _head(parent: ast.AST, child: ast.AST) -> str | None:
    """The kind of ``parent``, if ``child`` is its condition."""
    for kind, field, name in _HEADS:
        if isinstance(parent, kind):
            value = getattr(parent, field)
            if value is child or (isinstance(value, list) and child in value):
                return name
    return None
