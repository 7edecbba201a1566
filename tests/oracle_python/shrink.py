"""Makes a program smaller, statement by statement, as long as it keeps what is wrong with it."""

from __future__ import annotations

import ast
import copy
import time
from collections.abc import Callable, Iterator, Mapping

_BODIES = ("body", "orelse", "finalbody", "handlers", "cases")


def shrink(
    modules: Mapping[str, str], is_wrong: Callable[[dict[str, str]], bool], seconds: float
) -> dict[str, str]:
    """A smaller program for which ``is_wrong`` holds; after ``seconds`` what there is then."""
    end = time.monotonic() + seconds
    current = dict(modules)
    again = True
    while again:
        again = False
        for name in current:
            at, size = 0, 16
            while time.monotonic() < end:
                source = _without(current[name], at, size)
                if source is None and size == 1:
                    break
                if source is None:
                    at, size = 0, size // 2
                    continue
                smaller = {**current, name: source}
                if source != current[name] and _holds(smaller, is_wrong):
                    current, again = smaller, True
                else:
                    at += size
    return current


def _holds(modules: dict[str, str], is_wrong: Callable[[dict[str, str]], bool]) -> bool:
    try:
        return is_wrong(modules)
    except (SyntaxError, AssertionError, NameError):
        return False


def _without(source: str, at: int, size: int) -> str | None:
    """The change number ``at``: statements are left out, or the body of one takes its place."""
    tree = ast.parse(source)
    places = list(_places(tree))
    if at >= len(places) + (len(places) if size == 1 else 0):
        return None
    body, index = places[at % len(places)]
    if at < len(places):
        body[index : index + size] = []
    else:
        inner = getattr(body[index], "body", None)
        if not isinstance(inner, list) or isinstance(body[index], ast.FunctionDef | ast.ClassDef):
            return source
        body[index : index + 1] = copy.deepcopy(inner)
    for node in ast.walk(tree):
        if getattr(node, "body", None) == []:
            node.body = [ast.Pass()]  # type: ignore[attr-defined]
    try:
        return ast.unparse(ast.fix_missing_locations(tree)) + "\n"
    except (AttributeError, ValueError):
        return source


def _places(tree: ast.AST) -> Iterator[tuple[list[ast.AST], int]]:
    for node in ast.walk(tree):
        for name in _BODIES:
            body = getattr(node, name, None)
            if isinstance(body, list):
                for index in range(len(body)):
                    yield body, index
