"""Builds the blocks and instructions of a function."""

from __future__ import annotations

import ast
from collections.abc import Callable

from pytpc.python_analysis.ir.instructions import Block, Function, Handler, Instr, Module, Variable
from pytpc.python_analysis.ir.scopes import Scope

Resolver = Callable[[Module, str, int], "Module | str"]
"""Arguments: the importing module, the dotted name, the number of dots before it."""


class Builder:
    """The state of lowering one function: the current block, and where instructions go."""

    def __init__(self, scope: Scope, resolve: Resolver, numbers: list[int]) -> None:
        """``numbers`` has one item: the number of the next instruction."""
        self.function = scope.function
        self.module = scope.function.module
        self.scope = scope
        self.resolve = resolve
        self.numbers = numbers
        self.handlers: tuple[Handler, ...] = ()
        self.pending: list[tuple[Function, Scope]] = []
        self.stars: list[Instr] = []
        self._temporaries = 0
        self.block = self.new_block()

    def new_block(self) -> Block:
        """A block without predecessors."""
        block = Block(self.function, len(self.function.blocks), handlers=self.handlers)
        self.function.blocks.append(block)
        return block

    def emit(self, op: str, node: ast.AST, *args: Instr, data: object = None) -> Instr:
        """Add an instruction to the current block."""
        instr = Instr(op, args, data, node, self.block, self.numbers[0])
        self.numbers[0] += 1
        self.block.instrs.append(instr)
        return instr

    def jump(self, to: Block) -> None:
        """End the current block."""
        self.block.successors.append(to)

    def branch(self, value: Instr, node: ast.AST, yes: Block, no: Block) -> None:
        """End the current block with a predicate."""
        if yes is no:
            self.jump(yes)
            return
        self.emit("branch", node, value)
        self.block.successors += [yes, no]

    def temporary(self) -> Variable:
        """A variable without a name in the source."""
        self._temporaries += 1
        name = f"<{self._temporaries}>"
        return self.function.variables.setdefault(name, Variable(name, self.function))
