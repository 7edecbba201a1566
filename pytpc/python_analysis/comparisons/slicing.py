"""Backward: from the exposing statements over data and control dependence, in rounds.

This is algorithm 3 of the thesis (docs/reference/analysis.md#the-slice). Round 1 holds the exposing
statements. All parts of an expression belong to the round of its statement; stores, arguments,
results and branches are a round each.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from pytpc.python_analysis.comparisons.reads import Exposed
from pytpc.python_analysis.flow.library_calls import choosing_calls
from pytpc.python_analysis.flow.raising import Leaving
from pytpc.python_analysis.flow.value_flow import Flow
from pytpc.python_analysis.ir.control import control_dependence
from pytpc.python_analysis.ir.instructions import Block, Function, Instr


@dataclass
class Slice:
    """``distance``: branch -> distance. ``nearest``: instruction -> the exposing statement.

    ``shown``: comparison -> distance, where a value of the slice is computed from its outcome.
    ``because``: instruction -> the one that brought it into the slice, and how (``control``,
    ``data``, ``call``). ``holder``: a call that chooses a value -> the instruction of the slice
    that has it in its expression.
    """

    distance: dict[Instr, int] = field(default_factory=dict)
    shown: dict[Instr, int] = field(default_factory=dict)
    nearest: dict[Instr, Exposed] = field(default_factory=dict)
    because: dict[Instr, tuple[Instr, str] | None] = field(default_factory=dict)
    holder: dict[Instr, Instr] = field(default_factory=dict)


class Slicer:
    """Computes the slice of a program."""

    def __init__(self, flow: Flow, leaving: Leaving, selecting: Iterable[Instr] = ()) -> None:
        """``selecting`` are predicates without a branch."""
        self.flow = flow
        self.leaving = leaving
        self._own = flow.points.calls.callees
        self._raised: set[Instr] = set()
        self._filters = {
            call
            for call, paths in flow.points.calls.outside.items()
            if any(path in flow.points.rules.filters for path, _ in paths)
        } | set(selecting)
        self._choosing = choosing_calls(flow)
        self.slice = Slice()
        self._control: dict[Function, dict[Block, list[Block]]] = {}

    def run(self, exposed: list[Exposed]) -> Slice:
        """The slice from all of ``exposed``."""
        result = self.slice
        current: list[Instr] = []
        for each in exposed:
            if each.instr not in result.nearest:
                result.nearest[each.instr] = each
                result.because[each.instr] = None
                current.append(each.instr)
        number = 1
        while current:
            further: list[Instr] = []
            for instr in current:
                self._controlled(instr, number, further)
                self._used(instr, further, number)
            current, number = further, number + 1
        return result

    def controlling(self, instr: Instr) -> list[Instr]:
        """The branches and raising calls of its function that decide whether ``instr`` runs."""
        found: dict[Instr, None] = {}
        seen = {instr.block}
        waiting = [instr.block]
        while waiting:
            for deciding in self._deciding(waiting.pop()):
                if deciding.op != "dispatch":
                    found[deciding] = None
                    continue
                # The way into a `finally` is decided where it is stored. Whether its end is reached
                # depends on what raises in it.
                noted = [store.block for store in self.flow.sources(deciding.args[0])]
                for block in (*noted, deciding.block):
                    if block not in seen:
                        seen.add(block)
                        waiting.append(block)
        return list(found)

    def _deciding(self, block: Block) -> list[Instr]:
        function = block.function
        if function not in self._control:
            self._control[function] = control_dependence(function)
        blocks = self._control[function].get(block, [])
        return [each.instrs[-1] for each in blocks if each.instrs]

    def _enter(self, instr: Instr, after: Instr, how: str, further: list[Instr]) -> None:
        if instr in self.slice.because:
            return
        self.slice.because[instr] = (after, how)
        self.slice.nearest[instr] = self.slice.nearest[after]
        further.append(instr)

    def _controlled(self, instr: Instr, number: int, further: list[Instr]) -> None:
        branches = self.controlling(instr)
        for branch in branches:
            if branch.op == "branch":
                self.slice.distance.setdefault(branch, number)
            else:
                self._raised.add(branch)
            self._enter(branch, instr, "control", further)
        if branches:
            return
        calls = self.flow.points.calls
        for table in (calls.callers, calls.registered):
            for call in table.get(instr.function, ()):
                self._enter(call, instr, "call", further)

    def _used(self, instr: Instr, further: list[Instr], number: int) -> None:
        """Enter what defines the values that ``instr`` uses."""
        if instr in self._raised:
            for function in self.flow.points.calls.callees.get(instr, ()):
                for leaving in self.leaving.get(function, ()):
                    if leaving.op != "raise":
                        self._raised.add(leaving)
                    self._enter(leaving, instr, "call", further)
        seen = {instr}
        waiting = [instr]
        while waiting:
            here = waiting.pop()
            if here is not instr and here.op == "call" and here in self._own:
                # Its arguments count where the function uses them.
                self._enter(here, instr, "data", further)
            for source in self.flow.sources(here):
                self._enter(source, instr, "data", further)
            if here in self._filters:
                self.slice.distance.setdefault(here, number)
                self.slice.nearest.setdefault(here, self.slice.nearest[instr])
            if here in self._choosing:
                # Like the branch of a conditional expression, whose value is a step of its own.
                self._hold(here, instr, self.slice.distance, number + 1)
            if here.op == "compare":
                self._hold(here, instr, self.slice.shown, number)
            if (number == 1 and here is instr) or here.op in ("call", "return", "iter"):
                # The publisher itself is not published.
                for arg in here.args[1:] if here is instr and here.op == "call" else here.args:
                    for writer in self.flow.contents(arg, here):
                        self._enter(writer, instr, "data", further)
            for arg in self._operands(here):
                if arg not in seen:
                    seen.add(arg)
                    waiting.append(arg)

    def _hold(self, part: Instr, instr: Instr, table: dict[Instr, int], number: int) -> None:
        """Note the distance of a part of the expression of ``instr``."""
        table.setdefault(part, number)
        self.slice.nearest.setdefault(part, self.slice.nearest[instr])
        self.slice.holder.setdefault(part, instr)

    def _operands(self, instr: Instr) -> tuple[Instr, ...]:
        """The operands from which the value of the instruction is computed."""
        if instr.op == "call" and instr in self._own:
            return instr.args[:1]
        if instr.op in ("function", "class"):
            return ()
        return instr.args
