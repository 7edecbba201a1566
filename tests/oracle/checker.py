"""Which comparisons of a module are TPCs, by docs/reference/analysis.md alone."""

from __future__ import annotations

import re
import struct
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

from tests.oracle.control import ControlDependence
from tests.oracle.ir import Argument, Function, Instruction, Place, Value, number, parse
from tests.oracle.memory import SILENT, Memory, Program, Write, extent, source_type
from tests.oracle.throws import Throws, asks_for, is_throw

RELATIONS = {"eq": "==", "ne": "!=", "gt": ">", "ge": ">=", "lt": "<", "le": "<="}
SWAPPED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}
CASTS = {"trunc", "zext", "sext", "fptrunc", "fpext", "fptosi", "fptoui", "sitofp", "uitofp"}
ARITHMETIC = {"add", "sub", "mul", "sdiv", "udiv", "fadd", "fsub", "fmul", "fdiv"}
Context = tuple[Instruction, ...]


@dataclass(frozen=True)
class How:
    """What was done to a parameter's value: scale * x + offset, or more than that (`other`).

    `bits` is the width of an integer type that the value is known to fit into; 0: none.
    `repeated`: it was done so often, in a loop, that it is not kept apart any more.
    """

    scale: float = 1.0
    offset: float = 0.0
    other: bool = False
    bits: int = 0
    repeated: bool = False

    @property
    def is_none(self) -> bool:
        return (self.scale, self.offset, self.other) == (1.0, 0.0, False)

    def affine(self, scale: float, offset: float) -> How:
        changed = self.scale * scale, self.offset * scale + offset
        return How(*changed, self.other, repeated=self.repeated)

    def anything(self, bits: int = 0) -> How:
        return How(other=True, bits=bits, repeated=self.repeated)

    @property
    def type(self) -> str:
        return "parameter" if self.is_none else "repeated" if self.repeated else "derived"


@dataclass(frozen=True)
class State:
    """A value on the way forward; `origin` is what it was before it was merged with others.

    `is_data`: it went through a loop that moves it on.
    """

    value: Value
    how: How
    context: Context
    origin: Value | None = None
    is_data: bool = False


class Rules:
    """The rules that the test header ros/ros.h has, by mangled name."""

    READ = re.compile(r"_ZNK3ros10NodeHandle(5param|8getParam)")
    EXPOSING = re.compile(r"_ZNK?3ros(9Publisher7publish|13ServiceClient4call)")
    OPAQUE = re.compile(r"_ZNK?St7__cxx1112basic_string")

    def is_opaque(self, name: str) -> bool:
        return any(r.match(name) for r in (self.READ, self.EXPOSING, self.OPAQUE))

    def target(self, name: str) -> int | None:
        """The argument of a read that the value is written to."""
        return 2 if self.READ.match(name) else None

    def always_writes(self, name: str) -> bool:
        """True for the read that has a default: the variable has a new value in any case."""
        return name.startswith("_ZNK3ros10NodeHandle5param")


@dataclass(frozen=True, order=True)
class Finding:
    """A threshold predicate comparison.

    `is_data`: what is compared may be called data instead, see DATA in the README.
    """

    file: str
    line: int
    column: int
    parameter: str
    type: str
    relation: str
    distance: int
    is_data: bool


@dataclass(frozen=True)
class Compared:
    """A place where a parameter decides: a comparison, or a flag's value.

    `predicate` is one that it decides, or the comparison itself: its outcome may be shown.
    """

    parameter: str
    type: str
    relation: str
    place: Instruction
    predicate: Instruction
    is_data: bool = False


def check(text: str, excluded: str) -> set[Finding]:
    """The findings of a module, in code that is not below `excluded` nor below /usr."""

    def is_user(file: str) -> bool:
        return bool(file) and not file.startswith((excluded, "/usr/"))

    module, rules = parse(text, is_user), Rules()
    return Checker(Memory(module, Program(module, rules)), rules, is_user).findings()


class Entry(NamedTuple):
    """An instruction in the slice, and why: for its value, that it runs, or what it throws.

    `called`: so does whether its function is called.
    """

    item: Instruction
    why: str
    called: bool = True


