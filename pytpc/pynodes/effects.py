"""Which variables and attributes a call reads and writes, with all that it calls."""

from __future__ import annotations

from dataclasses import dataclass, field

from pytpc.pynodes.ir import Function, Instr, Variable
from pytpc.pynodes.names import attribute_named
from pytpc.pynodes.pointsto import PointsTo

ANY_ATTRIBUTE = "*"
Name = str | Variable
"""An attribute, whatever its object, or a variable."""


@dataclass
class Effects:
    """``writes`` and ``reads`` by name; ``waits``: other threads may run in between."""

    writes: set[Name] = field(default_factory=set)
    reads: set[Name] = field(default_factory=set)
    waits: bool = False

    def add(self, other: Effects) -> bool:
        """Take in ``other``; True where that changed anything."""
        before = (len(self.writes), len(self.reads), self.waits)
        self.writes |= other.writes
        self.reads |= other.reads
        self.waits = self.waits or other.waits
        return before != (len(self.writes), len(self.reads), self.waits)


def effects_of_calls(flow: PointsTo) -> dict[Instr, Effects]:
    """The effects of every instruction that calls something which has any."""
    functions = {function: _own(function, flow) for function in flow.program.functions}
    calls: dict[Instr, list[Function]] = {}
    for table in (flow.calls.callees, flow.calls.callbacks):
        for instr, functions_called in table.items():
            calls.setdefault(instr, []).extend(functions_called)
    changed = True
    while changed:
        changed = False
        for instr, called in calls.items():
            own = functions.get(instr.function)
            for function in called:
                if own is not None and function in functions:
                    changed |= own.add(functions[function])
    found: dict[Instr, Effects] = {}
    for instr, called in calls.items():
        effects = found.setdefault(instr, Effects())
        for function in called:
            effects.add(functions.get(function, Effects()))
    for instr in flow.calls.outside:
        if _waits(instr, flow):
            found.setdefault(instr, Effects()).waits = True
        by_name = Effects()
        _add_by_name(by_name, instr, flow)
        if by_name.reads or by_name.writes:
            found.setdefault(instr, Effects()).add(by_name)
    return found


def _add_by_name(effects: Effects, instr: Instr, flow: PointsTo) -> None:
    """``getattr``, ``setattr`` and what is done with ``__dict__``."""
    for path, owner in flow.calls.outside.get(instr, ()):
        if path in ("builtins.getattr", "builtins.setattr") and len(instr.args) > 2:
            name = attribute_named(instr.args[2])
            names = effects.reads if path == "builtins.getattr" else effects.writes
            names.add(name if isinstance(name, str) else ANY_ATTRIBUTE)
        elif owner is not None and owner.kind == "namespace":
            effects.reads.add(ANY_ATTRIBUTE)
            effects.writes.add(ANY_ATTRIBUTE)


def _is_namespace(value: Instr, flow: PointsTo) -> bool:
    return any(found.kind == "namespace" for found in flow.of(value))


def _own(function: Function, flow: PointsTo) -> Effects:
    effects = Effects()
    for instr in function.instructions():
        if instr.op in ("store", "load") and isinstance(instr.data, Variable):
            if instr.data.shared:
                (effects.writes if instr.op == "store" else effects.reads).add(instr.data)
        elif instr.op == "setattr":
            effects.writes.add(str(instr.data))
        elif instr.op == "attr":
            effects.reads.add(str(instr.data))
        elif instr.op == "call":
            effects.waits = effects.waits or _waits(instr, flow)
            _add_by_name(effects, instr, flow)
        elif instr.op == "setitem" and _is_namespace(instr.args[0], flow):
            effects.writes.add(ANY_ATTRIBUTE)
    return effects


def _waits(instr: Instr, flow: PointsTo) -> bool:
    """True where a call lets other threads run: their callbacks see and change what is shared."""
    for path, owner in flow.calls.outside.get(instr, ()):
        if owner is not None and owner.kind == "container":
            continue
        if flow.rules.waits(path.rsplit(".", 1)[-1]):
            return True
    return False
