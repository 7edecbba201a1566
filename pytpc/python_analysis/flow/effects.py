"""Which variables and attributes a call reads and writes, including what it calls."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from operator import or_

from pytpc.python_analysis.ir.instructions import Function, Instr, Variable
from pytpc.python_analysis.ir.names import attribute_named
from pytpc.python_analysis.points_to.points_to import PointsTo

ANY_ATTRIBUTE = "*"
Name = str | Variable
"""An attribute of any object, or a variable."""


@dataclass(frozen=True, slots=True)
class Effects:
    """``writes`` and ``reads``: one bit for each name; ``waits``: other threads may run then."""

    writes: int = 0
    reads: int = 0
    waits: bool = False

    def __or__(self, other: Effects) -> Effects:
        return Effects(
            self.writes | other.writes, self.reads | other.reads, self.waits or other.waits
        )


class CallEffects:
    """The effects of every instruction that calls something which has any.

    A set of names is a number with a bit for each: a program of 100,000 lines has about as many
    calls, and each may reach thousands of names.
    """

    def __init__(self, flow: PointsTo) -> None:
        self._flow = flow
        self._bits: dict[Name, int] = {}
        self._functions = {each: self._own(each) for each in flow.program.functions}
        self._of_call: dict[Instr, Effects] = {}
        calls: dict[Instr, list[Function]] = {}
        for table in (flow.calls.callees, flow.calls.callbacks):
            for instr, called in table.items():
                calls.setdefault(instr, []).extend(called)
        self._spread(calls)
        for instr, functions in calls.items():
            found = [self._functions[each] for each in functions if each in self._functions]
            # Most calls have one callee: its effects are not copied.
            self._of_call[instr] = reduce(or_, found) if found else Effects()
        for instr in flow.calls.outside:
            own = Effects(*self._by_name(instr), _waits(instr, flow))
            if own != Effects():
                self._of_call[instr] = self._of_call.get(instr, Effects()) | own

    def of(self, call: Instr) -> Effects | None:
        """The effects of ``call`` and of all that it calls; None where there are none."""
        return self._of_call.get(call)

    def mask(self, name: Name) -> int:
        """The bits in ``writes`` and ``reads`` that concern a variable or an attribute."""
        found = self._bits.get(name, 0)
        return found | self._bits.get(ANY_ATTRIBUTE, 0) if isinstance(name, str) else found

    def _bit(self, name: Name) -> int:
        return self._bits.setdefault(name, 1 << len(self._bits))

    def _spread(self, calls: dict[Instr, list[Function]]) -> None:
        """Add the effects of each function to those of its callers."""
        users: dict[Function, dict[Function, None]] = {}
        for instr, called in calls.items():
            for function in called:
                users.setdefault(function, {})[instr.function] = None
        waiting = dict.fromkeys(self._functions)
        while waiting:
            # In rounds: a function that many callees change is passed on once for all of them.
            now, waiting = waiting, {}
            for function in now:
                for user in users.get(function, ()):
                    before = self._functions.get(user, Effects())
                    after = before | self._functions.get(function, Effects())
                    if user in self._functions and after != before:
                        self._functions[user] = after
                        waiting[user] = None

    def _by_name(self, instr: Instr) -> tuple[int, int]:
        """What ``getattr``, ``setattr`` and uses of ``__dict__`` write and read."""
        writes = reads = 0
        for path, owner in self._flow.calls.outside.get(instr, ()):
            if path in ("builtins.getattr", "builtins.setattr") and len(instr.args) > 2:
                name = attribute_named(instr.args[2])
                bit = self._bit(name if isinstance(name, str) else ANY_ATTRIBUTE)
                if path == "builtins.getattr":
                    reads |= bit
                else:
                    writes |= bit
            elif owner is not None and owner.kind == "namespace":
                reads |= self._bit(ANY_ATTRIBUTE)
                writes |= self._bit(ANY_ATTRIBUTE)
        return writes, reads

    def _own(self, function: Function) -> Effects:
        writes = reads = 0
        waits = False
        for instr in function.instructions():
            if instr.op in ("store", "load") and isinstance(instr.data, Variable):
                bit = self._bit(instr.data) if instr.data.shared else 0
                if instr.op == "store":
                    writes |= bit
                else:
                    reads |= bit
            elif instr.op == "setattr":
                writes |= self._bit(str(instr.data))
            elif instr.op == "attr":
                reads |= self._bit(str(instr.data))
            elif instr.op == "call":
                waits = waits or _waits(instr, self._flow)
                more_writes, more_reads = self._by_name(instr)
                writes |= more_writes
                reads |= more_reads
            elif instr.op == "setitem" and _is_namespace(instr.args[0], self._flow):
                writes |= self._bit(ANY_ATTRIBUTE)
        return Effects(writes, reads, waits)


def _is_namespace(value: Instr, flow: PointsTo) -> bool:
    return any(found.kind == "namespace" for found in flow.of(value))


def _waits(instr: Instr, flow: PointsTo) -> bool:
    """True where a call lets other threads run: their callbacks see and change what is shared."""
    for path, owner in flow.calls.outside.get(instr, ()):
        if owner is not None and owner.kind == "container":
            continue
        if flow.rules.waits(path.rsplit(".", 1)[-1]):
            return True
    return False
