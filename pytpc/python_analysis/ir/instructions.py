"""A Python function as blocks of instructions, which the analyses of this room work on.

Every subexpression is one instruction and stands for its own value. Conditions are branches at the
end of a block, one for each operand of ``and``, ``or`` and ``not`` and for each link of a chain.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field


@dataclass(eq=False, slots=True)
class Variable:
    """A name of a function (or of a module, whose body is a function).

    ``shared``: a function other than ``owner`` uses it.
    """

    name: str
    owner: Function
    shared: bool = False

    def __repr__(self) -> str:
        return f"{self.owner.qualname}:{self.name}"


@dataclass(eq=False, slots=True)
class Instr:
    """One instruction; ``args`` are the instructions whose values it uses.

    ``op`` and what ``data`` is:

    ========  =======================================================================
    const     the value
    external  dotted name of something outside the sources
    module    a ``Module`` of the sources
    param     number of the parameter in ``Function.parameters``
    load      a ``Variable``
    store     a ``Variable``; args: value
    attr      attribute's name; args: object
    setattr   attribute's name; args: object, value
    item      args: object, key
    setitem   args: object, key, value
    call      a ``Shape``; args: function, arguments
    binary    name of the operator's class in ``ast``; args: two
    unary     the same; args: one
    compare   the same; args: two
    build     ``list``, ``tuple``, ``set``, ``dict`` (args: keys and values in turn) or ``text``
    function  a ``Function``; args: defaults
    class     a ``ClassInfo``; args: bases
    iter      args: what is iterated over
    next      args: the ``iter``
    more      args: the ``iter``; true while there is a next one
    match     what of the pattern is tested, without a value; args: subject
    branch    None; args: the condition. Last of its block: successors are true, false
    dispatch  at the end of a ``finally``; args: how it was come to. Last of its block
    return    args: value
    yield     args: value
    raise     name of the class, where one stands there; args: what there is
    copy      args: a value that is handed on (``await``, a star)
    ========  =======================================================================
    """

    op: str
    args: tuple[Instr, ...]
    data: object
    node: ast.AST
    block: Block
    number: int

    def __repr__(self) -> str:
        return f"%{self.number}:{self.op}@{getattr(self.node, 'lineno', 0)}"

    @property
    def function(self) -> Function:
        """The function that it is in."""
        return self.block.function


@dataclass(frozen=True, slots=True)
class Shape:
    """The form of a call's arguments: keywords by name, ``*`` and ``**`` for unpacked ones.

    ``names`` has one entry for each argument: None for a positional one. ``decorates``: it is the
    call of a decorator.
    """

    names: tuple[str | None, ...]
    decorates: bool = False


@dataclass(frozen=True, slots=True)
class Handler:
    """An ``except``; ``names`` are the classes that it names, None where it catches everything."""

    block: Block
    names: tuple[str, ...] | None


@dataclass(eq=False, slots=True)
class Block:
    """Instructions that run one after another.

    ``handlers``: where an exception in it may go, the innermost first. ``opened``: for the first
    block of a handler, the block in which its ``try`` begins.
    """

    function: Function
    number: int
    instrs: list[Instr] = field(default_factory=list)
    successors: list[Block] = field(default_factory=list)
    handlers: tuple[Handler, ...] = ()
    opened: Block | None = None

    def __repr__(self) -> str:
        return f"{self.function.qualname}#{self.number}"


def reachable(
    starts: Iterable[Block], without: Block | None = None, *, by_raise: bool = True
) -> set[Block]:
    """``starts`` and the blocks that may run after them, without going through ``without``.

    Handlers are reached only with ``by_raise``.
    """
    reached: set[Block] = set()
    waiting = [*starts]
    while waiting:
        block = waiting.pop()
        if block is not without and block not in reached:
            reached.add(block)
            waiting += block.successors
            waiting += [handler.block for handler in block.handlers if by_raise]
    return reached


@dataclass(eq=False, slots=True)
class Function:
    """A function, a lambda, or the body of a module (``<module>``).

    ``defaults``: the number of a parameter -> the number of its default. ``conditions``: an
    expression -> the whole condition that it is part of.
    """

    qualname: str
    module: Module
    node: ast.AST
    parameters: list[Variable] = field(default_factory=list)
    param_instrs: list[Instr] = field(default_factory=list)
    defaults: dict[int, int] = field(default_factory=dict)
    vararg: int | None = None
    kwarg: int | None = None
    keyword_only: int | None = None
    blocks: list[Block] = field(default_factory=list)
    exit: Block | None = None
    variables: dict[str, Variable] = field(default_factory=dict)
    owner: ClassInfo | None = None
    decorators: tuple[str, ...] = ()
    is_generator: bool = False
    conditions: dict[ast.AST, ast.AST] = field(default_factory=dict)

    def instructions(self) -> Iterator[Instr]:
        """All instructions, block by block."""
        for block in self.blocks:
            yield from block.instrs

    def __repr__(self) -> str:
        return self.qualname


@dataclass(eq=False, slots=True)
class ClassInfo:
    """A class of the sources; ``fields`` are its annotated names in order (dataclasses)."""

    qualname: str
    module: Module
    node: ast.ClassDef
    fields: list[str] = field(default_factory=list)
    is_record: bool = False

    def __repr__(self) -> str:
        return self.qualname


@dataclass(eq=False, slots=True)
class Module:
    """A source file; ``name`` is the dotted name under which it is imported."""

    name: str
    path: str
    source: str
    tree: ast.Module
    body: Function | None = None
    functions: list[Function] = field(default_factory=list)
    classes: list[ClassInfo] = field(default_factory=list)

    def __repr__(self) -> str:
        return self.name


ANY = object()
"""An unknown key."""
