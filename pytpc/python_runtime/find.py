"""Finds the comparisons of the static information in a module's syntax tree.

A comparison is identified by its relation and by the line and column of its first character.
Columns count bytes from 1 (in `ast` from 0). Each link of a chain is identified by its left
operand. A flag is identified by its own position; where several expressions begin there, it is the
whole condition or the whole operand of ``and``, ``or`` and ``not``.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING, NamedTuple

from pytpc.python_runtime.listed import Listed, ListedFile

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    Position = tuple[int, int]

RELATIONS = {
    "Lt": "<",
    "LtE": "<=",
    "Gt": ">",
    "GtE": ">=",
    "Eq": "==",
    "Is": "==",
    "In": "==",
    "NotEq": "!=",
    "IsNot": "!=",
    "NotIn": "!=",
}
_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}


class ListedPlace(NamedTuple):
    """A listed comparison in the tree. ``swapped``: its threshold is the left operand."""

    listed: Listed
    swapped: bool


class FoundPlaces(NamedTuple):
    """What to rewrite.

    ``links``: comparison -> number of the link -> what it reports. ``flags``: expression -> what it
    reports. ``loops``: the iterated expression of a ``for`` -> what it reports. ``subjects``: the
    subject of a ``match`` -> what it reports. ``patterns``: a value in a ``case`` -> what it
    reports. ``calls``: a call of a function that compares inside -> what it reports. ``missing``:
    comparisons that are not in the tree; ``unsupported``: those that are there and cannot report.
    """

    links: dict[ast.Compare, dict[int, list[ListedPlace]]]
    flags: dict[ast.expr, list[ListedPlace]]
    loops: dict[ast.expr, list[ListedPlace]]
    subjects: dict[ast.expr, list[ListedPlace]]
    patterns: dict[ast.expr, list[ListedPlace]]
    calls: dict[ast.expr, list[ListedPlace]]
    unsupported: list[Listed]
    missing: list[Listed]

    def total(self) -> int:
        """How many listed comparisons were found."""
        links = sum(len(places) for link in self.links.values() for places in link.values())
        # A conditional expression is one flag in two places.
        flags = len({place for places in self.flags.values() for place in places})
        others = (self.loops, self.subjects, self.patterns, self.calls)
        return links + flags + sum(len(places) for kind in others for places in kind.values())


def find(tree: ast.Module, listed: Sequence[Listed]) -> FoundPlaces:
    """Find the places of ``listed`` in ``tree``."""
    index = _Index(tree)
    found = FoundPlaces({}, {}, {}, {}, {}, {}, [], [])
    for one in listed:
        ways = [_as_call] if one.is_inside else [_as_link, _as_pattern, _as_loop, _as_flag]
        if not any(way(index, found, one) for way in ways):
            found.missing.append(one)
    return found


def matching(candidates: Sequence[ListedFile], text: str) -> ListedFile | None:
    """The candidate that has the most lines in common with ``text``.

    A copy, such as an installed file, has the same lines at the same places. At least half of them
    must be the same: a slightly changed file is still the same file, and another file of that name
    is not.
    """
    # Not `splitlines`: in Python a form feed does not end a line.
    lines = re.split("\r\n|\r|\n", text)

    def is_same(listed: Listed) -> bool:
        inside = 0 < listed.lineno <= len(lines)
        return inside and lines[listed.lineno - 1].strip() == listed.source_code

    best: ListedFile | None = None
    most = 0
    for candidate in candidates:
        known = [one for one in candidate.comparisons if one.source_code is not None]
        same = sum(1 for one in known if is_same(one))
        if 2 * same >= len(known) and same > most:
            best, most = candidate, same
    return best


class _Index:
    """The nodes of a tree by where they begin."""

    def __init__(self, tree: ast.Module) -> None:
        self.links: dict[Position, list[tuple[ast.Compare, int]]] = {}
        self.operands: dict[Position, list[ast.expr]] = {}
        self.loops: dict[Position, list[ast.expr]] = {}
        self.subjects: dict[Position, list[ast.expr]] = {}
        self.patterns: dict[Position, list[ast.expr]] = {}
        self.inner_patterns: set[Position] = set()
        self.names: dict[Position, list[ast.expr]] = {}
        for node in ast.walk(tree):
            self._add(node)

    def _add(self, node: ast.AST) -> None:
        if isinstance(node, ast.Compare):
            for link, left in enumerate([node.left, *node.comparators[:-1]]):
                for position in {_position(node if link == 0 else left), _position(left)}:
                    self.links.setdefault(position, []).append((node, link))
        for condition in conditions_of(node):
            for operand in operands_of(condition):
                self.operands.setdefault(_position(operand), []).append(operand)
        if isinstance(node, (ast.For, ast.AsyncFor, ast.comprehension)):
            self.loops.setdefault(_position(node.iter), []).append(node.iter)
            self.loops.setdefault(_position(node.target), []).append(node.iter)
        if type(node).__name__ == "Match":
            subject: ast.expr = node.subject  # type: ignore[attr-defined]
            self.subjects.setdefault(_position(subject), []).append(subject)
        if type(node).__name__ == "match_case":
            for value in values_of(node.pattern):  # type: ignore[attr-defined]
                self.patterns.setdefault(_position(value), []).append(value)
        if type(node).__name__ == "MatchValue":
            self.inner_patterns.add(_position(node.value))  # type: ignore[attr-defined]
        if isinstance(node, (ast.Name, ast.Attribute, ast.Subscript, ast.Call)):
            is_read = isinstance(getattr(node, "ctx", ast.Load()), ast.Load)
            if is_read:
                self.names.setdefault(_position(node), []).append(node)


def values_of(pattern: ast.AST) -> list[ast.expr]:
    """The values of a pattern that is just a value, or several with ``|`` between them."""
    if type(pattern).__name__ == "MatchValue":
        return [pattern.value]  # type: ignore[attr-defined]
    if type(pattern).__name__ == "MatchOr":
        parts = [values_of(part) for part in pattern.patterns]  # type: ignore[attr-defined]
        return [value for part in parts for value in part] if all(parts) else []
    return []


def _position(node: ast.expr) -> Position:
    return node.lineno, node.col_offset + 1


def conditions_of(node: ast.AST) -> Iterator[ast.expr]:
    """The expressions whose truth ``node`` tests."""
    if isinstance(node, (ast.If, ast.While, ast.IfExp, ast.Assert)):
        yield node.test
    elif isinstance(node, ast.BoolOp):
        yield from node.values
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield node.operand
    elif isinstance(node, ast.comprehension):
        yield from node.ifs
    elif type(node).__name__ == "match_case" and node.guard is not None:  # type: ignore[attr-defined]
        yield node.guard  # type: ignore[attr-defined]


def operands_of(condition: ast.expr) -> Iterator[ast.expr]:
    """The parts of a condition that are predicates of their own."""
    if isinstance(condition, ast.BoolOp):
        for value in condition.values:
            yield from operands_of(value)
    elif isinstance(condition, ast.UnaryOp) and isinstance(condition.op, ast.Not):
        yield from operands_of(condition.operand)
    elif isinstance(condition, ast.NamedExpr):
        yield condition
        yield from operands_of(condition.value)
    elif not isinstance(condition, ast.Compare):
        yield condition


def _ends(node: ast.expr, listed: Listed) -> bool:
    """Whether ``node`` ends where the static information says; true where it says nothing."""
    if listed.end_lineno is None or listed.end_column is None:
        return True
    return (node.end_lineno, (node.end_col_offset or 0) + 1) == (
        listed.end_lineno,
        listed.end_column,
    )


def _as_link(index: _Index, found: FoundPlaces, listed: Listed) -> bool:
    if listed.relation == "flag":
        return False
    candidates: list[tuple[bool, bool, int, ast.Compare, int]] = []
    for node, link in index.links.get((listed.lineno, listed.column), []):
        relation = RELATIONS[type(node.ops[link]).__name__]
        if listed.relation not in (relation, _MIRRORED[relation]):
            continue
        is_own = link > 0 or _position(node) == (listed.lineno, listed.column)
        ends = _ends(node.comparators[link], listed) or _ends(node, listed)
        candidates.append((not ends, not is_own, len(candidates), node, link))
    if not candidates:
        return False
    _, _, _, node, link = min(candidates, key=lambda candidate: candidate[:3])
    place = ListedPlace(listed, _is_swapped(node, link, listed))
    found.links.setdefault(node, {}).setdefault(link, []).append(place)
    return True


def _is_swapped(node: ast.Compare, link: int, listed: Listed) -> bool:
    """Whether the threshold is the left operand. Relations are listed with it on the right."""
    if listed.operand is not None:
        return listed.operand == "left"
    relation = RELATIONS[type(node.ops[link]).__name__]
    if relation not in ("==", "!="):
        return listed.relation != relation
    left = [node.left, *node.comparators][link]
    right = node.comparators[link]
    if listed.name is not None:
        texts = [_text(left), _text(right)]
        for test in (str.__eq__, str.endswith):
            is_left, is_right = (test(text, listed.name) for text in texts)
            if is_left != is_right:
                return is_left
    return isinstance(right, ast.Constant) and not isinstance(left, ast.Constant)


def _text(node: ast.expr) -> str:
    """``self.limit`` as it is written in the source; empty for anything but a name."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return f"{_text(node.value)}.{node.attr}"
    if isinstance(node, ast.Subscript):
        inner = node.slice
        # Before Python 3.9 the index has a node of its own.
        inner = getattr(inner, "value", inner) if type(inner).__name__ == "Index" else inner
        if isinstance(inner, ast.Constant):
            return f"{_text(node.value)}[{inner.value!r}]"
    return ""