class Checker:
    """The analysis of one module."""

    def __init__(self, memory: Memory, rules: Rules, is_user: Callable[[str], bool]) -> None:
        self.memory, self.program, self.rules = memory, memory.program, rules
        self.is_user = is_user
        self.throws = Throws(self.program, lambda place: is_user(place.file))
        self.control = {f: ControlDependence(f, self.throws) for f in self.program.functions}
        self.users: dict[Value, list[Instruction]] = defaultdict(list)
        self.sees: dict[Instruction, list[Instruction]] = defaultdict(list)
        for i in self.program.instructions:
            for o in dict.fromkeys(i.operands):
                self.users[o].append(i)
            if i.opcode == "load":
                for d in self.memory.definitions(i):
                    self.sees[d].append(i)
        self.distance: dict[Instruction, int] = {}
        self.shown: dict[Instruction, int] = {}
        self.slice()

    def findings(self) -> set[Finding]:
        nearest: dict[tuple[str, ...], int] = {}
        plain: set[tuple[str, ...]] = set()
        comparisons = self.comparisons()
        deciding = {c.place for c in comparisons if c.predicate in self.distance}
        for c in comparisons:
            place = c.place.place
            distance = self.distance.get(c.predicate)
            if c.predicate is c.place and c.place not in deciding:
                distance = self.shown.get(c.place)
            if distance is not None and place and self.is_user(place.file) and place.line:
                what = (place, c.parameter, c.type, c.relation)
                nearest[what] = min(distance, nearest.get(what, distance))
                if not c.is_data:
                    plain.add(what)
        return {
            Finding(
                p.file, p.line, p.column, parameter, type_, relation, distance, what not in plain
            )
            for what, distance in nearest.items()
            for p, parameter, type_, relation in [what]
        }

    # The slice, by rounds ---------------------------------------------------

    def slice(self) -> None:
        """Breadth first from the exposing calls.

        `distance` of the predicates on the way; `shown`: of the comparisons whose outcome is a
        value on it.
        """
        exposing = [i for i in self.program.instructions if i.is_call and self.exposes(i)]
        this = [Entry(i, "data") for i in exposing]
        entered, number_ = {(i, "data") for i in exposing} | {(i, "called") for i in exposing}, 1
        while this:
            following: list[Entry] = []
            for item, why, called in this:
                for nearer in self.choosers_of(item):
                    self.distance.setdefault(nearer, number_)
                following += self.step(item, why, called)
            this = []
            for item, why, called in dict.fromkeys(following):
                if why == "data" and item.opcode in ("icmp", "fcmp"):
                    self.shown.setdefault(item, number_)
                if (item, why) not in entered:
                    this.append(Entry(item, why, called))
                elif called and (item, "called") not in entered:
                    # Only now it matters that its function is called.
                    this.append(Entry(item, "control"))
                entered |= {(item, why), *([(item, "called")] if called else [])}
            number_ += 1

    def exposes(self, call: Instruction) -> bool:
        return bool(self.rules.EXPOSING.match(call.callee.name))

    def choosers_of(self, item: Instruction) -> set[Instruction]:
        """The predicates that control `item`, or that choose its value."""
        control = self.control[item.function]
        found, _ = control.controllers(item.block, item)
        if item.opcode == "phi":
            for before in item.blocks:
                found = found | control.choosers(before, item.block)
        if item.opcode == "select":
            found = found | {item}
        return found

    def step(self, item: Instruction, why: str, called: bool) -> list[Entry]:
        """What enters the round after that of `item`.

        Without `called` it matters for the result of a call on the way: that call decides whether
        it runs, and other calls of its function do not.
        """
        # Which exception is there, what throws it decides, not what a landing pad hands over.
        out = [Entry(p, how_decides(p), called) for p in self.choosers_of(item)]
        _, always = self.control[item.function].controllers(item.block, item)
        if always and called:
            out += [Entry(c, "control") for c in self.program.callers(item.function)]
            # What is handed on to be called runs only if it was; one of several is a value.
            mentions = self.program.mentions.get(item.function, [])
            out += [Entry(m, "data" if is_choice(m) else "control") for m in mentions]
        if item.is_call and (chosen := self.object_of(item)) is not None:
            out += [Entry(i, "data", called) for i in self.instructions_of(chosen)]
        if why == "throws":
            # A call that may throw enters as a predicate does, and then what throws below it.
            inner = [i for f in self.program.callees(item) for i in self.throws.leaving(f)]
            out += [Entry(i, "control" if is_throw(i) else "throws") for i in inner]
        if why in ("control", "throws"):
            return out
        known = item.is_call and self.program.callees(item)
        shown = item.operands
        if item.is_call and self.exposes(item):
            out += [Entry(i, "data", called) for i in self.publisher(item.arguments[0])]
            shown = item.operands[1:]
        for o in [] if known else shown:
            out += [Entry(i, "data", called) for i in self.instructions_of(o)]
        if item.opcode == "load":
            definitions = self.memory.definitions(item)
            # What is copied is a definition of its own; of the copy it matters that it is done.
            copied = {c.by for c in self.memory.copies}
            out += [
                Entry(d, "control" if d in copied else "data")
                for d in definitions
                if not self.is_constructed(d)
            ]
        elif known:
            returns = [r for f in known for r in self.program.returns(f)]
            out += [Entry(r, "data", called=False) for r in returns]
        elif item.is_call and self.exposes(item):
            out += [Entry(w, "data") for w in self.writes_behind(item)]
        elif item.is_call and not SILENT.match(item.callee.name):
            out += [Entry(w, "data") for w in self.handed(item)]
        return out

    def object_of(self, call: Instruction) -> Value | None:
        """The object that a virtual function is called on: it decides which one runs."""
        at: Value | None = None if isinstance(call.callee, Function) else call.callee
        for opcode in ("load", "getelementptr", "load"):
            if isinstance(at, Instruction) and at.opcode == opcode:
                at = at.operands[0]
            elif opcode != "getelementptr":
                return None
        return at if at in call.arguments[:2] and self.program.callees(call) else None

    def instructions_of(self, value: Value) -> set[Instruction]:
        """`value`; for an argument what the calls hand over, which may be arguments again."""
        out: set[Instruction] = set()
        seen, todo = {value}, [value]
        while todo:
            at = todo.pop()
            if isinstance(at, Instruction) and at.opcode == "getelementptr":
                # An address is no step of its own; what chooses it is.
                new = set(at.operands) - seen
                seen |= new
                todo += new
            elif isinstance(at, Instruction) and at.opcode != "alloca":
                out.add(at)
            elif isinstance(at, Argument):
                calls = self.program.callers(at.function)
                new = {c.arguments[at.index] for c in calls if at.index < len(c.arguments)} - seen
                seen |= new
                todo += new
        return out

    def publisher(self, value: Value) -> set[Instruction]:
        """What chooses a publisher, not how the object that it is in came about."""
        out: set[Instruction] = set()
        seen, todo = {value}, [(value, True)]
        while todo:
            at, is_itself = todo.pop()
            new: list[Value] = []
            if isinstance(at, Argument):
                calls = self.program.callers(at.function)
                new = [c.arguments[at.index] for c in calls if at.index < len(c.arguments)]
            elif isinstance(at, Instruction) and at.opcode == "getelementptr":
                out |= {i for index in at.operands[1:] for i in self.instructions_of(index)}
                new, is_itself = at.operands[:1], False
            elif isinstance(at, Instruction):
                returned = at.is_call and any(
                    self.is_user(f.file) for f in self.program.callees(at)
                )
                if is_choice(at) or (is_itself and (at.opcode == "load" or returned)):
                    out.add(at)
            todo += [(v, is_itself) for v in new if v not in seen]
            seen |= set(new)
        return out

    def is_constructed(self, write: Instruction) -> bool:
        """What a library sets to a constant it sets in a constructor: that decides nothing."""
        constant = write.opcode == "store" and write.operands[0].kind == "constant"
        return constant and not self.is_user(write.function.file)

    def handed(self, call: Instruction) -> set[Instruction]:
        """The writes of the variables that an unknown function is handed: it can read them."""
        out: set[Instruction] = set()
        for a in call.arguments:
            if a is not self.memory.replaced(call):
                for at in self.memory.of(a):
                    out |= self.alive(self.memory.writes_to(at, 1), call)
        return out

    def alive(self, writes: set[Write], call: Instruction) -> set[Instruction]:
        """Those of `writes` that `call`, which is handed what they write, can see."""
        out: set[Instruction] = set()
        for w in writes:
            same = {x.by for x in writes if x.at == w.at}
            if w.by in self.memory.reaching(w.at, w.size or 0, same, call):
                out.add(w.by)
        return out - {call}

    def writes_behind(self, call: Instruction) -> set[Instruction]:
        """The writes of all that can be reached from the arguments of `call`."""
        out: set[Instruction] = set()
        seen: set[object] = set()
        # The object that exposes, a publisher, is not what is exposed.
        shown = list(enumerate(call.arguments))[1:]
        todo = [(at, extent(call, n)) for n, a in shown for at in self.memory.of(a)]
        while todo:
            (o, at), size = todo.pop()
            if (o, at, size) in seen:
                continue
            seen.add((o, at, size))
            end = 1 << 30 if size is None else at + size
            out |= self.alive(self.memory.writes_to((o, at), end - at), call)
            for c in self.memory.copies:
                if c.to[0] is o and c.to[1] < end and at < c.to[1] + c.size:
                    out.add(c.by)
                    todo.append((c.source, c.size))
            for (holder, offset), targets in self.memory.stored.items():
                if holder is o and at <= offset < end:
                    todo += [((t, 0), None) for t, _ in targets]
        return out

    # The way forward --------------------------------------------------------

    def comparisons(self) -> set[Compared]:
        """All places where a parameter's value decides, in the slice or not."""
        out: set[Compared] = set()
        for read in self.program.instructions:
            if read.is_call and self.rules.READ.match(read.callee.name):
                name = self.name_of(read)
                for load in self.sees[read]:
                    self.follow(name, load, out)
        return out

    def name_of(self, read: Instruction) -> str:
        """The constant that the name, a std::string, was constructed from."""
        for i in self.users[read.arguments[1]]:
            if i.is_call and i.arguments[0] is read.arguments[1] and len(i.arguments) > 1:
                text = i.arguments[1]
                found = re.search(r'c"([^"\\]*)\\00"', text.text)
                if found:
                    return found[1]
        return "<dynamic>"

    def follow(self, name: str, begin: Instruction, out: set[Compared]) -> None:
        """From the value `begin` to the comparisons."""
        todo = [State(begin, How(other=is_limit(begin)), ())]
        seen = set(todo)
        ways: dict[Value, set[How]] = defaultdict(set)
        while todo:
            at = todo.pop()
            for user in self.users[at.value]:
                for found in self.after(name, at, user, out):
                    item = found
                    if is_limit(found.value):
                        # Arithmetic, as if it were one instruction: what it was is behind.
                        item = replace(found, how=found.how.anything(), origin=None)
                    ways[item.value].add(item.how)
                    # In a loop, arithmetic has no end.
                    many = len(ways[item.value]) > 6 and not item.how.is_none
                    how = How(other=True, repeated=True)
                    new = replace(item, how=how) if many else item
                    if new not in seen:
                        seen.add(new)
                        todo.append(new)

    def after(self, name: str, at: State, user: Instruction, out: set[Compared]) -> list[State]:
        """Where `user` carries the value on to; what it compares or decides goes into `out`."""
        value, how, context, origin = at.value, at.how, at.context, at.origin
        is_data = at.is_data or self.is_stepped(user)
        if user.opcode in ("icmp", "fcmp"):
            self.compared(name, at, user, out)
        elif is_joined(user, value):
            if how.is_none:
                self.flag(name, value, self.decides(user, context), out)
        elif decides_by(user, value):
            if how.is_none:
                out.add(Compared(name, "flag", "flag", origin or user, user))
            elif user.opcode == "switch":
                out.add(Compared(name, how.type, "flag", origin or user, user))
        elif user.opcode in CASTS:
            return [State(user, cast(how, user), context, origin, is_data)]
        elif changed := self.computed(how, user, value):
            return [State(user, changed, context, None, is_data)]
        else:
            # What is merged with other values stands where it was its own.
            begins = origin or (value if isinstance(value, Instruction) else None)
            merged = begins if user.opcode in ("phi", "select") else None
            kept = origin if user.opcode == "freeze" else merged
            return [State(v, how, c, kept, is_data) for v, c in self.carried(user, value, context)]
        return []

    def is_stepped(self, merge: Instruction) -> bool:
        """True for a merge whose value a loop computes from the last one."""
        if merge.opcode != "phi":
            return False
        before = self.sources(merge)
        return any(is_step(i) and merge in self.sources(i) for i in before)

    def sources(self, value: Instruction) -> set[Instruction]:
        """The instructions of its function that `value` is computed from."""
        seen, todo = set(), list(value.operands)
        while todo:
            at = todo.pop()
            if isinstance(at, Instruction) and at not in seen and is_arithmetic(at):
                seen.add(at)
                todo += at.operands
        return seen

    def is_configured(self, value: Value) -> bool:
        """True if `value` comes from constants and parameters alone, as far as can be seen."""
        seen, todo = {value}, [value]
        while todo:
            at = todo.pop()
            new: list[Value] = []
            if isinstance(at, Argument):
                calls = self.program.callers(at.function)
                if not calls or any(at.index >= len(c.arguments) for c in calls):
                    return False
                new = [c.arguments[at.index] for c in calls]
            elif isinstance(at, Instruction) and at.opcode == "load":
                for write in self.memory.definitions(at):
                    if write.opcode == "store":
                        new.append(write.operands[0])
                    elif not (write.is_call and self.rules.READ.match(write.callee.name)):
                        return False
            elif isinstance(at, Instruction) and at.is_call and self.program.callees(at):
                new = [
                    v
                    for f in self.program.callees(at)
                    for r in self.program.returns(f)
                    for v in r.operands
                ]
            elif isinstance(at, Instruction):
                if not is_arithmetic(at):
                    return False
                new = at.operands[1:] if at.opcode == "select" else at.operands
            todo += [v for v in new if v not in seen]
            seen |= set(new)
        return True

    def flag(
        self, name: str, value: Value, decided: dict[Instruction, bool], out: set[Compared]
    ) -> None:
        """A flag stands at the branch; where its outcome goes on to that, where it is read."""
        for predicate, direct in decided.items():
            out.add(Compared(name, "flag", "flag", predicate if direct else value, predicate))

    def compared(self, name: str, at: State, by: Instruction, out: set[Compared]) -> None:
        left, right = by.operands
        if left is right:
            return
        is_flag = by.predicate in ("ne", "une") and is_zero(right) and at.how.is_none
        relation = RELATIONS[by.predicate[-2:]]
        relation = SWAPPED[relation] if left is at.value else relation
        if is_flag:
            self.flag(name, by, self.decides(by, at.context), out)
            return
        other = right if left is at.value else left
        is_data = at.is_data or (other.kind == "constant" and not self.is_configured(at.value))
        for predicate in [by, *self.decides(by, at.context)]:
            out.add(Compared(name, at.how.type, relation, by, predicate, is_data))

    def computed(self, how: How, by: Instruction, value: Value) -> How | None:
        """The arithmetic after `by`; None where that is none with constants alone."""
        if by.opcode == "fneg":
            return how.affine(-1, 0)
        if by.is_call and by.callee.name in ("llvm.fabs.f64", "fabs"):
            return how.anything()
        if by.opcode not in ARITHMETIC:
            return None
        left, right = by.operands
        if by.opcode in ("mul", "fmul") and (left is right or self.is_same_variable(left, right)):
            return how.anything()
        constant = constant_number(right if left is value else left)
        operation = by.opcode.removeprefix("f")
        if constant is None:
            return None
        if operation == "add":
            return how.affine(1, constant)
        if operation == "sub":
            return how.affine(1, -constant) if left is value else how.affine(-1, constant)
        if operation == "mul":
            return how.affine(constant, 0)
        if by.opcode == "fdiv" and left is value:
            # By a division, not by the reciprocal: that is not always the same number.
            return replace(how, scale=how.scale / constant, offset=how.offset / constant, bits=0)
        return how.anything()

    def is_same_variable(self, a: Value, b: Value) -> bool:
        """True where both are loads of one variable, `x * x` or `x * -x`, by the same pointer."""
        a, b = positive(a), positive(b)
        if not all(isinstance(v, Instruction) and v.opcode == "load" for v in (a, b)):
            return False
        same = self.is_same_pointer(a.operands[0], b.operands[0])
        return same and self.memory.definitions(a) == self.memory.definitions(b)

    def is_same_pointer(self, a: Value, b: Value) -> bool:
        """True where both are computed in the same way from the same, or name one variable."""
        first = self.memory.named(a)
        if a is b or (first is not None and first == self.memory.named(b)):
            return True
        parts = [v.operands for v in (a, b) if isinstance(v, Instruction)]
        if len(parts) < 2 or a.opcode != b.opcode:
            return False
        if a.opcode == "load":
            return self.is_same_variable(a, b)
        if a.opcode != "getelementptr" or source_type(a) != source_type(b):
            return False
        steps = [[number(v) for v in p[1:]] for p in parts]
        same = steps[0] == steps[1] and None not in steps[0]
        return same and self.is_same_pointer(parts[0][0], parts[1][0])

    def carried(
        self, user: Instruction, value: Value, context: Context
    ) -> list[tuple[Value, Context]]:
        """The values that `user` makes of `value` without changing it."""
        if user.opcode in CASTS | {"phi", "freeze"}:
            return [(user, context)]
        if user.opcode == "select" and user.operands[0] is not value:
            return [(user, context)]
        if user.opcode == "store" and user.operands[0] is value:
            return [(load, self.through_memory(user, load, context)) for load in self.sees[user]]
        if user.is_call:
            return [
                (f.arguments[n], push(context, user))
                for f in self.program.callees(user)
                for n, a in enumerate(user.arguments)
                if a is value and n < len(f.arguments)
            ]
        if user.opcode == "ret":
            calls = self.program.callers(user.function)
            if context:
                return [(context[-1], context[:-1])] if context[-1] in calls else []
            return [(c, ()) for c in calls]
        return []

    def through_memory(self, store: Instruction, load: Instruction, context: Context) -> Context:
        """Inside one run of a function the call that led into it is still known."""
        locations = self.memory.of(load.operands[0])
        own = all(
            isinstance(o, Instruction) and o.opcode == "alloca" and o.function is load.function
            for o, _ in locations
        )
        return context if own and store.function is load.function else ()

    def decides(self, outcome: Instruction, context: Context) -> dict[Instruction, bool]:
        """The predicates that the truth value `outcome` decides; True: without a detour.

        A detour is a merge, a variable or a call.
        """
        found: dict[Instruction, bool] = {}
        begin = (outcome, context, not is_condition_end(outcome))
        todo, seen = [begin], {begin}
        while todo:
            value, at, direct = todo.pop()
            for user in self.users[value]:
                if decides_by(user, value):
                    found[user] = found.get(user, False) or direct
                    continue
                new = [
                    (v, c, direct and user.opcode in CASTS | {"freeze", "xor"})
                    for v, c in self.carried(user, value, at)
                ]
                if user.opcode in ("xor", "and", "or", "icmp"):
                    new = [(user, at, direct)]
                for item in new:
                    if item not in seen:
                        seen.add(item)
                        todo.append(item)
        return found


