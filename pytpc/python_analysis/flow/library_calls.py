"""Comparisons inside library functions: ``min``, ``operator.gt``, ``math.isclose``, ``numpy.clip``.

As for ``std::min`` in C++ (passes/Idioms), the place of the comparison is the call, and ``min(a,
b)`` compares ``b < a``. A comparison that chooses one of its arguments is its own predicate, like a
conditional expression.
"""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.python_analysis.flow.value_flow import Flow
from pytpc.python_analysis.ir.instructions import Instr, Shape
from pytpc.python_analysis.rules_file import LibraryComparison

INSIDE = -3
"""In place of an operand: the argument 0; -4 is argument 1, and so on."""
TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


@dataclass(frozen=True)
class Inside:
    """A comparison of one argument, the threshold, with ``others``.

    ``relation`` has the threshold on the right-hand side. ``chooses``: the function returns one of
    its arguments; else it returns the outcome. ``operand`` as in docs/reference/formats.md.
    """

    relation: str
    others: tuple[Instr, ...]
    chooses: bool
    operand: str


def compared_inside(flow: Flow, call: Instr) -> dict[int, Inside]:
    """The comparisons inside the function that ``call`` calls: argument's number -> comparison.

    There are none where several functions may be called, where arguments are unpacked or bound
    before, and where ``min`` and ``max`` get a ``key`` or one iterable.
    """
    row = _row(flow, call)
    shape = call.data
    if row is None or not isinstance(shape, Shape) or {"*", "**", "key"} & {*shape.names}:
        return {}
    args = call.args[1:]
    names = {name: place for place, name in enumerate(shape.names) if name is not None}
    count = len(args) - len(names)
    if row.relation is not None:
        return _outcome(row.relation, row.within, args, names) if count >= 2 else {}
    if row.chooses == "clip":
        return _clip(args, names, count)
    smallest = row.chooses == "smallest"
    return {
        # `min` and `max` return the first argument unless another is beyond it.
        place: Inside(
            "<" if smallest == (place == 0) else ">",
            tuple(arg for other, arg in enumerate(args[:count]) if other != place),
            True,
            f"choice {place + 1}",
        )
        for place in range(count if count > 1 else 0)
    }


def choosing_calls(flow: Flow) -> set[Instr]:
    """The calls that choose one of their arguments by comparing."""
    rows = flow.points.rules.comparisons
    return {
        call
        for call, paths in flow.points.calls.outside.items()
        if any(path in rows and rows[path].chooses for path, _ in paths)
        and compared_inside(flow, call)
    }


def _row(flow: Flow, call: Instr) -> LibraryComparison | None:
    calls = flow.points.calls
    paths = {path for path, _ in calls.outside.get(call, ())}
    if len(paths) != 1 or call in calls.callees:
        return None
    if any(found.kind != "external" for found in flow.points.of(call.args[0])):
        return None
    return flow.points.rules.comparisons.get(paths.pop())


def _outcome(
    relation: str, within: str | None, args: tuple[Instr, ...], names: dict[str, int]
) -> dict[int, Inside]:
    left, right = args[:2]
    found = {
        0: Inside(TURNED.get(relation, relation), (right,), False, "argument 1"),
        1: Inside(relation, (left,), False, "argument 2"),
    }
    if within is not None and within in names:
        found[names[within]] = Inside("<=", (left, right), False, f"within {within}")
    return found


def _clip(args: tuple[Instr, ...], names: dict[str, int], count: int) -> dict[int, Inside]:
    found = {}
    for place, name, relation in ((1, "a_min", "<"), (2, "a_max", ">")):
        at = place if count > place else names.get(name)
        if at is not None and count > 0:
            operand = f"choice {place + 1 if count > place else name} of 1"
            found[at] = Inside(relation, args[:1], True, operand)
    return found
