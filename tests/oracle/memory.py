"""What pointers lead to, and which writes a load can see: by brute force, to a fixed point.

A variable is (object, byte offset). Objects are locals, globals, what an unknown function
returns, and what an argument leads to that no known call hands over.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import networkx as nx

from tests.oracle.ir import (
    Argument,
    Function,
    Instruction,
    Module,
    Value,
    initial_pointers,
    is_table,
    number,
    split_commas,
    split_type,
)

Location = tuple[Value, int]
UNKNOWN = 4096
DEEPEST = 1
"""How often what is behind an unknown pointer is told apart: a list has no end."""
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
    """Points-to sets and definitions of the loads of a module."""

    def __init__(self, module: Module, program: Program) -> None:
        self.module, self.program = module, program
        self.targets: dict[Value, set[Location]] = {}
        self.stored: dict[Location, set[Location]] = {}
        self.below: dict[Location, Value] = {}
        for name, g in module.globals.items():
            for at, written in initial_pointers(module, name).items():
                known = self.stored.setdefault((g, at), set())
                known |= {t for w in written for t in self.constant(w)}
        # What is called through pointers is handed what those calls hand over; only where there
        # turn out to be none, nobody knows what.
        held = {o for known in self.stored.values() for o, _ in known} | set(program.mentions)
        self.waiting = {o for o in held if isinstance(o, Function)}
        self.solve()
        self.waiting.clear()
        self.solve()
        self.kept = {o for targets in self.stored.values() for o, _ in targets}
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
                if i.is_call and not isinstance(i.callee, Function):
                    self.changed |= self.program.enters(i, self.called(i))
                for copy in self.copies_of(i):
                    for (o, at), values in list(self.stored.items()):
                        inside = at - copy.source[1]
                        if o is copy.source[0] and 0 <= inside < copy.size:
                            to = (copy.to[0], copy.to[1] + inside)
                            self.extend(self.stored.setdefault(to, set()), values)

    def called(self, call: Instruction) -> set[Function]:
        """What a call through a pointer enters: by what the pointer can be, but a virtual
        function is that of any class of the hierarchy."""
        out = {o for o, at in self.of(call.callee) if isinstance(o, Function)}
        if isinstance(call.callee, Instruction) and call.callee.opcode == "load":
            for table, at in self.of(call.callee.operands[0]):
                for other in self.program.related(table):
                    known = self.stored.get((other, at), set())
                    out |= {o for o, _ in known if isinstance(o, Function)}
        return {f for f in out if len(f.arguments) == len(call.arguments)}

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
        if a.text.startswith("ptr") and not calls and a.function not in self.waiting:
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
            name = text[1:].strip('"')
            known = self.module.globals.get(name) or self.module.functions.get(name)
            return {(known, 0)} if known else set()
        found = re.match(
            r"getelementptr (?:inbounds |nuw |nusw |inrange\([^)]*\) )*\((.*)\)$", text
        )
        if not found:
            return set()
        written, pointer, *indices = split_commas(found[1])
        steps = [int(i.split()[1]) for i in indices]
        begin = self.constant(pointer.removeprefix("ptr "))
        return {(o, at + self.move(written, steps, is_table(o.name))) for o, at in begin}

    def move(self, written: str, indices: list[int | None], of_table: bool = False) -> int:
        layout = self.module.layout
        first = indices[0] or 0
        return first * layout.size(written) + layout.offset(written, indices, of_table)

    def computed(self, i: Instruction) -> set[Location]:
        """What the pointer that `i` results in leads to."""
        if i.opcode == "alloca":
            return {(i, 0)}
        if i.opcode == "getelementptr":
            by = self.move(source_type(i), [number(v) for v in i.operands[1:]])
            moved = {(o, at + by) for o, at in self.of(i.operands[0])}
            # What is beyond its object is nothing: in a cycle there would be no end of it.
            return {(o, at) for o, at in moved if at <= self.size(o)}
        if i.opcode in ("phi", "select", "freeze", "bitcast", "addrspacecast"):
            return set().union(*map(self.of, i.operands))
        if i.opcode == "load" and i.type == "ptr":
            return set().union(*(self.behind(location) for location in self.of(i.operands[0])))
        if i.is_call and i.type == "ptr":
            bodies = self.program.callees(i)
            returned = [r.operands[0] for f in bodies for r in self.program.returns(f)]
            return set().union(*map(self.of, returned)) if bodies else {(i, 0)}
        return set()

    def size(self, o: Value) -> int:
        """The bytes of an object; of one whose type is not known, more than most have."""
        if isinstance(o, Instruction) and o.opcode == "alloca":
            return self.module.layout.size(split_type(o.text.split("alloca ", 1)[1])[0]) or UNKNOWN
        return UNKNOWN

    def behind(self, location: Location) -> set[Location]:
        """What a pointer in memory leads to; where nobody stored one, an object of its own."""
        if self.stored.get(location):
            return self.stored[location]
        if isinstance(location[0], Argument) or location[0].kind == "unknown":
            if location[0].text.count("behind") > DEEPEST:
                return {(location[0], 0)}
            text = f"behind {location[0].text} at {location[1]}"
            unknown = self.below.setdefault(location, Value("unknown", text))
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
        """Of the writes those that no store surely replaces on every way to `use`."""
        local = at[0]
        if not isinstance(local, Instruction) or local.opcode != "alloca":
            return {i for i in by if self.is_seen(i, at, size, use)}
        if use.function is not local.function:
            return {i for i in by if self.is_seen(i, at, size, use)}
        kills = {
            w.by
            for w in self.writes
            if w.by in by
            and w.by.function is use.function
            and (pointer := self.replaced(w.by)) is not None
            and self.of(pointer) == {at}
            and w.size == size
        }
        here = {i for i in by if i.function is use.function}
        alive = set()
        for i in by - here:
            calls = self.program.calls_that_lead_to(use.function, i.function)
            handed = [c for c in calls if self.can_reach(c, local)]
            if not calls or any(self.gets_to(c, use, kills) for c in handed):
                alive.add(i)
        return alive | {i for i in here if self.gets_to(i, use, kills)}

    def can_reach(self, call: Instruction, local: Value) -> bool:
        """True where what `call` runs can get at `local`: it is handed, or its address is kept."""
        return local in self.kept or any(o is local for a in call.arguments for o, _ in self.of(a))

    def is_seen(self, write: Instruction, at: Location, size: int, use: Instruction) -> bool:
        """True where what `write` leaves in memory that functions share can be there at `use`.

        It is where it leaves its function unreplaced and `use` can find what was there before its
        own; where `use` is in a function that runs while it is there, or the write is in one that
        runs before `use`; and where a way in one function leads from the one to the other.
        """
        here, there = write.function, use.function
        mine = self.replacements(write, at, size) - {write}
        theirs = self.replacements(use, at, size)
        if here is there and self.gets_to(write, use, theirs):
            return True
        # An exception is no way on.
        pads = {i for i in here.instructions if i.opcode == "landingpad"}
        ends = [i for i in here.instructions if i.opcode in ("ret", "unreachable")]
        leaves = not mine or any(self.gets_to(write, e, mine | pads) for e in ends)
        begin = there.instructions[0]
        enters = not theirs or begin is use
        enters = enters or (begin not in theirs and self.gets_to(begin, use, theirs))
        if leaves and enters:
            return True
        if leaves:
            calls = self.program.calls_that_lead_to(there, here)
            return any(self.gets_to(c, use, theirs) for c in calls)
        calls = self.program.calls_that_lead_to(here, there)
        return enters and any(self.gets_to(write, c, mine | pads) for c in calls)

    def replacements(self, i: Instruction, at: Location, size: int) -> set[Instruction]:
        """The stores of the function of `i` to what `i` names in the same way."""
        place = None
        if i.is_call:
            for pointer in i.arguments:
                named, leads = self.named(pointer), self.of(pointer)
                if named and len(leads) == 1 and next(iter(leads))[0] is at[0]:
                    place = named[0], named[1] + at[1] - next(iter(leads))[1]
        else:
            place = self.named(i.operands[-1])
        if place is None:
            return set()
        return {s for s in i.function.instructions if self.place(s) == (*place, size)}

    def place(self, i: Instruction) -> tuple[Value, int, int] | None:
        """Where a write puts its value by the code of its function, and its size."""
        pointer = self.replaced(i)
        named = self.named(pointer) if pointer is not None else None
        if named is None:
            return None
        size = extent(i, 2) if i.is_call else self.module.layout.size(store_type(i))
        return None if size is None else (*named, size)

    def replaced(self, i: Instruction) -> Value | None:
        """The pointer to what `i` gives a new value, whatever was there."""
        if i.opcode == "store":
            return i.operands[1]
        if i.is_call and len(i.arguments) > 3 and self.program.rules.always_writes(i.callee.name):
            return i.arguments[2]
        return None

    def named(self, pointer: Value) -> tuple[Value, int] | None:
        """A pointer as so many bytes from an argument, a local or a global."""
        if isinstance(pointer, Argument):
            return pointer, 0
        if isinstance(pointer, Instruction):
            if pointer.opcode == "alloca":
                return pointer, 0
            inner = self.named(pointer.operands[0]) if pointer.opcode == "getelementptr" else None
            steps = [number(v) for v in pointer.operands[1:]] if inner else []
            if inner is None or None in steps:
                return None
            return inner[0], inner[1] + self.move(source_type(pointer), steps)
        found = self.of(pointer)
        return next(iter(found)) if len(found) == 1 else None

    def gets_to(self, begin: Instruction, use: Instruction, kills: set[Instruction]) -> bool:
        """True where a way leads from behind `begin` to `use` and passes none of `kills`."""
        graph = self.program.steps(use.function)
        todo, seen = [begin], set(kills)
        while todo:
            after = set(graph.successors(todo.pop()))
            if use in after:
                return True
            todo += after - seen
            seen |= after
        return False


class Program:
    """Functions, calls and ways of a module, as far as they are looked into."""

    def __init__(self, module: Module, rules: object) -> None:
        self.module, self.rules = module, rules
        self.used = {f"@{n}" for n in re.findall(r"@([\w.$]+)", module.text)}
        self.functions = [f for f in module.functions.values() if self.is_known(f)]
        self.instructions = [i for f in self.functions for i in f.instructions]
        self.calls: dict[Function, list[Instruction]] = {}
        self.through_pointers: dict[Instruction, list[Function]] = {}
        self.graph = nx.DiGraph()
        for i in self.instructions:
            if i.is_call:
                for f in self.callees(i):
                    self.add_call(i, f)
        self.mentions: dict[Function, list[Instruction]] = {}
        for i in self.instructions:
            for f in self.mentioned(i):
                self.mentions.setdefault(f, []).append(i)
        self.families = hierarchy(module)
        self.step_graphs: dict[Function, nx.DiGraph] = {}

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
        if not isinstance(f, Function):
            return self.through_pointers.get(call, [])
        return [f] if self.is_known(f) else []

    def add_call(self, call: Instruction, f: Function) -> None:
        self.calls.setdefault(f, []).append(call)
        self.graph.add_edge(call.function, f)

    def enters(self, call: Instruction, found: set[Function]) -> bool:
        """Notes what a call through a pointer can enter; True where that is new."""
        known = self.through_pointers.setdefault(call, [])
        new = [f for f in found if self.is_known(f) and f not in known]
        for f in sorted(new, key=lambda f: f.name):
            known.append(f)
            self.add_call(call, f)
        return bool(new)

    def mentioned(self, i: Instruction) -> list[Function]:
        """The functions whose address `i` hands on."""
        values = i.arguments if i.is_call else i.operands
        names = [
            n for v in values if v.kind == "constant" for n in re.findall(r"@([\w.$]+)", v.text)
        ]
        found = [v for v in values if isinstance(v, Function)]
        found += [self.module.functions[n] for n in names if n in self.module.functions]
        return [f for f in dict.fromkeys(found) if self.is_known(f)]

    def related(self, table: Value) -> set[Value]:
        """The tables of virtual functions of the classes that `table` is related to."""
        return self.families.get(table, set())

    def callers(self, f: Function) -> list[Instruction]:
        return self.calls.get(f, [])

    def returns(self, f: Function) -> list[Instruction]:
        return [
            b.terminator for b in f.blocks if b.terminator.opcode == "ret" and b.terminator.operands
        ]

    def writes_argument(self, call: Instruction, n: int) -> bool:
        target = self.rules.target(call.callee.name)
        return target is None or n == target

    def calls_that_lead_to(self, where: Function, f: Function) -> list[Instruction]:
        """The calls in `where` below which `f` runs."""
        if f not in self.graph or where not in self.graph:
            return []
        above = nx.ancestors(self.graph, f) | {f}
        return [
            i for i in where.instructions if i.is_call and any(c in above for c in self.callees(i))
        ]

    def steps(self, f: Function) -> nx.DiGraph:
        """Which instruction can follow which, exceptions included."""
        if f not in self.step_graphs:
            graph = self.step_graphs[f] = nx.DiGraph()
            for b in f.blocks:
                nx.add_path(graph, b.instructions)
                graph.add_edges_from((b.terminator, s.instructions[0]) for s in b.terminator.blocks)
        return self.step_graphs[f]


def hierarchy(module: Module) -> dict[Value, set[Value]]:
    """For each table of virtual functions those of classes with a base in common."""
    ids = dict(re.findall(r'^!(\d+) = !\{i64 \d+, !"(_ZTS[^"]*)"\}', module.text, re.M))
    members: dict[str, set[Value]] = {}
    bases: dict[Value, set[str]] = {}
    for name, g in module.globals.items():
        if name.startswith("_ZTV"):
            types = {ids[n] for n in re.findall(r"!type !(\d+)", g.text) if n in ids}
            bases[g] = {t for t in types if not t.startswith("_ZTSM")}
            for t in bases[g]:
                members.setdefault(t, set()).add(g)
    return {g: set().union(*(members[t] for t in types)) for g, types in bases.items()}


def source_type(i: Instruction) -> str:
    """The type that a getelementptr goes through."""
    found = re.search(r"getelementptr (?:inbounds |nuw |nusw |inrange\S* )*(.*?), ptr ", i.text)
    assert found
    return found[1]


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