def positive(v: Value) -> Value:
    """What `v` is the negative of, if of anything."""
    while isinstance(v, Instruction) and (
        v.opcode == "fneg" or (v.opcode == "sub" and number(v.operands[0]) == 0)
    ):
        v = v.operands[-1]
    return v


def is_limit(value: Value) -> bool:
    """True for the smaller or larger one of a constant and another value: std::min, x < 3 ? 3 : x.

    That is a merge of the two that the predicate which decides compares, of their values or, of
    what std::min returns, of references to them.
    """
    merge = value
    if isinstance(value, Instruction) and value.opcode == "load":
        merge = value.operands[0]
    if not isinstance(merge, Instruction) or (merge.type == "ptr") != (merge is not value):
        return False
    sides = merge.operands[1:] if merge.opcode == "select" else merge.operands
    if merge.opcode not in ("phi", "select") or len(sides) != 2:
        return False
    condition = merge.operands[0] if merge.opcode == "select" else condition_of(merge)
    if not isinstance(condition, Instruction) or condition.opcode not in ("icmp", "fcmp"):
        return False
    if condition.predicate[-2:] not in ("gt", "ge", "lt", "le"):
        return False
    compared = condition.operands
    pairs = (sides, sides[::-1])
    same = any(all(is_side(c, s) for c, s in zip(compared, p, strict=True)) for p in pairs)
    return same and sum(constant_side(s) is not None for s in sides) == 1


