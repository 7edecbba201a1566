"""Where comparisons stand in Python source, as the lists of examples/python_nodes say it.

Lines and columns count from 1, columns in bytes of UTF-8. A comparison begins where CPython says
that it does, with the parentheses around its left operand; in a chain ``a < b < c`` the second one
begins at ``b``.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

OPERATORS = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.In: "in",
    ast.NotIn: "not in",
    ast.Is: "is",
    ast.IsNot: "is not",
}

Place = tuple[int, int]


def text_between(source: str, first: ast.expr, last: ast.expr) -> str:
    """The source from the beginning of one expression to the end of another."""
    assert last.end_lineno is not None
    assert last.end_col_offset is not None
    lines = [line.encode() for line in source.splitlines(keepends=True)]
    taken = lines[first.lineno - 1 : last.end_lineno]
    taken[-1] = taken[-1][: last.end_col_offset]
    taken[0] = taken[0][first.col_offset :]
    return b"".join(taken).decode()


def place_of(node: ast.expr) -> Place:
    """Line and column of an expression's first character."""
    return node.lineno, node.col_offset + 1


def links(source: str, node: ast.Compare) -> Iterator[tuple[Place, str]]:
    """Place and text of each comparison of a chain; one where it is no chain."""
    operands = [node.left, *node.comparators]
    for at in range(len(node.ops)):
        first = node if at == 0 else operands[at]
        last = node if at == len(node.ops) - 1 else operands[at + 1]
        yield place_of(first), text_between(source, first, last)


def comparisons(source: str) -> Iterator[tuple[Place, str, str]]:
    """Place, text and operator of every comparison of a module."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Compare):
            for (place, text), operator in zip(links(source, node), node.ops, strict=True):
                yield place, text, OPERATORS[type(operator)]


def values(source: str) -> set[tuple[Place, str]]:
    """Place and text of every expression that may be a flag, a bound or a value pattern."""
    return {
        (place_of(node), text_between(source, node, node))
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Name | ast.Attribute | ast.Subscript | ast.Call)
    }
