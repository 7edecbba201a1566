"""LLVM IR as plain Python objects: llvmlite parses, the text adds what its interface leaves out.

llvmlite gives blocks, opcodes and operands; the predicate of a comparison, the type that an
address is computed in and the source place are only in the text that it prints. Both list the
instructions in the same order, so the two are walked side by side.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, cached_property

import llvmlite.binding as llvm

POINTER_SIZE = 8
SCALARS = {"half": 2, "float": 4, "double": 8, "ptr": POINTER_SIZE, "x86_fp80": 16, "fp128": 16}


@dataclass(frozen=True)
class Place:
    """A place in the source."""

    file: str
    line: int
    column: int


@dataclass(eq=False)
class Value:
    """An operand: a constant, an argument, a global, a function, or (below) an instruction."""

    kind: str
    text: str = ""
    name: str = ""

    def __repr__(self) -> str:
        return f"<{self.kind} {self.name or self.text[:60]}>"


@dataclass(eq=False, repr=False)
class Argument(Value):
    """A parameter of a function; `extent` is the size of the object that it points to, or None."""

    function: Function | None = None
    index: int = 0
    extent: int | None = None


@dataclass(eq=False, repr=False)
class Instruction(Value):
    """An instruction; `blocks` are its labels, and of a phi the blocks its operands come from."""

    opcode: str = ""
    type: str = ""
    operands: list[Value] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    block: Block | None = None
    place: Place | None = None
    number: int = 0

    @property
    def function(self) -> Function:
        return self.block.function

    @property
    def is_call(self) -> bool:
        return self.opcode in ("call", "invoke")

    @cached_property
    def callee(self) -> Value:
        """The called operand."""
        return self.operands[-1]

    @cached_property
    def arguments(self) -> list[Value]:
        """The arguments of a call."""
        return self.operands[:-1]

    @cached_property
    def operand_type(self) -> str:
        """The type of what a conversion converts."""
        return self.text.split("= ", 1)[1].split(" to ")[0].split()[-2]

    @cached_property
    def predicate(self) -> str:
        """The operator of a comparison, `sgt` or `ogt`."""
        words = self.text.split("= ", 1)[1].split()
        flags = {"fast", "nnan", "ninf", "nsz", "arcp", "contract", "afn", "reassoc", "samesign"}
        return next(w for w in words[1:] if w not in flags)


@dataclass(eq=False)
class Block:
    """A basic block."""

    name: str
    function: Function
    instructions: list[Instruction] = field(default_factory=list)

    @property
    def terminator(self) -> Instruction:
        return self.instructions[-1]

    def __repr__(self) -> str:
        return f"<block {self.name}>"


@dataclass(eq=False, repr=False)
class Function(Value):
    """A function; without blocks it is declared only."""

    linkage: str = ""
    arguments: list[Argument] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    file: str = ""

    @property
    def instructions(self) -> list[Instruction]:
        return [i for b in self.blocks for i in b.instructions]


@dataclass
class Module:
    """A module; `globals` by name, with the text of their initialisers."""

    functions: dict[str, Function]
    globals: dict[str, Value]
    layout: Layout
    text: str


class Layout:
    """Sizes and offsets, by the rules of x86-64, from the types as they are written."""

    def __init__(self, text: str) -> None:
        names = re.findall(r'^%("[^"]*"|[\w.$-]+) = type (.*)$', text, re.M)
        self.named = {"%" + name: body for name, body in names}
        # Few types are asked about again and again.
        self.size, self.align = cache(self.size), cache(self.align)  # type: ignore[method-assign]
        self.offsets = cache(self.offsets)  # type: ignore[method-assign]

    def body(self, written: str) -> str:
        """The type itself where `written` is a name."""
        return self.named.get(written, written)

    def fields(self, written: str) -> list[str]:
        """The types of a struct's fields."""
        body = self.body(written).strip()
        return split_commas(body.removeprefix("<").removesuffix(">").strip()[1:-1])

    def is_struct(self, written: str) -> bool:
        return self.body(written).strip().startswith(("{", "<{"))

    def element(self, written: str) -> tuple[int, str] | None:
        """Count and type of an array's elements."""
        found = re.fullmatch(r"\[(\d+) x (.*)\]", self.body(written).strip())
        return (int(found[1]), found[2]) if found else None

    def align(self, written: str) -> int:
        body = self.body(written).strip()
        if body.startswith("<{"):
            return 1
        if array := self.element(body):
            return self.align(array[1])
        if body.startswith("{"):
            return max([self.align(f) for f in self.fields(body)], default=1)
        return min(self.size(body), 16) or 1

    def size(self, written: str) -> int:
        body = self.body(written).strip()
        if body in SCALARS:
            return SCALARS[body]
        if found := re.fullmatch(r"i(\d+)", body):
            return (int(found[1]) + 7) // 8
        if array := self.element(body):
            return array[0] * self.size(array[1])
        if self.is_struct(body):
            offsets = self.offsets(body)
            align = self.align(body)
            return -(-offsets[-1] // align) * align
        return 0

    def offsets(self, written: str) -> list[int]:
        """Where each field begins, and where the last one ends."""
        packed = self.body(written).strip().startswith("<{")
        at, out = 0, []
        for f in self.fields(written):
            align = 1 if packed else self.align(f)
            at = -(-at // align) * align
            out.append(at)
            at += self.size(f)
        return [*out, at]

    def offset(self, written: str, indices: list[int | None], is_table: bool = False) -> int:
        """Bytes that the indices of an address lead to; the elements of an array are one.

        Not so those of a table of virtual functions.
        """
        at = 0
        for index in indices[1:]:
            if array := self.element(written):
                written = array[1]
                at += self.size(written) * (index or 0) if is_table else 0
            elif self.is_struct(written) and index is not None:
                at += self.offsets(written)[index]
                written = self.fields(written)[index]
        return at


def split_commas(text: str) -> list[str]:
    """Splits at the commas that are in no bracket and in no quotes."""
    out, depth, quoted, begin = [], 0, False, 0
    for at, c in enumerate(text):
        if c == '"':
            quoted = not quoted
        elif quoted:
            continue
        elif c in "({[<":
            depth += 1
        elif c in ")}]>":
            depth -= 1
        elif c == "," and depth == 0:
            out.append(text[begin:at].strip())
            begin = at + 1
    rest = text[begin:].strip()
    return [*out, rest] if rest else out


class Places:
    """Source places from the debug information in a module's text."""

    def __init__(self, text: str, is_user: object) -> None:
        self.nodes = dict(re.findall(r"^!(\d+) = (?:distinct )?(!DI.*)$", text, re.M))
        self.is_user = is_user

    def get(self, node: str, name: str) -> str | None:
        """Field `name` of node number `node`."""
        found = re.search(rf'\b{name}: (?:!(\d+)|"([^"]*)"|(\d+))', self.nodes[node])
        return next(g for g in found.groups() if g is not None) if found else None

    def file(self, node: str) -> str:
        """The path of the file that a scope is in."""
        file = self.get(node, "file")
        if file is None:
            return ""
        name, folder = self.get(file, "filename") or "", self.get(file, "directory") or ""
        return name if name.startswith("/") else f"{folder}/{name}"

    def of(self, node: str) -> Place:
        """The place; where it is in a library, the call in the user's code that led there."""
        while True:
            scope, outer = self.get(node, "scope"), self.get(node, "inlinedAt")
            file = self.file(scope)
            if self.is_user(file) or outer is None:
                return Place(file, int(self.get(node, "line")), int(self.get(node, "column") or 0))
            node = outer


def initial_pointers(module: Module, name: str) -> dict[int, list[str]]:
    """Where pointers are in the initial value of a global, and how they are written."""
    text = module.globals[name].text
    found = re.search(r" (?:constant|global) (.*)", text)
    out: dict[int, list[str]] = {}
    # Only what has an initial value with addresses in it is looked into.
    if found and "@" in found[1] and " external " not in text:
        written, rest = split_type(found[1])
        for at, pointer in pointers_in(module.layout, written, split_type(rest)[0], is_table(name)):
            out.setdefault(at, []).append(pointer)
    return out


def is_table(name: str) -> bool:
    """True for a table of virtual functions."""
    return name.startswith("_ZTV")


def split_type(text: str) -> tuple[str, str]:
    """The first word or bracket of `text`, and what is behind it."""
    depth = quoted = 0
    for at, c in enumerate(text):
        quoted ^= c == '"'
        depth += 0 if quoted else {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}.get(c, 0)
        # An address that is computed is of several words.
        ends = c in " ," and depth == 0 and not quoted
        if ends and not re.match(r"getelementptr( inbounds| nuw| nusw| inrange\S*)*$", text[:at]):
            return text[:at], text[at:].strip(" ,")
    return text, ""


def pointers_in(
    layout: Layout, written: str, value: str, of_table: bool
) -> Iterator[tuple[int, str]]:
    """The pointers in a constant of type `written`, each with its offset."""
    if value.startswith(("@", "getelementptr")):
        yield 0, value
    if not value.startswith(("[", "{")):
        return
    for n, item in enumerate(split_commas(value[1:-1].strip())):
        type_, inner = split_type(item)
        step = layout.offset(written, [0, n], of_table)
        for at, pointer in pointers_in(layout, type_, inner, of_table):
            yield step + at, pointer


def number(v: Value) -> int | None:
    """The value of a constant integer."""
    found = re.fullmatch(r"i\d+ (-?\d+)", v.text) if v.kind == "constant" else None
    return int(found[1]) if found else None


def address(value: llvm.ValueRef) -> int:
    return ctypes.cast(value._ptr, ctypes.c_void_p).value


def instruction_texts(text: str) -> list[list[str]]:
    """For each defined function the text of each of its instructions."""
    out: list[list[str]] = []
    inside = False
    for line in text.splitlines():
        if line.startswith("define "):
            inside = True
            out.append([])
        elif line == "}":
            inside = False
        elif inside and line.startswith("  "):
            if line[2] not in " ]":
                out[-1].append(line.strip())
            elif not line.strip().startswith("#dbg"):
                out[-1][-1] += " " + line.strip()
    return out


def parse(text: str, is_user: object = lambda file: True) -> Module:
    """The module that `text` holds; `is_user` says whose code a file is."""
    parsed = llvm.parse_assembly(text)
    text = str(parsed)
    places, values = Places(text, is_user), {}
    module = Module({}, {}, Layout(text), text)
    for g in parsed.global_variables:
        module.globals[g.name] = values[address(g)] = Value("global", str(g), g.name)
    for f in parsed.functions:
        function = Function("function", "", f.name, linkage=f.linkage.name)
        module.functions[f.name] = values[address(f)] = function
        read_signature(f, function, values)
    texts = iter(instruction_texts(text))
    headers = iter(re.findall(r"^define .*$", text, re.M))
    for f in parsed.functions:
        if not f.is_declaration:
            read_body(f, module.functions[f.name], values, next(texts), places)
            scope = re.search(r"!dbg !(\d+)", next(headers))
            module.functions[f.name].file = places.file(scope[1]) if scope else ""
    return module


def read_signature(f: llvm.ValueRef, function: Function, values: dict[int, Value]) -> None:
    for index, a in enumerate(f.arguments):
        extent = re.search(r"dereferenceable\((\d+)\)", " ".join(map(str, a.attributes)))
        argument = Argument("argument", str(a.type), a.name or str(index), function, index)
        argument.extent = int(extent[1]) if extent else None
        values[address(a)] = argument
        function.arguments.append(argument)


def read_body(
    f: llvm.ValueRef,
    function: Function,
    values: dict[int, Value],
    texts: list[str],
    places: Places,
) -> None:
    blocks: dict[int, Block] = {}
    raw: list[tuple[Instruction, llvm.ValueRef]] = []
    for b in f.blocks:
        block = blocks[address(b)] = Block(b.name, function)
        function.blocks.append(block)
        for i in b.instructions:
            instruction = Instruction("instruction", opcode=i.opcode, type=str(i.type), block=block)
            values[address(i)] = instruction
            block.instructions.append(instruction)
            raw.append((instruction, i))
    assert len(raw) == len(texts), f"{function.name}: {len(raw)} instructions, {len(texts)} texts"
    for number, ((instruction, i), line) in enumerate(zip(raw, texts, strict=True)):
        instruction.text, instruction.number = line, number
        assert instruction.opcode in line.split("!dbg")[0], (instruction.opcode, line)
        if found := re.search(r"!dbg !(\d+)", line):
            instruction.place = places.of(found[1])
        for operand in i.operands:
            if address(operand) in blocks:
                instruction.blocks.append(blocks[address(operand)])
            elif address(operand) in values:
                instruction.operands.append(values[address(operand)])
            else:
                instruction.operands.append(Value("constant", str(operand)))
        if i.opcode == "phi":
            instruction.blocks = [blocks[address(b)] for b in i.incoming_blocks]
