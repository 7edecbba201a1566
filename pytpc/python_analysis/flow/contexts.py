"""The calls by which a value came into a function: by the same it goes out again."""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.python_analysis.flow.value_flow import Flow
from pytpc.python_analysis.ir.instructions import Instr

Stack = tuple[Instr, ...]
"""Calls, the innermost last; empty where nothing is known."""
_DEEPEST = 3


def moves(flow: Flow, value: Instr, stack: Stack) -> Iterator[tuple[Instr, Instr | None, Stack]]:
    """Where a value that came by ``stack`` is found again.

    Yields:
        The instruction, the store or call that brings the value there (None: neither), and the
        calls by which it is there. What goes through a field, or a variable of several functions,
        forgets them.
    """
    for to, via in flow.copies(value):
        after = _after(flow, value, to, via, stack)
        if after is not None:
            yield to, via, after


def _after(flow: Flow, value: Instr, to: Instr, via: Instr | None, stack: Stack) -> Stack | None:
    calls = flow.points.calls
    if to.op == "param":
        sites = [site for site in _sites(flow, value) if value in calls.given.get((site, to), ())]
        return (*stack, sites[0])[-_DEEPEST:] if len(sites) == 1 else ()
    called = calls.callees.get(to, {})
    if via is None and value.function in called and _is_returned(flow, value):
        if not stack:
            return ()
        return stack[:-1] if stack[-1] is to else None
    return stack if to.function is value.function else ()


def _sites(flow: Flow, value: Instr) -> list[Instr]:
    callees = flow.points.calls.callees
    return [user for user in flow.users.get(value, ()) if user in callees]


def _is_returned(flow: Flow, value: Instr) -> bool:
    return any(user.op == "return" for user in flow.users.get(value, ()))