def condition_of(phi: Instruction) -> Value | None:
    """What decides by which of two ways a merge is come to, where one branch does."""
    heads = []
    for block in phi.blocks:
        before = [b for b in block.function.blocks if block in b.terminator.blocks]
        is_head = len(block.terminator.blocks) == 2
        heads.append(block if is_head else before[0] if len(before) == 1 else None)
    same = heads[0] is not None and heads[0] is heads[1] and len(heads[0].terminator.blocks) == 2
    return heads[0].terminator.operands[0] if same else None


def is_side(compared: Value, side: Value) -> bool:
    """True where the value that is compared is the one that is merged, or what it refers to."""
    if is_same(compared, side):
        return True
    if isinstance(compared, Instruction) and compared.opcode == "load":
        again = isinstance(side, Instruction) and side.opcode == "load"
        if is_same(compared.operands[0], side.operands[0] if again else side):
            return True
    known = constant_side(side)
    return known is not None and constant_number(compared) == known


def is_arithmetic(i: Instruction) -> bool:
    """True for what computes or merges values of its own function."""
    pure = i.is_call and i.callee.name.startswith(("llvm.fabs", "llvm.fmuladd", "llvm.fma"))
    return i.opcode in ARITHMETIC | CASTS | {"phi", "select", "freeze", "fneg"} or pure