def _as_call(index: _Index, found: FoundPlaces, listed: Listed) -> bool:
    for node in index.names.get((listed.lineno, listed.column), []):
        # The analysis lists no calls with `**`.
        is_call = isinstance(node, ast.Call) and all(each.arg for each in node.keywords)
        if is_call and _ends(node, listed):
            found.calls.setdefault(node, []).append(ListedPlace(listed, False))
            return True
    return False


def _as_pattern(index: _Index, found: FoundPlaces, listed: Listed) -> bool:
    position = (listed.lineno, listed.column)
    patterns = index.patterns.get(position, [])
    if patterns:
        found.patterns.setdefault(patterns[0], []).append(ListedPlace(listed, False))
    elif position in index.inner_patterns:
        found.unsupported.append(listed)
    return bool(patterns) or position in index.inner_patterns


def _as_loop(index: _Index, found: FoundPlaces, listed: Listed) -> bool:
    loops = index.loops.get((listed.lineno, listed.column), [])
    if not loops or listed.relation == "flag":
        return False
    found.loops.setdefault(loops[0], []).append(ListedPlace(listed, False))
    return True


def _as_flag(index: _Index, found: FoundPlaces, listed: Listed) -> bool:
    position = (listed.lineno, listed.column)
    subjects = [node for node in index.subjects.get(position, []) if _ends(node, listed)]
    if subjects:
        found.subjects.setdefault(subjects[0], []).append(ListedPlace(listed, False))
        return True
    operands = index.operands.get(position, [])
    if not operands and listed.relation == "flag":
        operands = index.names.get(position, [])
    if not operands:
        return False
    exact = [node for node in operands if _ends(node, listed)]
    chosen = max(
        exact or operands, key=lambda node: (node.end_lineno or 0, node.end_col_offset or 0)
    )
    values = flags_of(chosen)
    for value in values:
        found.flags.setdefault(value, []).append(ListedPlace(listed, False))
    if not values:
        found.unsupported.append(listed)
    return True


def flags_of(condition: ast.expr) -> list[ast.expr]:
    """The expressions between which a conditional expression chooses, else the condition itself.

    Choices that are conditions themselves are left out: the program tests the truth of their parts,
    and a report would test it a second time.
    """
    if isinstance(condition, ast.IfExp):
        return [*flags_of(condition.body), *flags_of(condition.orelse)]
    is_not = isinstance(condition, ast.UnaryOp) and isinstance(condition.op, ast.Not)
    return [] if is_not or isinstance(condition, (ast.BoolOp, ast.Compare)) else [condition]
