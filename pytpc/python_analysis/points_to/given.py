"""What `__init__` keeps as it was given: by it objects of one class are told apart."""

from __future__ import annotations

from pytpc.python_analysis.ir.instructions import Instr


def kept_as_given(instr: Instr) -> Instr | None:
    """The parameter of ``__init__`` whose value ``self.name = parameter`` keeps."""
    if instr.op != "setattr":
        return None
    owner, value = instr.args
    first = unchanged_parameter(owner)
    found = unchanged_parameter(value)
    if first is None or first.data != 0:
        return None
    return found


def unchanged_parameter(value: Instr) -> Instr | None:
    """The parameter of an ``__init__`` that a value is, where nothing else is stored in it."""
    function = value.function
    if value.op != "load" or value.data not in function.parameters:
        return None
    if function.owner is None or not function.qualname.endswith(".__init__"):
        return None
    place = function.parameters.index(value.data)
    if place in (function.vararg, function.kwarg):
        return None
    stores = [
        each for each in function.instructions() if each.op == "store" and each.data is value.data
    ]
    return function.param_instrs[place] if len(stores) == 1 else None