def is_step(i: Instruction) -> bool:
    """True for what gives the next value of a series; a count by a constant is none."""
    if i.opcode in ("add", "sub", "mul"):
        return all(o.kind != "constant" for o in i.operands)
    return i.opcode in ("fadd", "fsub", "fmul", "fdiv") or i.is_call


def is_choice(i: Instruction) -> bool:
    """True for one of several values."""
    return i.opcode in ("phi", "select")


def is_same(a: Value, b: Value) -> bool:
    return a is b or (a.kind == b.kind == "constant" and a.text == b.text)


def constant_side(side: Value) -> float | None:
    """The number that one side of a merge is, or that the temporary that it refers to has."""
    if not (isinstance(side, Instruction) and side.opcode == "alloca"):
        return constant_number(side)
    users = [i for i in side.function.instructions if side in i.operands]
    stored = [i.operands[0] for i in users if i.opcode == "store" and i.operands[1] is side]
    # Who else is handed it may write to it; what ends it is not in the module's own code.
    handed = [i for i in users if i.is_call and not SILENT.match(i.callee.name)]
    return constant_number(stored[0]) if len(stored) == 1 and not handed else None


def how_decides(predicate: Instruction) -> str:
    """What of a predicate enters the slice."""
    if predicate.is_call:
        return "throws"
    return "control" if predicate.operands and asks_for(predicate.operands[0]) else "data"


