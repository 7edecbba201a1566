"""Comparisons with hard-coded numbers, which an option asks for: type ``constant``.

A literal, or a name of a module or class that is bound to one number. Not among them: truth values,
``None``, texts, ``!= 0``, and comparisons that have a parameter on one side.
"""

from __future__ import annotations

from pytpc.python_analysis.comparisons.follow import Follower
from pytpc.python_analysis.comparisons.gather import Found, span_of
from pytpc.python_analysis.flow.constants import Constants
from pytpc.python_analysis.ir.instructions import Instr, Variable
from pytpc.python_analysis.ir.names import named_variable


def find_constants(follower: Follower, constants: Constants) -> list[Found]:
    """The comparisons with constants and the predicates that they decide, in order.

    Args:
        follower: finds the predicates that an outcome decides.
        constants: knows the numbers.
    """
    found: dict[tuple[object, ...], Found] = {}
    for instr in follower.flow.points.program.instructions():
        if instr.op != "compare":
            continue
        for operand in (0, 1):
            name = _constant(instr, operand, constants)
            if name is not None:
                key = (instr.function.module, span_of(instr, operand))
                one = found.setdefault(key, Found(instr, operand, name, []))
                one.predicates.update(dict.fromkeys(follower.outcomes.predicates(instr)))
                break
    return list(found.values())


def _constant(instr: Instr, operand: int, constants: Constants) -> str | None:
    """The name of the constant that one operand is, where the other is none."""
    threshold, other = instr.args[operand], instr.args[1 - operand]
    number = constants.number(threshold)
    values = constants.values(threshold)
    if number is None or isinstance(values[0], bool) or instr.data in ("In", "NotIn"):
        return None
    if constants.number(other) is not None or (number == 0 and instr.data == "NotEq"):
        return None
    if threshold.op == "const" or _is_negative(threshold):
        return repr(values[0])
    if threshold.op == "load" and isinstance(threshold.data, Variable):
        return named_variable(threshold) if threshold.data.owner.qualname == "<module>" else None
    if threshold.op == "attr" and str(threshold.data).isupper():
        return named_variable(threshold)
    return None


def _is_negative(instr: Instr) -> bool:
    return instr.op == "unary" and instr.args[0].op == "const"
