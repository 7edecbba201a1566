"""Comparisons with hard-coded numbers, which an option asks for: type ``constant``.

A literal, or a name of a module or class that is bound to one number. Not among them: truth values,
``None``, texts, ``!= 0``, and comparisons that have a parameter on one side.
"""

from __future__ import annotations

from pytpc.pynodes.constants import Constants
from pytpc.pynodes.follow import Follower
from pytpc.pynodes.gather import Found, span_of
from pytpc.pynodes.ir import Instr, Variable
from pytpc.pynodes.names import named_variable
from pytpc.pynodes.slicing import Slice


def find_constants(
    follower: Follower, constants: Constants, found_slice: Slice, taken: list[Found]
) -> list[Found]:
    """The comparisons with constants that decide a predicate of the slice, in order.

    Args:
        follower: finds the predicates that an outcome decides.
        constants: knows the numbers.
        found_slice: what exposing statements depend on.
        taken: the comparisons with parameters.
    """
    with_parameter = {each.at.node for each in taken}
    found: dict[tuple[object, ...], Found] = {}
    for instr in follower.flow.points.program.instructions():
        if instr.op != "compare" or instr.node in with_parameter:
            continue
        for operand in (0, 1):
            name = _constant(instr, operand, constants)
            if name is None:
                continue
            near = [
                each for each in follower.outcomes.predicates(instr) if each in found_slice.distance
            ]
            if near:
                predicate = min(near, key=lambda each: (found_slice.distance[each], each.number))
                key = (instr.function.module, span_of(instr, operand))
                found.setdefault(
                    key,
                    Found(
                        instr,
                        operand,
                        name,
                        [],
                        dict.fromkeys(near),
                        found_slice.distance[predicate],
                        predicate,
                    ),
                )
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
