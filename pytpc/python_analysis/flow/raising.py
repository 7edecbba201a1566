"""Calls of functions that raise: where the exception may go.

A call through which a ``raise`` of the sources may come ends its block. Its further successors are
the handlers that may catch the exception, and the function's exit.
"""

from __future__ import annotations

from pytpc.python_analysis.ir.exceptions import taken_by
from pytpc.python_analysis.ir.instructions import Block, Function, Instr
from pytpc.python_analysis.points_to.points_to import PointsTo

Name = str | None
"""The name of an exception's class; None where it is unknown."""
Leaving = dict[Function, dict[Instr, None]]
"""A function -> the ``raise`` statements and calls by which exceptions leave it."""


def add_raising_calls(points: PointsTo) -> Leaving:
    """Find the calls that raise, and split their blocks behind them."""
    leaving: Leaving = {}
    names: dict[Function, dict[Name, None]] = {}
    calls = [
        (call, list(called))
        for call, called in points.calls.callees.items()
        if call.op in ("call", "attr", "setattr")
    ]
    for function in points.program.functions:
        for instr in function.instructions():
            if instr.op == "raise":
                name = instr.data if isinstance(instr.data, str) else None
                _leave(instr, [name], names, leaving)
    changed = True
    while changed:
        changed = False
        for call, called in calls:
            raised = [name for each in called for name in names.get(each, ())]
            changed |= _leave(call, raised, names, leaving)
    for call, called in calls:
        raised = [name for each in called for name in names.get(each, ())]
        if raised:
            _split(call, raised)
    return leaving


def _leave(
    instr: Instr, raised: list[Name], names: dict[Function, dict[Name, None]], leaving: Leaving
) -> bool:
    known = names.setdefault(instr.function, {})
    before = len(known)
    for name in raised:
        if taken_by(instr.block.handlers, name)[1]:
            known[name] = None
            leaving.setdefault(instr.function, {})[instr] = None
    return len(known) != before


def _split(call: Instr, raised: list[Name]) -> None:
    first = call.block
    function = first.function
    if function.exit is None:
        return
    place = first.instrs.index(call) + 1
    rest = Block(function, 0, first.instrs[place:], first.successors, first.handlers)
    for instr in rest.instrs:
        instr.block = rest
    del first.instrs[place:]
    first.successors = [rest]
    for name in raised:
        taken, through = taken_by(first.handlers, name)
        ways = [handler.block for handler in taken] + ([function.exit] if through else [])
        first.successors += [way for way in ways if way not in first.successors]
    function.blocks.insert(function.blocks.index(first) + 1, rest)
    for number, block in enumerate(function.blocks):
        block.number = number
