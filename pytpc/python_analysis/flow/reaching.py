"""Which stores a load sees: reaching definitions of variables and of ``name.attribute``.

A. Aho, M. Lam, R. Sethi, J. Ullman, "Compilers", section 9.2. Variables that other functions share
are open at a function's entry, and after calls that write them: there a load also sees stores of
other functions. A store that is replaced before other code can read it is hidden from them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from pytpc.python_analysis.flow.effects import CallEffects
from pytpc.python_analysis.ir.instructions import Block, Function, Instr, Variable

Cell = Variable | tuple[Variable, str]


@dataclass
class Reaching:
    """The result for all functions.

    ``stores``: a load (or attr) -> the stores of its own function that it sees, for cells that are
    distinguished. ``open``: the loads that see other functions' stores as well. ``hidden``: the
    stores that no other function sees.
    """

    stores: dict[Instr, list[Instr]] = field(default_factory=dict)
    open: set[Instr] = field(default_factory=set)
    hidden: set[Instr] = field(default_factory=set)


def cell_of(instr: Instr, stable: set[Variable]) -> Cell | None:
    """The cell that a load, store, attr or setattr accesses; None where it is not distinguished."""
    if instr.op in ("load", "store") and isinstance(instr.data, Variable):
        return instr.data
    if instr.op in ("attr", "setattr"):
        owner = instr.args[0]
        if owner.op == "load" and isinstance(owner.data, Variable) and owner.data in stable:
            return owner.data, str(instr.data)
    return None


class ReachingInFunction:
    """Computes `Reaching` for one function.

    ``effects``: what calls read and write. ``escaping``: loads of objects that are passed on as a
    whole, so that what is stored in their attributes is seen there.
    """

    def __init__(
        self,
        function: Function,
        effects: CallEffects,
        escaping: set[Instr],
        result: Reaching,
    ) -> None:
        self.function = function
        self.effects = effects
        self.escaping = escaping
        self.result = result
        self.stable = _bound_once(function)
        self.stores: list[Instr | None] = []
        self.of_cell: dict[Cell, int] = {}
        self.entry: dict[Cell, int] = {}
        self.shared: dict[Cell, int] = {}
        self.bit: dict[Instr, int] = {}
        self.cell: dict[Instr, Cell] = {}

    def run(self) -> None:
        """Add to the result."""
        for instr in self.function.instructions():
            cell = cell_of(instr, self.stable)
            if cell is None:
                continue
            self.cell[instr] = cell
            if cell not in self.entry:
                self.entry[cell] = self._number(None)
                self.of_cell[cell] = self.entry[cell]
                if not isinstance(cell, Variable):
                    self.shared[cell] = self.effects.mask(cell[1])
                elif cell.shared:
                    self.shared[cell] = self.effects.mask(cell)
            if instr.op in ("store", "setattr"):
                self.bit[instr] = self._number(instr)
                self.of_cell[cell] |= self.bit[instr]
        self._mark(self._fixpoint())

    def _number(self, store: Instr | None) -> int:
        self.stores.append(store)
        return 1 << (len(self.stores) - 1)

    def _step(self, instr: Instr, state: int) -> int:
        if instr in self.bit:
            return state & ~self.of_cell[self.cell[instr]] | self.bit[instr]
        effects = self.effects.of(instr)
        if effects is not None and (effects.waits or effects.writes):
            for cell, names in self.shared.items():
                if effects.waits or effects.writes & names:
                    state |= self.entry[cell]
        return state

    def _fixpoint(self) -> dict[Block, int]:
        blocks = self.function.blocks
        start = 0
        for entry in self.entry.values():
            start |= entry
        state = dict.fromkeys(blocks, 0)
        state[blocks[0]] = start
        waiting = dict.fromkeys(blocks)
        while waiting:
            block = next(iter(waiting))
            del waiting[block]
            now = anywhere = state[block]
            for instr in block.instrs:
                now = self._step(instr, now)
                anywhere |= now
            targets = [(after, now) for after in block.successors]
            targets += [(handler.block, anywhere) for handler in block.handlers]
            for after, brought in targets:
                if brought & ~state[after]:
                    state[after] |= brought
                    waiting[after] = None
        return state

    def _mark(self, state: dict[Block, int]) -> None:
        seen = 0
        for block in self.function.blocks:
            now = state[block]
            if block is self.function.exit:
                seen |= now
            for instr in block.instrs:
                if instr.op in ("load", "attr") and instr in self.cell:
                    self._mark_load(instr, now & self.of_cell[self.cell[instr]])
                seen |= now & self._seen_by(instr)
                now = self._step(instr, now)
        for store, bit in self.bit.items():
            if not bit & seen:
                self.result.hidden.add(store)

    def _seen_by(self, instr: Instr) -> int:
        seen = 0
        if instr in self.escaping:
            for cell, mask in self.of_cell.items():
                if isinstance(cell, tuple) and cell[0] is instr.data:
                    seen |= mask
        effects = self.effects.of(instr)
        if effects is None:
            return seen
        for cell, names in self.shared.items():
            if effects.waits or effects.reads & names:
                seen |= self.of_cell[cell]
        return seen

    def _mark_load(self, instr: Instr, reached: int) -> None:
        cell = self.cell[instr]
        if reached & self.entry[cell]:
            self.result.open.add(instr)
        found = []
        reached &= ~self.entry[cell]
        while reached:
            low = reached & -reached
            store = self.stores[low.bit_length() - 1]
            if store is not None:
                found.append(store)
            reached ^= low
        self.result.stores[instr] = found


def _bound_once(function: Function) -> set[Variable]:
    """The function's own variables that one instruction binds: paths through one are equal."""
    count: dict[Variable, int] = {}
    for instr in function.instructions():
        if instr.op == "store" and isinstance(instr.data, Variable):
            count[instr.data] = count.get(instr.data, 0) + 1
    return {
        variable
        for variable, stores in count.items()
        if stores == 1 and variable.owner is function and not variable.shared
    }
