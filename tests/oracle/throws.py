"""Which calls throw, as the source says: a `throw` in the user's code and the calls above it."""

from __future__ import annotations

import re
from collections.abc import Callable

from tests.oracle.ir import Block, Function, Instruction, Place, Value
from tests.oracle.memory import Program

THROWS = ("__cxa_throw", "__cxa_rethrow")
Type = str | None
"""The name of a type's `_ZTI` object; None: not known."""


def is_throw(i: Instruction) -> bool:
    return i.is_call and i.callee.name in THROWS


def takes(handler: str, thrown: Type) -> bool | None:
    """Whether a handler takes what is thrown; None where that is open."""
    if handler in ("null", thrown):
        return True
    # int, double: nothing else takes them, and they take nothing else.
    is_builtin = [re.fullmatch("_ZTI[a-z]", name) for name in (handler, thrown or "")]
    return False if thrown and any(is_builtin) else None


def handlers(pad: Block) -> list[str]:
    """The types of a landing pad's handlers, in their order."""
    text = next(i.text for i in pad.instructions if i.opcode == "landingpad")
    return re.findall(r"catch ptr @?([\w.$]+)", text)


def asks_for(condition: Value) -> str | None:
    """The type of the handler that a comparison in a landing pad asks about."""
    if not isinstance(condition, Instruction) or condition.opcode != "icmp":
        return None
    for o in condition.operands:
        if isinstance(o, Instruction) and o.is_call and "eh.typeid.for" in o.callee.name:
            return o.arguments[0].name
    return None


def begins_handler(block: Block) -> bool:
    return any(i.is_call and i.callee.name == "__cxa_begin_catch" for i in block.instructions)


def only_asks(block: Block) -> bool:
    """True for a part of a landing pad that does no more than to choose the handler."""
    kinds = {i.opcode for i in block.instructions}
    end = block.terminator
    asks = end.opcode == "br" and len(end.blocks) == 2 and asks_for(end.operands[0])
    done = [i for i in block.instructions if i.is_call and "eh.typeid.for" not in i.callee.name]
    return bool("landingpad" in kinds or asks) and not done and "store" not in kinds


def ends_program(pad: Block) -> bool:
    """True for the landing pad of what is `noexcept`: nothing is thrown on."""
    return pad.terminator.opcode == "unreachable"


def noexcept(program: Program) -> set[Function]:
    """The functions that let nothing through."""
    text = program.module.text
    marks = set(re.findall(r"^attributes (#\d+) = \{[^}]*\bnounwind\b", text, re.M))
    heads = re.findall(r"^define [^@\n]*@([\w.$]+)\((.*)$", text, re.M)
    silent = {name for name, rest in heads if marks & set(re.findall(r"#\d+", rest))}
    return {f for f in program.functions if f.name in silent}


class Throws:
    """What each call of a program throws, found by trying until nothing is new."""

    def __init__(self, program: Program, is_user: Callable[[Place], bool]) -> None:
        self.program = program
        self.thrown: dict[Instruction, set[Type]] = {}
        self.out: dict[Function, set[Type]] = {f: set() for f in program.functions}
        for i in program.instructions:
            if is_throw(i) and i.place and is_user(i.place):
                self.thrown[i] = {i.arguments[1].name if len(i.arguments) > 1 else None}
        self.silent = noexcept(program)
        before = None
        while before != self.size():
            before = self.size()
            for i in program.instructions:
                self.try_call(i)

    def size(self) -> int:
        return sum(map(len, [*self.thrown.values(), *self.out.values()]))

    def try_call(self, i: Instruction) -> None:
        if i.is_call and not is_throw(i):
            types = {t for f in self.program.callees(i) for t in self.out[f]}
            if types:
                self.thrown[i] = types
        if i.function not in self.silent:
            self.out[i.function] |= self.escaping(i)

    def escaping(self, i: Instruction) -> set[Type]:
        """What leaves the function by `i`."""
        types = self.thrown.get(i, set())
        if i.opcode == "call":
            return types
        pad = handlers(i.blocks[1]) if types else []
        return {t for t in types if not any(takes(h, t) for h in pad)}

    def leaving(self, f: Function) -> list[Instruction]:
        """The instructions by which exceptions leave `f`."""
        return [i for i in f.instructions if self.escaping(i)] if f not in self.silent else []
