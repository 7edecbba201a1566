"""What pointers lead to, and which writes a load can see: by brute force, to a fixed point.

A variable is (object, byte offset). Objects are locals, globals, what an unknown function
returns, and what an argument leads to that no known call hands over.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import networkx as nx

from tests.oracle.ir import Argument, Function, Instruction, Module, Value, number, split_commas

Location = tuple[Value, int]
SILENT = re.compile(r"llvm\.(dbg|eh|lifetime|assume|experimental|invariant|donothing|stackrestore)")


@dataclass(frozen=True)
class Write:
    """`by` writes `size` bytes at `at`; None: an unknown function is handed what `at` is in."""

    by: Instruction
    at: Location
    size: int | None


@dataclass(frozen=True)
class Copy:
    """`by` copies `size` bytes."""

    by: Instruction
    to: Location
    source: Location
    size: int


class Memory:
    """Points-to sets and definitions of the loads of a module.

    `is_narrow`: writes that are surely replaced count for variables that others see too.
    """

    def __init__(self, program: Program, is_narrow: bool = False) -> None:
        self.module, self.program, self.is_narrow = program.module, program, is_narrow
        self.targets: dict[Value, set[Location]] = {}
        self.stored: dict[Location, set[Location]] = {}
        self.below: dict[Location, Value] = {}
        self.solve()
        self.writes: list[Write] = []
        self.copies: list[Copy] = []
        for i in program.instructions:
            self.collect(i)
        self.known: dict[Instruction, set[Instruction]] = {}

    # Pointers ---------------------------------------------------------------

    def solve(self) -> None:
        """Goes over all instructions until nothing is added."""
        self.changed = True
        while self.changed:
            self.changed = False
            for f in self.program.functions:
                for a in f.arguments:
                    self.argument(a)
            for i in self.program.instructions:
                self.add(i, self.computed(i))
                if i.opcode == "store":
                    self.put(i.operands[1], self.of(i.operands[0]))
                for copy in self.copies_of(i):
                    for (o, at), values in list(self.stored.items()):
                        inside = at - copy.source[1]
                        if o is copy.source[0] and 0 <= inside < copy.size:
                            to = (copy.to[0], copy.to[1] + inside)
                            self.extend(self.stored.setdefault(to, set()), values)

    def extend(self, known: set[Location], new: set[Location]) -> None:
        if not new <= known:
            known |= new
            self.changed = True

    def add(self, value: Value, new: set[Location]) -> None:
        self.extend(self.targets.setdefault(value, set()), new)

    def put(self, pointer: Value, values: set[Location]) -> None:
        for location in self.of(pointer):
            self.extend(self.stored.setdefault(location, set()), values)

    def argument(self, a: Argument) -> None:
        calls = self.program.callers(a.function)
        if a.text.startswith("ptr") and not calls:
            self.add(a, {(a, 0)})
        for call in calls:
            if a.index < len(call.arguments):
                self.add(a, self.of(call.arguments[a.index]))

    def of(self, value: Value) -> set[Location]:
        """What `value` points to, as far as it is known so far."""
        if value.kind in ("global", "function"):
            return {(value, 0)}
        if value.kind == "constant":
            return self.constant(value.text.removeprefix("ptr "))
        return self.targets.get(value, set())

    def constant(self, text: str) -> set[Location]:
        """What an address that is computed from a global leads to."""
        if text.startswith("@"):
            known = self.module.globals.get(text[1:])
            return {(known, 0)} if known else set()
        found = re.match(r"getelementptr (?:inbounds |nuw |nusw )*\((.*)\)$", text)
        if not found:
            return set()
        written, pointer, *indices = split_commas(found[1])
        by = self.move(written, [int(i.split()[1]) for i in indices])
        return {(o, at + by) for o, at in self.constant(pointer.removeprefix("ptr "))}

    def move(self, written: str, indices: list[int | None]) -> int:
        layout = self.module.layout
        first = indices[0] or 0
        return first * layout.size(written) + layout.offset(written, indices)

    def computed(self, i: Instruction) -> set[Location]:
        """What the pointer that `i` results in leads to."""
        if i.opcode == "alloca":
            return {(i, 0)}
        if i.opcode == "getelementptr":
            text = re.search(
                r"getelementptr (?:inbounds |nuw |nusw |inrange\S* )*(.*?), ptr ", i.text
            )
            by = self.move(text[1], [number(v) for v in i.operands[1:]])
            return {(o, at + by) for o, at in self.of(i.operands[0])}
        if i.opcode in ("phi", "select", "freeze", "bitcast", "addrspacecast"):
            return set().union(*map(self.of, i.operands))
        if i.opcode == "load" and i.type == "ptr":
            return set().union(*(self.behind(location) for location in self.of(i.operands[0])))
        if i.is_call and i.type == "ptr":
            bodies = self.program.callees(i)
            returned = [r.operands[0] for f in bodies for r in self.program.returns(f)]
            return set().union(*map(self.of, returned)) if bodies else {(i, 0)}
        return set()

    def behind(self, location: Location) -> set[Location]:
        """What a pointer in memory leads to; where nobody stored one, an object of its own."""
        if self.stored.get(location):
            return self.stored[location]
        if isinstance(location[0], Argument) or location[0].kind == "unknown":
            unknown = self.below.setdefault(location, Value("unknown", f"behind {location}"))
            return {(unknown, 0)}
        return set()

    def copies_of(self, i: Instruction) -> list[Copy]:
        if not (i.is_call and i.callee.name.startswith(("llvm.memcpy", "llvm.memmove"))):
            return []
        to, source, size = i.arguments[:3]
        length = number(size) or 1 << 30
        return [Copy(i, t, s, length) for t in self.of(to) for s in self.of(source)]

    # Writes and loads -------------------------------------------------------

    def collect(self, i: Instruction) -> None:
        """Notes what `i` writes."""
        if i.opcode == "store":
            size = self.module.layout.size(store_type(i))
            self.writes += [Write(i, at, size) for at in self.of(i.operands[1])]
        elif i.is_call and i.callee.name.startswith("llvm.memset"):
            self.writes += [Write(i, at, number(i.arguments[2])) for at in self.of(i.arguments[0])]
        elif copies := self.copies_of(i):
            self.copies += copies
        elif i.is_call and not self.program.callees(i) and not SILENT.match(i.callee.name):
            for n, a in enumerate(i.arguments):
                if self.program.writes_argument(i, n):
                    size = extent(i, n)
                    self.writes += [Write(i, at, size) for at in self.of(a)]

    def writes_to(self, at: Location, size: int) -> set[Write]:
        """All writes that can change one of the bytes, without those that come by copies."""
        return {
            w
            for w in self.writes
            if w.at[0] is at[0]
            and w.at[1] < at[1] + size
            and (w.size is None or at[1] < w.at[1] + w.size)
        }

    def definitions(self, load: Instruction) -> set[Instruction]:
        """The writes and the copies that can give `load` its value."""
        if load not in self.known:
            size = self.module.layout.size(load.type)
            found: set[Instruction] = set()
            for at in self.of(load.operands[0]):
                found |= self.definitions_at(at, size, load, set())
            self.known[load] = found
        return self.known[load]

    def definitions_at(
        self, at: Location, size: int, load: Instruction, seen: set[Location]
    ) -> set[Instruction]:
        if at in seen:
            return set()
        seen.add(at)
        writes = self.writes_to(at, size)
        copies = [c for c in self.copies if c.to[0] is at[0] and 0 <= at[1] - c.to[1] < c.size]
        alive = self.reaching(at, size, {w.by for w in writes} | {c.by for c in copies}, load)
        found = {w.by for w in writes if w.by in alive}
        for c in copies:
            if c.by in alive:
                found.add(c.by)
                source = (c.source[0], c.source[1] + at[1] - c.to[1])
                found |= self.definitions_at(source, size, c.by, seen)
        return found

    def reaching(
        self, at: Location, size: int, by: set[Instruction], use: Instruction
    ) -> set[Instruction]:
        """Of the writes of a local those that no store surely replaces on every way to `use`.

        In another function than the local's own, and for what is no local, all of them, unless
        what is known is narrow.
        """
        local = at[0]
        if not isinstance(local, Instruction) or local.opcode != "alloca":
            return self.seen(at, size, by, use)
        if use.function is not local.function:
            return self.seen(at, size, by, use)
        kills = self.replacing(at, size, use.function) & by
        here = {i for i in by if i.function is use.function}
        alive = set()
        for i in by - here:
            calls = self.program.calls_that_lead_to(use.function, i.function)
            if not calls or any(self.gets_to(c, use, kills) for c in calls):
                alive.add(i)
        alive |= {i for i in here if self.gets_to(i, use, kills)}
        return alive & self.seen(at, size, by, use) if self.is_narrow else alive

    def replacing(self, at: Location, size: int, f: Function) -> set[Instruction]:
        """The writes in `f` that surely replace the whole of the variable."""
        return {
            w.by
            for w in self.writes
            if w.by.function is f
            and w.at == at
            and w.size == size
            and (
                (w.by.opcode == "store" and self.of(w.by.operands[1]) == {at})
                or (self.is_narrow and self.program.always_writes(w.by, at, self))
            )
        }

    def seen(
        self, at: Location, size: int, by: set[Instruction], use: Instruction
    ) -> set[Instruction]:
        """Of the writes those that can still be there when `use` reads, seen from anywhere."""
        if not self.is_narrow:
            return by
        own = use.function
        back = self.walk(use, self.replacing(at, size, own), forward=False)
        entered = own.blocks[0].instructions[0] in back or use is own.blocks[0].instructions[0]
        found = set()
        for i in by:
            f = i.function
            on = self.walk(i, self.replacing(at, size, f) - {i}, forward=True)
            left = any(s.opcode == "ret" for s in on)
            alive = f is own and use in on
            alive |= entered and (left or self.program.can_run(on, own))
            alive |= left and self.program.can_run(back, f)
            if alive:
                found.add(i)
        return found

    def walk(self, begin: Instruction, ends: set[Instruction], forward: bool) -> set[Instruction]:
        """The instructions on the ways from `begin`, which end at `ends`."""
        graph = self.program.steps(begin.function, exceptions=False)
        after = graph.successors if forward else graph.predecessors
        found: set[Instruction] = set()
        todo = [begin]
        while todo:
            for s in after(todo.pop()):
                if s not in found:
                    found.add(s)
                    if s not in ends:
                        todo.append(s)
        return found if forward else found - ends

    def gets_to(self, begin: Instruction, use: Instruction, kills: set[Instruction]) -> bool:
        """True where a way leads from behind `begin` to `use` and passes none of `kills`."""
        graph = self.program.steps(use.function)
        free = graph.subgraph(n for n in graph if n is use or n is begin or n not in kills)
        after = set(graph.successors(begin)) - kills
        if use in graph.successors(begin):
            return True
        return any(nx.has_path(free.subgraph(set(free) - ({begin} if begin in kills else set())),
                               a, use) for a in after)  # fmt: skip


class Program:
    """Functions, calls and ways of a module, as far as they are looked into."""

    def __init__(self, module: Module, rules: object) -> None:
        self.module, self.rules = module, rules
        self.used = {f"@{n}" for n in re.findall(r"@([\w.$]+)", module.text)}
        self.functions = [f for f in module.functions.values() if self.is_known(f)]
        self.instructions = [i for f in self.functions for i in f.instructions]
        self.calls: dict[Function, list[Instruction]] = {}
        for i in self.instructions:
            if i.is_call:
                for f in self.callees(i):
                    self.calls.setdefault(f, []).append(i)
        self.graph = nx.DiGraph()
        for f, calls in self.calls.items():
            self.graph.add_edges_from((c.function, f) for c in calls)
        self.step_graphs: dict[tuple[Function, bool], nx.DiGraph] = {}

    def is_known(self, f: Function) -> bool:
        """True where `f` has a body, and one that says what it does."""
        return (
            bool(f.blocks)
            and f.linkage != "available_externally"
            and not self.rules.is_opaque(f.name)
        )

    def callees(self, call: Instruction) -> list[Function]:
        """The functions that `call` can enter and that are looked into."""
        f = call.callee
        return [f] if isinstance(f, Function) and self.is_known(f) else []

    def callers(self, f: Function) -> list[Instruction]:
        return self.calls.get(f, [])

    def returns(self, f: Function) -> list[Instruction]:
        return [
            b.terminator for b in f.blocks if b.terminator.opcode == "ret" and b.terminator.operands
        ]

    def writes_argument(self, call: Instruction, n: int) -> bool:
        target = self.rules.target(call.callee.name)
        return target is None or n == target

    def always_writes(self, i: Instruction, at: Location, memory: Memory) -> bool:
        """True for a read of a parameter that has a default."""
        if not (i.is_call and self.rules.DEFAULTED.match(i.callee.name)):
            return False
        return memory.of(i.arguments[self.rules.target(i.callee.name)]) == {at}

    def can_run(self, instructions: set[Instruction], f: Function) -> bool:
        """True where one of the instructions is a call below which `f` runs."""
        if f not in self.graph:
            return False
        above = nx.ancestors(self.graph, f) | {f}
        return any(c in above for i in instructions if i.is_call for c in self.callees(i))

    def calls_that_lead_to(self, where: Function, f: Function) -> list[Instruction]:
        """The calls in `where` below which `f` runs."""
        if f not in self.graph or where not in self.graph:
            return []
        above = nx.ancestors(self.graph, f) | {f}
        return [
            i for i in where.instructions if i.is_call and any(c in above for c in self.callees(i))
        ]

    def steps(self, f: Function, exceptions: bool = True) -> nx.DiGraph:
        """Which instruction can follow which."""
        if (f, exceptions) not in self.step_graphs:
            graph = self.step_graphs[f, exceptions] = nx.DiGraph()
            for b in f.blocks:
                nx.add_path(graph, b.instructions)
                graph.add_node(b.terminator)
                following = b.terminator.blocks
                if b.terminator.opcode == "invoke" and not exceptions:
                    following = following[:1]
                graph.add_edges_from((b.terminator, s.instructions[0]) for s in following)
        return self.step_graphs[f, exceptions]


def store_type(i: Instruction) -> str:
    """The type of what a store writes."""
    text = i.text.split("store ", 1)[1].removeprefix("volatile ")
    if text.startswith(("{", "[", "<", "%")):
        return text  # an aggregate: sized as nothing, and so overlaps where it begins
    return text.split()[0]


def extent(call: Instruction, n: int) -> int | None:
    """The size of what argument `n` of `call` points to, where it is declared."""
    f = call.callee
    if isinstance(f, Function) and n < len(f.arguments):
        return f.arguments[n].extent
    return None
