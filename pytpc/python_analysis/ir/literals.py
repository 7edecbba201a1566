"""Constants in the source: loops over them are unrolled."""

from __future__ import annotations

import ast
from collections import Counter
from functools import lru_cache

from pytpc.python_analysis.ir.instructions import Module

_CONTAINERS = (ast.Tuple, ast.List, ast.Set, ast.Dict)


def known_elements(
    target: ast.expr, source: ast.expr, module: Module, at_most: int
) -> list[dict[str, object]] | None:
    """The values of the names in a loop's target, in each iteration.

    Args:
        target: a name, or a tuple of names.
        source: what the loop iterates over: a literal, a module's name for one, or ``.items()``,
            ``.keys()``, ``.values()``, ``sorted()``, ``list()``, ``enumerate()`` of one.
        module: the module of both.
        at_most: a loop over more elements is not unrolled.

    Returns:
        One dict from name to constant for each element; None where not all are constants.
    """
    elements = _elements(source, module)
    if elements is None or not 0 < len(elements) <= at_most:
        return None
    rounds = [_bound(target, element) for element in elements]
    return [each for each in rounds if each is not None] if None not in rounds else None


def _bound(target: ast.expr, value: object) -> dict[str, object] | None:
    if isinstance(target, ast.Name):
        return {target.id: value} if not isinstance(value, (tuple, list, dict, set)) else None
    if not isinstance(target, ast.Tuple | ast.List) or not isinstance(value, (tuple, list)):
        return None
    if len(target.elts) != len(value):
        return None
    names: dict[str, object] = {}
    for part, element in zip(target.elts, value, strict=True):
        bound = _bound(part, element)
        if bound is None:
            return None
        names.update(bound)
    return names


def _elements(source: ast.expr, module: Module) -> list[object] | None:
    match source:
        case ast.Call(func=ast.Attribute(value=inner, attr=attr), args=[], keywords=[]):
            table = _literal(inner, module)
            if not isinstance(table, dict):
                return None
            ways = {"items": table.items, "keys": table.keys, "values": table.values}
            return list(ways[attr]()) if attr in ways else None
        case ast.Call(func=ast.Name(id="sorted" | "list" | "tuple"), args=[inner], keywords=[]):
            return _elements(inner, module)
        case ast.Call(func=ast.Name(id="enumerate"), args=[inner], keywords=[]):
            elements = _elements(inner, module)
            return None if elements is None else list(enumerate(elements))
        case _:
            value = _literal(source, module)
            return list(value) if isinstance(value, (tuple, list, dict)) else None


def _literal(node: ast.expr, module: Module) -> object:
    if isinstance(node, ast.Name):
        return _module_constants(module).get(node.id)
    if not isinstance(node, _CONTAINERS):
        return None
    try:
        return ast.literal_eval(node)
    except (ValueError, TypeError, SyntaxError, RecursionError):
        return None


@lru_cache(maxsize=256)
def _module_constants(module: Module) -> dict[str, object]:
    """The names of the module that are bound once, to a literal container."""
    stored = Counter(
        node.id
        for node in ast.walk(module.tree)
        if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load)
    )
    found: dict[str, object] = {}
    for statement in module.tree.body:
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if isinstance(
                value, _CONTAINERS
            ):
                if stored[name] == 1:
                    found[name] = _literal(value, module)
            case _:
                pass
    return found