def is_joined(user: Instruction, value: Value) -> bool:
    """True where `user` makes a truth value of a flag: negates it, joins it with another one."""
    logical = user.opcode in ("xor", "and", "or") and user.type == "i1"
    return logical or (is_condition_end(user) and isinstance(value, Instruction))


def is_condition_end(user: Instruction) -> bool:
    """True where `user` is what && or || makes of the last operand: else the way decides."""
    constant = [o for o in user.operands if o.kind == "constant"]
    return user.opcode == "phi" and user.type == "i1" and len(constant) == len(user.operands) - 1


def decides_by(user: Instruction, value: Value) -> bool:
    """True where `user` is a predicate and `value` what it decides by."""
    return user.opcode in ("br", "switch", "select") and user.operands[0] is value


def constant_number(v: Value) -> float | None:
    """The value of a constant; None where `v` is none."""
    if (known := number(v)) is not None:
        return float(known)
    found = re.fullmatch(r"double ([-+.\w]*\d[-+.\w]*)", v.text) if v.kind == "constant" else None
    if not found:
        return None
    if found[1].startswith("0x"):
        return float(struct.unpack(">d", bytes.fromhex(found[1][2:].zfill(16)))[0])
    return float(found[1])


def cast(how: How, by: Instruction) -> How:
    """The arithmetic after a conversion: it can cut off bits or a fraction."""
    begin, to = (bits_of(t) for t in (by.operand_type, by.type))
    if by.opcode == "trunc" and to > 1 and not 0 < how.bits <= to:
        return how.anything(to)
    if by.opcode in ("fptosi", "fptoui") and not how.bits:
        return how.anything(to)
    if by.opcode in ("zext", "sext", "uitofp", "sitofp"):
        return replace(how, bits=how.bits or begin)
    return how


def bits_of(type_: str) -> int:
    return int(type_[1:]) if re.fullmatch(r"i\d+", type_) else 0


def is_zero(v: Value) -> bool:
    return number(v) == 0 or v.text.endswith(" 0.000000e+00")


def push(context: Context, call: Instruction) -> Context:
    """`context` below `call`; a call that is in it already is not entered a second time."""
    return context if call in context else (*context, call)


__all__ = ["Checker", "Finding", "Function", "Place", "check"]
