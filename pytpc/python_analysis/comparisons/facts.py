"""What is known of a value that comes from a parameter, and of a comparison with it."""

from __future__ import annotations

from dataclasses import dataclass, field

from pytpc.python_analysis.comparisons.reads import Read
from pytpc.python_analysis.comparisons.transform import How
from pytpc.python_analysis.flow.library_calls import Inside
from pytpc.python_analysis.flow.value_flow import Stack
from pytpc.python_analysis.ir.instructions import Instr

FLAG = -1
"""In place of an operand: the value itself is the condition."""
RANGE = -2
"""The value bounds the ``range`` that a loop runs over."""


@dataclass(eq=False, slots=True)
class Fact:
    """``at`` has the value of the parameter ``name``, after ``how``.

    ``before`` is the fact that it follows from, ``via`` the store or call that brought the value,
    and ``stack`` the calls by which it came into its function. ``is_object``: the value is an
    attribute of it.
    """

    at: Instr
    read: Read
    name: str
    how: How
    stack: Stack = ()
    before: Fact | None = None
    via: Instr | None = None
    is_object: bool = False


@dataclass(eq=False, slots=True)
class Compared:
    """A comparison ``at`` with the operand number ``operand``, or one of the kinds above.

    ``inside``: the library function that ``at`` calls makes the comparison.
    """

    at: Instr
    operand: int
    fact: Fact
    inside: Inside | None = None
    predicates: list[Instr] = field(default_factory=list)


def keeps_formula(fact: Fact, to: Instr, via: Instr | None) -> bool:
    """False where a value that was computed with others is data, and no threshold any more.

    It is handed to a function, returned, put into a container, or moves the variable on that it
    was computed with.
    """
    if via is None or via.op not in ("store", "setattr") or to.op not in ("load", "attr"):
        return False
    return not any(
        other.op == to.op and other.data == to.data and _owner(other) == _owner(to)
        for other in fact.how.others
    )


def _owner(instr: Instr) -> object:
    """The variable whose attribute it is."""
    return instr.args[0].data if instr.op == "attr" else None
