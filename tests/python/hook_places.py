"""The places of a program that static information may list; for Python 3.8 and newer."""

from __future__ import annotations

import ast

from pytpc.python_runtime.find import RELATIONS, conditions_of, flags_of, operands_of, values_of
from pytpc.python_runtime.listed import Listed

# Name of a function that compares inside -> what is compared with its threshold.
_INSIDE = {
    "min": [(">", "choice 2")],
    "max": [(">", "choice 1"), ("<", "choice 2")],
    "minimum": [("<", "choice 1")],
    "clip": [("<", "choice 2 of 1"), (">", "choice 3 of 1")],
    "isclose": [("==", "argument 2"), ("<=", "within abs_tol")],
    "lt": [("<", "argument 2")],
    "ge": [("<=", "argument 1")],
    "is_not": [("!=", "argument 2")],
    "less": [("<", "argument 2")],
}


def comparisons(tree):
    """All links of all comparisons of a module."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            for link, left in enumerate([node.left, *node.comparators[:-1]]):
                relation = RELATIONS[type(node.ops[link]).__name__]
                place = node if link == 0 else left
                found.append(_listed(relation, place, node.comparators[link], "right", link))
    return found


def others(tree):
    """All flags, loops over ranges, values of patterns, and calls that compare inside."""
    found = []
    for node in ast.walk(tree):
        flags = [part for condition in conditions_of(node) for part in operands_of(condition)]
        kind = type(node).__name__
        if kind == "Match":
            flags.append(node.subject)
        # The compiler asks no constant, nor does the analysis list one.
        found += [
            _listed("flag", flag, flag, None, "flag")
            for flag in flags
            if flags_of(flag) and not isinstance(flag, ast.Constant)
        ]
        if kind in ("For", "AsyncFor", "comprehension") and _called(node.iter) == "range":
            found.append(_listed("<", node.iter, node.iter, None, "loop"))
        if kind == "match_case":
            values = values_of(node.pattern)
            found += [_listed("==", value, value, "right", "pattern") for value in values]
        if kind == "Call" and not _unpacks(node):
            for relation, operand in _INSIDE.get(_called(node), ()):
                found.append(_listed(relation, node, node, operand, operand))
    # An operand of `and` within `not` is one of both.
    return list({one.key: one for one in found}.values())


def _unpacks(call):
    """Whether ``*`` or ``**`` is among the arguments; the analysis lists no such call."""
    is_starred = any(isinstance(argument, ast.Starred) for argument in call.args)
    return is_starred or any(keyword.arg is None for keyword in call.keywords)


def _called(node):
    """The last name of the called function; empty for other calls."""
    function = getattr(node, "func", None)
    return getattr(function, "attr", getattr(function, "id", ""))


def _listed(relation, begin, end, operand, what):
    end_column = (end.end_col_offset or 0) + 1
    key = f"{begin.lineno}:{begin.col_offset + 1}:{end.end_lineno}:{end_column}:{what}"
    return Listed(
        key=key,
        relation=relation,
        lineno=begin.lineno,
        column=begin.col_offset + 1,
        end_lineno=end.end_lineno,
        end_column=end_column,
        name=None,
        operand=operand,
        source_code=None,
    )
