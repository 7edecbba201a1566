"""Random small nodes in C++, as trees, so that a program can be made smaller.

The generator knows nothing of what must be found: whatever compiles is a fair question.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

LIBRARY = "".join(f"#include <{h}>\n" for h in ("algorithm", "cmath", "functional", "memory"))
PROLOGUE = """#include <ros/ros.h>

double sensed(double Old);
bool chance();
void logged(double What);
void mayThrow();
int main() {}
struct First {
  int Unused = 0;
};
"""
TYPES = ("double", "int", "bool")
STARTS = {"double": "0.5", "int": "3", "bool": "false"}
MODES = ("Mode::Off", "Mode::Slow", "Mode::Fast")


@dataclass(frozen=True)
class Statement:
    """Texts and, between braces, bodies of statements."""

    parts: tuple[str | tuple[Statement, ...], ...]

    def lines(self, indent: str) -> Iterator[str]:
        for part in self.parts:
            if isinstance(part, str):
                yield indent + part
            else:
                yield indent + "{"
                for s in part:
                    yield from s.lines(indent + "  ")
                yield indent + "}"

    def smaller(self) -> Iterator[tuple[Statement, ...]]:
        """What can stand instead: a body alone, or itself with a smaller part."""
        for n, part in enumerate(self.parts):
            instead: Iterator[str | tuple[Statement, ...]] = (
                simpler(part) if isinstance(part, str) else smaller(part)
            )
            if isinstance(part, tuple):
                yield part
            for new in instead:
                yield (Statement((*self.parts[:n], new, *self.parts[n + 1 :])),)


def simpler(line: str) -> Iterator[str]:
    """The line with a number, or one of its own parts, for a part in parentheses."""
    for begin in (n for n, c in enumerate(line) if c == "("):
        end, depth = begin, 0
        for end in range(begin, len(line)):
            depth += {"(": 1, ")": -1}.get(line[end], 0)
            if depth == 0:
                break
        inside = line[begin + 1 : end]
        for instead in dict.fromkeys(["1", *re.split(r" (?:[-+*/<>&|?:]|[<>=!&|][=&|]) ", inside)]):
            if len(instead) < len(inside) and instead.count("(") == instead.count(")"):
                yield line[: begin + 1] + instead + line[end:]


def prologue(programs: list[Program]) -> str:
    """What stands before the programs of a file."""
    return (LIBRARY if any(p.extended for p in programs) else "") + PROLOGUE


def smaller(body: tuple[Statement, ...]) -> Iterator[tuple[Statement, ...]]:
    """The bodies with statements less, many first, or with one made smaller."""
    size = len(body)
    while size:
        for n in range(0, len(body), size):
            yield (*body[:n], *body[n + size :])
        size //= 2
    for n, s in enumerate(body):
        for instead in s.smaller():
            yield (*body[:n], *instead, *body[n + 1 :])


@dataclass(frozen=True)
class Program:
    """Declarations in a namespace of their own."""

    name: str
    body: tuple[Statement, ...]
    extended: bool = False

    def text(self) -> str:
        lines = [line for s in self.body for line in s.lines("")]
        return "\n".join([f"namespace {self.name} {{", *lines, f"}} // namespace {self.name}", ""])

    def smaller(self) -> Iterator[Program]:
        for body in smaller(self.body):
            yield replace(self, body=body)


@dataclass
class Callable_:
    """A function that statements can call: `name(arguments)`."""

    name: str
    result: str
    arguments: list[str]
    by_reference: list[bool]


@dataclass
class Scope:
    """What can be named: variables by type, functions, and where one is."""

    variables: dict[str, list[str]]
    constants: dict[str, list[str]]
    functions: list[Callable_]
    publisher: str | None
    handle: str | None
    result: str = "void"
    in_loop: bool = False
    in_try: bool = False
    depth: int = 0
    objects: list[str] = field(default_factory=list)  # of the struct Range
    modes: list[str] = field(default_factory=list)  # of the enumeration Mode
    pointers: list[str] = field(default_factory=list)  # to one of the functions `picks`
    tables: list[str] = field(default_factory=list)  # of two such

    def inner(self, **changes: object) -> Scope:
        return replace(
            self,
            variables={t: list(v) for t, v in self.variables.items()},
            constants={t: list(v) for t, v in self.constants.items()},
            functions=list(self.functions),
            objects=list(self.objects),
            modes=list(self.modes),
            pointers=list(self.pointers),
            tables=list(self.tables),
            **{"depth": self.depth + 1, **changes},
        )


@dataclass
class Generator:
    """Makes one program from a seed."""

    seed: int
    name: str
    extended: bool = False
    random: random.Random = field(init=False)
    count: int = 0
    deepest: int = 2

    def __post_init__(self) -> None:
        self.random = random.Random(self.seed)
        self.deepest = self.random.choice([0, 0, 1, 1, 2, 4])
        self.range_fields: list[tuple[str, str]] = []
        self.picks: list[str] = []
        self.classes: list[str] = []

    def new(self, prefix: str) -> str:
        self.count += 1
        return f"{prefix}{self.count}"

    def one(self, *choices: tuple[int, object]) -> object:
        """One of the (weight, choice)."""
        return self.random.choices([c for _, c in choices], [w for w, _ in choices])[0]

    def chance(self, probability: float) -> bool:
        return self.random.random() < probability

    # Expressions ------------------------------------------------------------

    def variable(self, s: Scope, type_: str) -> str | None:
        known = s.variables[type_] + s.constants[type_]
        # What came last is what a reader would use next.
        return self.random.choice(known[-6:] if self.chance(0.5) else known) if known else None

    def place(self, s: Scope, type_: str) -> str | None:
        known = s.variables[type_]
        return self.random.choice(known) if known else None

    def constant(self, type_: str) -> str:
        if type_ == "double":
            return self.random.choice(["0.5", "1.5", "2.0", "10.0"])
        if type_ == "int":
            return self.random.choice(["1", "2", "3", "7"])
        return self.random.choice(["true", "false"])

    def expression(self, s: Scope, type_: str, depth: int = 0) -> str:
        if type_ == "bool":
            return self.condition(s, depth)
        name = self.variable(s, type_)
        if name is None or depth > 2:
            return name or self.constant(type_)
        kinds = [
            (8, "name"), (3, "constant"), (4, "scaled"), (2, "both"), (2, "call"), (2, "chosen"),
            (1, "cast"), (1, "sensed"), (1, "negative"), (1, "square"),
        ]  # fmt: skip
        if self.extended:
            kinds += [(3, "limited"), (1 if type_ == "double" and s.tables else 0, "picked")]
        kind = self.one(*kinds)
        if kind in ("limited", "picked"):
            return getattr(self, kind)(s, type_, name, depth)
        if kind == "constant":
            return self.constant(type_)
        if kind == "scaled":
            operator = self.random.choice("+-*" if type_ == "int" else "+-*/")
            return f"({name} {operator} {self.constant(type_)})"
        if kind == "both":
            return f"({name} {self.random.choice('+-*')} {self.expression(s, type_, depth + 1)})"
        if kind == "call":
            return self.call(s, type_, depth) or name
        if kind == "chosen":
            return (
                f"({self.condition(s, depth + 1)} ? {self.expression(s, type_, depth + 1)}"
                f" : {self.expression(s, type_, depth + 1)})"
            )
        if kind == "cast":
            other = "int" if type_ == "double" else "double"
            return f"static_cast<{type_}>({self.expression(s, other, depth + 1)})"
        if kind == "sensed" and type_ == "double":
            return f"sensed({name})"
        return {"negative": f"(-{name})", "square": f"({name} * {name})"}.get(kind, name)

    def picked(self, s: Scope, type_: str, name: str, depth: int) -> str:
        """A call of one of the functions in a table."""
        which = self.expression(s, "int", depth + 1)
        given = self.expression(s, type_, depth + 1)
        return f"{self.random.choice(s.tables)}[({which}) & 1]({given})"

    def limited(self, s: Scope, type_: str, name: str, depth: int) -> str:
        """A value that a function of the library compares with another one."""
        kind = self.one((2, "min"), (2, "max"), (1, "clamp"), (2, "fabs"))
        other = self.one((1, self.constant(type_)), (1, self.variable(s, type_)))
        if kind == "fabs" and type_ == "double":
            return f"std::fabs({self.expression(s, type_, depth + 1)})"
        if kind == "clamp":
            low, high = ("0.5", "10.0") if type_ == "double" else ("1", "7")
            low = self.one((2, low), (1, other))
            return f"std::clamp({name}, {low}, {high})"
        function = "max" if kind == "max" else "min"
        if self.chance(0.4):
            other = self.one((1, f"({name} + {other})"), (1, f"(-{other})"))
        return f"std::{function}({', '.join(self.random.sample([name, other], 2))})"

    def condition(self, s: Scope, depth: int = 0) -> str:
        kinds = [
            (9, "compare"), (4, "name"), (3 if depth < 2 else 0, "and"),
            (3 if depth < 2 else 0, "or"), (1, "not"), (2, "call"), (1, "chance"),
            (1 if depth < 2 else 0, "chosen"), (1 if depth < 2 else 0, "joined"),
        ]  # fmt: skip
        kind = self.one(*kinds, *([(2, "mode")] if s.modes else []))
        if kind == "mode":
            operator = self.random.choice(["==", "!="])
            return f"({self.random.choice(s.modes)} {operator} {self.random.choice(MODES)})"
        if kind == "name" and (name := self.variable(s, "bool")):
            return name
        if kind in ("and", "or"):
            operator = "&&" if kind == "and" else "||"
            return f"({self.condition(s, depth + 1)} {operator} {self.condition(s, depth + 1)})"
        if kind == "not":
            return f"!({self.condition(s, depth + 1)})"
        if kind == "call" and (call := self.call(s, "bool", depth)):
            return call
        if kind == "chance":
            return "chance()"
        if kind == "chosen":
            conditions = [self.condition(s, depth + 1) for _ in range(3)]
            return "({} ? {} : {})".format(*conditions)
        if kind == "joined":
            left, operator = self.comparison(s, depth), self.random.choice("&|")
            return f"({left} {operator} {self.comparison(s, depth)})"
        return self.comparison(s, depth)

    def comparison(self, s: Scope, depth: int) -> str:
        type_ = self.one((3, "double"), (2, "int"))
        operator = self.one((3, "<"), (3, ">"), (1, "<="), (1, ">="), (1, "=="), (1, "!="))
        left = self.expression(s, type_, depth + 1)
        right = self.expression(s, type_, depth + 1)
        return f"({left} {operator} {right})"

    def call(self, s: Scope, type_: str, depth: int = 0) -> str | None:
        known = [f for f in s.functions if f.result == type_]
        if not known:
            return None
        f = self.random.choice(known)
        arguments = []
        for t, by_reference in zip(f.arguments, f.by_reference, strict=True):
            if by_reference:
                place = self.place(s, t)
                if place is None:
                    return None
                arguments.append(place)
            else:
                arguments.append(self.expression(s, t, max(depth + 1, 1)))
        return f"{f.name}({', '.join(arguments)})"

    # Statements -------------------------------------------------------------

    def body(self, s: Scope, size: int) -> tuple[Statement, ...]:
        s = s.inner()
        return tuple(made for _ in range(size) for made in self.statement(s))

    def small(self, s: Scope, **changes: object) -> tuple[Statement, ...]:
        inner = s.inner(**changes) if changes else s
        return self.body(inner, self.random.randint(1, 3 if s.depth < self.deepest else 1))

    def statement(self, s: Scope) -> list[Statement]:
        deep = s.depth > self.deepest
        kinds: list[tuple[int, Callable[[Scope], list[Statement] | None]]] = [
            (5, self.assign),
            (3, self.declare),
            (5, self.expose),
            (3 if s.handle else 0, self.read),
            (2, self.log),
            (2, self.plain_call),
            (0 if deep else 8, self.branch),
            (0 if deep else 3, self.loop),
            (0 if deep else 1, self.switch),
            (0 if deep else 1, self.jump),
            (0 if deep else 1, self.attempt),
            (0 if deep else 1, self.cleaned),
            (2, self.leave),
        ]
        if self.extended:
            kinds += [
                (4 if s.objects else 0, self.copy),
                (0 if deep else 3, self.called_at_once),
                (2 if s.modes else 0, self.set_mode),
                (0 if deep or not s.modes else 2, self.switch_mode),
                (2 if s.pointers else 0, self.point),
                (1, self.keep),
                (1, self.throw),
                (0 if deep or not s.handle else 3, self.read_if),
            ]
        made = self.one(*kinds)(s)
        return made or []

    def assign(self, s: Scope) -> list[Statement] | None:
        type_ = self.one((4, "double"), (3, "int"), (3, "bool"))
        place = self.place(s, type_)
        if place is None:
            return None
        if type_ != "bool" and self.chance(0.25):
            return [
                text(f"{place} {self.random.choice(['+=', '-=', '*='])} {self.constant(type_)};")
            ]
        if type_ == "int" and self.chance(0.3):
            return [text(f"++{place};")]
        return [text(f"{place} = {self.expression(s, type_)};")]

    def declare(self, s: Scope) -> list[Statement]:
        type_ = self.random.choice(TYPES)
        name = self.new("L")
        made = [text(f"{type_} {name} = {self.expression(s, type_)};")]
        s.variables[type_].append(name)
        return made

    def expose(self, s: Scope) -> list[Statement] | None:
        if not s.publisher:
            return None
        if self.chance(0.4):
            return [text(f"{s.publisher}.publish(std_msgs::Number());")]
        name = self.new("M")
        inside = [text(f"std_msgs::Number {name};")]
        inner = s.inner()
        inner.variables["double"].append(f"{name}.data")
        inside.append(text(f"{name}.data = {self.expression(s, 'double')};"))
        if self.chance(0.4):
            inside += self.statement(inner)
        inside.append(text(f"{s.publisher}.publish({name});"))
        return [Statement((tuple(inside),))]

    def read(self, s: Scope) -> list[Statement] | None:
        type_ = self.random.choice(TYPES)
        made = []
        if self.chance(0.4):
            name = self.new("L")
            made.append(text(f"{type_} {name} = {STARTS[type_]};"))
            s.variables[type_].append(name)
        else:
            name = self.place(s, type_)
        if name is None:
            return None
        parameter = f"{self.name}_{self.new('p')}"
        if self.chance(0.3):
            return [*made, text(f'{s.handle}.getParam("{parameter}", {name});')]
        default = STARTS[type_]
        return [*made, text(f'{s.handle}.param("{parameter}", {name}, {default});')]

    def read_if(self, s: Scope) -> list[Statement] | None:
        """A read whose result, whether there is such a parameter, is used."""
        type_ = self.random.choice(TYPES)
        name = self.place(s, type_)
        if name is None:
            return None
        read = f'{s.handle}.getParam("{self.name}_{self.new("p")}", {name})'
        kind = self.one((2, "if"), (2, "else"), (1, "keep"))
        if kind == "if":
            return [Statement((f"if ({read})", self.small(s)))]
        if kind == "else":
            return [Statement((f"if (!{read})", (text(f"{name} = {STARTS[type_]};"),)))]
        found = self.new("L")
        s.variables["bool"].append(found)
        return [text(f"bool {found} = {read};")]

    def mode(self, s: Scope) -> str:
        kind = self.one((3, "constant"), (2, "chosen"), (2, "cast"), (1, "other"))
        if kind == "chosen":
            one, other = self.random.sample(MODES, 2)
            return f"({self.condition(s, 1)} ? {one} : {other})"
        if kind == "cast":
            return f"static_cast<Mode>({self.expression(s, 'int', 1)})"
        return self.random.choice(s.modes if kind == "other" else MODES)

    def set_mode(self, s: Scope) -> list[Statement]:
        return [text(f"{self.random.choice(s.modes)} = {self.mode(s)};")]

    def switch_mode(self, s: Scope) -> list[Statement]:
        inside: list[Statement] = []
        for mode in self.random.sample(MODES, self.random.randint(1, 3)):
            inside += [text(f"case {mode}:"), Statement((self.small(s, in_loop=False),))]
            if self.chance(0.8):
                inside.append(text("break;"))
        if self.chance(0.4):
            inside += [text("default:"), Statement((self.small(s, in_loop=False),))]
        return [Statement((f"switch ({self.random.choice(s.modes)})", tuple(inside)))]

    def point(self, s: Scope) -> list[Statement]:
        """A pointer to a function is set."""
        one, other = self.random.sample(self.picks, 2)
        way = self.one((1, f"&{one}"), (1, f"{self.condition(s, 1)} ? &{one} : &{other}"))
        return [text(f"{self.random.choice(s.pointers)} = {way};")]

    def keep(self, s: Scope) -> list[Statement]:
        """A local variable that is there in the next call, too."""
        type_, name = self.random.choice(TYPES), self.new("Kept")
        begin = self.one((2, STARTS[type_]), (1, self.expression(s, type_)))
        s.variables[type_].append(name)
        return [text(f"static {type_} {name} = {begin};")]

    def throw(self, s: Scope) -> list[Statement]:
        what = self.random.choice(["1", "Failure()"])
        return [Statement((f"if ({self.condition(s)})", (text(f"throw {what};"),)))]

    def copy(self, s: Scope) -> list[Statement]:
        """A struct is copied: into a new one, or over another."""
        source = self.random.choice(s.objects)
        if len(s.objects) > 1 and self.chance(0.5):
            return [text(f"{self.random.choice(s.objects)} = {source};")]
        name = self.new("S")
        s.objects.append(name)
        for t, n in self.range_fields:
            s.variables[t].append(f"{name}.{n}")
        return [text(f"Range {name} = {source};")]

    def called_at_once(self, s: Scope) -> list[Statement]:
        """A lambda, by reference or by value, that is called where it is made."""
        if self.chance(0.5):
            body = self.small(s, result="void", in_loop=False)
            return [Statement(("[&]", body, "();"))]
        type_, name = self.random.choice(TYPES), self.new("L")
        inner = s.inner(result=type_, in_loop=False)
        if self.chance(0.5):
            body = (*self.small(inner), text(f"return {self.expression(inner, type_)};"))
            made = Statement((f"{type_} {name} = [&]() -> {type_}", body, "();"))
        else:
            body = (text(f"return {self.expression(inner, type_)};"),)
            made = Statement((f"{type_} {name} = [=]() mutable -> {type_}", body, "();"))
        s.variables[type_].append(name)
        return [made]

    def log(self, s: Scope) -> list[Statement]:
        return [text(f"logged({self.expression(s, 'double')});")]

    def plain_call(self, s: Scope) -> list[Statement] | None:
        call = self.call(s, self.one((3, "void"), (1, "double"), (1, "bool")))
        return [text(f"{call};")] if call else None

    def branch(self, s: Scope) -> list[Statement]:
        parts: list[object] = [f"if ({self.condition(s)})", self.small(s)]
        if self.chance(0.4):
            parts += ["else", self.small(s)]
        return [Statement(tuple(parts))]

    def loop(self, s: Scope) -> list[Statement]:
        kind = self.one((3, "while"), (3, "for"), (2, "do"), (2, "endless"))
        body = self.small(s, in_loop=True)
        if kind == "while":
            return [Statement((f"while ({self.condition(s)})", body))]
        if kind == "for":
            name = self.new("I")
            inner = s.inner()
            inner.variables["int"].append(name)
            body = self.small(inner, in_loop=True)
            head = f"for (int {name} = 0; {name} < {self.expression(s, 'int', 1)}; ++{name})"
            return [Statement((head, body))]
        if kind == "do":
            return [Statement(("do", body, f"while ({self.condition(s)});"))]
        end = Statement((f"if ({self.condition(s)})", (text("break;"),)))
        more = self.small(s, in_loop=True) if self.chance(0.5) else ()
        if self.chance(0.2):
            return [Statement(("while (true)", (*body, *more)))]
        return [Statement(("while (true)", (*body, end, *more)))]

    def switch(self, s: Scope) -> list[Statement]:
        inside: list[Statement] = []
        for n in range(self.random.randint(1, 3)):
            inside.append(text(f"case {n}:"))
            inside.append(Statement((self.small(s, in_loop=False),)))
            if self.chance(0.7):
                inside.append(text("break;"))
        if self.chance(0.6):
            inside.append(text("default:"))
            inside.append(Statement((self.small(s, in_loop=False),)))
        return [Statement((f"switch ({self.expression(s, 'int')})", tuple(inside)))]

    def jump(self, s: Scope) -> list[Statement]:
        label = self.new("Label")
        go = Statement((f"if ({self.condition(s)})", (text(f"goto {label};"),)))
        if self.chance(0.3):
            return [Statement(((text(f"{label}:;"), Statement(((*self.small(s), go),))),))]
        ahead = Statement(((*self.small(s), go, *self.small(s)),))
        return [Statement(((ahead, text(f"{label}:;")),))]

    def attempt(self, s: Scope) -> list[Statement]:
        body = list(self.small(s, in_try=True))
        if self.chance(0.5):
            body.append(text("mayThrow();"))
        if self.chance(0.5):
            body.append(Statement((f"if ({self.condition(s)})", (text("throw 1;"),))))
            body += self.small(s)
        handler = self.small(s)
        parts: list[object] = ["try", tuple(body)]
        if self.extended:
            if self.chance(0.4):
                parts += ["catch (const Failure &)", self.small(s)]
            if self.chance(0.3):
                return [Statement((*parts, "catch (...)", handler))]
        return [Statement((*parts, "catch (int)", handler))]

    def cleaned(self, s: Scope) -> list[Statement]:
        inside = (text(f'std::string {self.new("Text")}("to clean up");'), *self.small(s))
        return [Statement((inside,))]

    def leave(self, s: Scope) -> list[Statement] | None:
        if s.in_loop and self.chance(0.6):
            how = self.random.choice(["break;", "continue;"])
        elif s.depth < 2:
            return None
        elif s.result == "void":
            how = "return;"
        else:
            how = f"return {self.expression(s, s.result)};"
        return [Statement((f"if ({self.condition(s)})", (text(how),)))]

    # Declarations -----------------------------------------------------------

    def function(
        self, s: Scope, prefix: str, size: int, method: bool
    ) -> tuple[Statement, Callable_]:
        """A function that sees what `s` does, and how it is called."""
        result = self.one((3, "void"), (3, "bool"), (3, "double"), (1, "int"))
        f = Callable_(self.new(prefix), result, [], [])
        inner = s.inner(result=result)
        inner.depth = 0
        written = []
        for _ in range(self.random.randint(0, 3)):
            type_, by_reference = self.random.choice(TYPES), self.chance(0.25)
            name = self.new("A")
            f.arguments.append(type_)
            f.by_reference.append(by_reference)
            written.append(f"{type_} {'&' if by_reference else ''}{name}")
            inner.variables[type_].append(name)
        if not method:
            inner.publisher = inner.handle = None
            if self.chance(0.5):
                inner.publisher = "Global.Out"
        body = self.body(inner, size)
        if result != "void":
            body = (*body, text(f"return {self.expression(inner, result)};"))
        head = f"{'' if method else 'static '}{result} {f.name}({', '.join(written)})"
        return Statement((head, body)), f

    def program(self) -> Program:
        r = self.random
        out: list[Statement] = []
        range_fields = self.range_fields = [
            (r.choice(TYPES), self.new("R")) for _ in range(r.randint(1, 3))
        ]
        fields = tuple(text(f"{t} {n} = {STARTS[t]};") for t, n in range_fields)
        out += [text("struct Range : First"), Statement((fields, ";"))]
        out += [
            text("struct : First"),
            Statement(((text("ros::Publisher Out;"), text("Range Limits;")), "Global;")),
        ]
        empty: dict[str, list[str]] = {t: [] for t in TYPES}
        s = Scope(empty, {t: [] for t in TYPES}, [], None, None)
        for t, n in range_fields:
            s.variables[t].append(f"Global.Limits.{n}")
        for _ in range(r.randint(1, 3)):
            t, n = r.choice(TYPES), self.new("G")
            out.append(text(f"static {t} {n} = {STARTS[t]};"))
            s.variables[t].append(n)
        if self.extended:
            s.objects.append("Global.Limits")
            out += self.template(s)
            out += self.keeper()
            out += [text("enum class Mode { Off, Slow, Fast };"), text("struct Failure {};")]
            if self.chance(0.5):
                s.modes.append("GlobalMode")
                out.append(text("static Mode GlobalMode = Mode::Off;"))
            if self.chance(0.4):
                out += self.chosen_functions(s)
            if self.chance(0.5):
                out += self.interface(s)
        for _ in range(r.randint(0, 3)):
            made, f = self.function(s, "help", r.randint(1, 3), method=False)
            out.append(made)
            s.functions.append(f)
        out += self.node(s, range_fields)
        return Program(self.name, tuple(out), self.extended)

    def template(self, s: Scope) -> list[Statement]:
        """A function template, and its instances in `s`."""
        name, operator = self.new("than"), self.random.choice("<>")
        for t in ("double", "int"):
            s.functions.append(Callable_(f"{name}<{t}>", "bool", [t, t], [False, False]))
        head = f"template <typename T> static bool {name}(T Left, T Right)"
        return [Statement((head, (text(f"return Left {operator} Right;"),)))]

    def keeper(self) -> list[Statement]:
        """A class with setters, and a reference as a member."""
        inside = (
            text("public:"),
            text("explicit Keeper(double &Watched) : Watched(Watched) {}"),
            text("void keep(double Value) { Kept = Value; }"),
            text("void watch(double Value) { Watched = Value; }"),
            text("bool isAbove(double Value) const { return Value > Kept; }"),
            text("bool isLow() const { return Watched < Kept; }"),
            text("double kept() const { return Kept; }"),
            text("double &Watched;"),
            text("double Kept = 0.5;"),
        )
        return [text("class Keeper : First"), Statement((inside, ";"))]

    def chosen_functions(self, s: Scope) -> list[Statement]:
        """Functions that are called through a table, or a pointer."""
        made = []
        for _ in range(self.random.randint(2, 3)):
            inner = s.inner(result="double", publisher=self.one((1, None), (1, "Global.Out")))
            inner.depth = 0
            inner.variables["double"].append("A")
            body = self.body(inner, self.random.randint(0, 2))
            name = self.new("pick")
            self.picks.append(name)
            end = text(f"return {self.expression(inner, 'double')};")
            made.append(Statement((f"static double {name}(double A)", (*body, end))))
        if self.chance(0.6):
            s.tables.append("Table")
            two = ", ".join(self.random.sample(self.picks, 2))
            made.append(text(f"static double (*const Table[])(double) = {{{two}}};"))
        return made

    def interface(self, s: Scope) -> list[Statement]:
        """An interface and two or three classes."""
        abstract = self.chance(0.6)
        functions = ("double scaled(double A)", "bool accepts(double A)", "void act()")
        ends = ["return A;", "return A > 1;", ""]
        inside = [text("public:"), text("virtual ~Way() {}")]
        for head, end in zip(functions, ends, strict=True):
            inside.append(text(f"virtual {head} {'= 0;' if abstract else '{ ' + end + ' }'}"))
        made = [Statement(("class Way", tuple(inside), ";"))]
        for _ in range(self.random.randint(2, 3)):
            name = self.new("Way")
            self.classes.append(name)
            inside = [text("public:")]
            own = s.inner()
            if self.chance(0.4):
                inside.append(text("double Own = 1.5;"))
                own.variables["double"].append("Own")
            for head in functions:
                if not abstract and self.chance(0.3):
                    continue
                result = head.split()[0]
                inner = own.inner(result=result, publisher="Global.Out")
                inner.depth = 0
                if result != "void":
                    inner.variables["double"].append("A")
                body = self.body(inner, self.random.randint(0 if result != "void" else 1, 2))
                if result != "void":
                    body = (*body, text(f"return {self.expression(inner, result)};"))
                inside.append(Statement((f"{head} override", body)))
            made.append(Statement((f"class {name} : public Way", tuple(inside), ";")))
        return made

    def chosen_object(self, own: Scope) -> tuple[list[Statement], Callable[[Scope], Statement]]:
        """A member that points to an object behind the interface, and how it is set."""
        smart = self.chance(0.5)
        member = "std::unique_ptr<Way> Chosen;" if smart else "Way *Chosen = nullptr;"
        own.functions += [
            Callable_("Chosen->scaled", "double", ["double"], [False]),
            Callable_("Chosen->accepts", "bool", ["double"], [False]),
            Callable_("Chosen->act", "void", [], []),
        ]

        def put(name: str) -> Statement:
            return text(f"Chosen.reset(new {name});" if smart else f"Chosen = new {name};")

        def choose(s: Scope) -> Statement:
            one, other = self.random.sample(self.classes, 2)
            if self.chance(0.4):
                return put(one)
            return Statement((f"if ({self.condition(s)})", (put(one),), "else", (put(other),)))

        return [text(member)], choose

    def kept_function(self, own: Scope) -> Callable[[Scope], Statement]:
        """A std::function as a member; of a type that no other program has."""
        own.functions.append(Callable_("asked", "double", ["double"], [False]))

        def lambda_(s: Scope) -> Statement:
            inner = s.inner(result="double", in_loop=False, handle=None)
            inner.depth = 0
            inner.variables["double"].append("A")
            body = self.body(inner, self.random.randint(0, 2))
            end = text(f"return {self.expression(inner, 'double')};")
            head = "Asked = [this](const Range &, double A) -> double"
            return Statement((head, (*body, end), ";"))

        return lambda_

    def more_members(
        self, own: Scope, inside: list[Statement]
    ) -> list[Callable[[Scope], Statement]]:
        """Members of further kinds; how the constructor sets them."""
        setting: list[Callable[[Scope], Statement]] = []
        if self.chance(0.4):
            body = (text("Range Inner;"), text("double Wide = 1.5;"))
            inside += [Statement(("struct Settings", body, ";")), text("Settings Set;")]
            own.variables["double"].append("Set.Wide")
            for t, n in self.range_fields:
                own.variables[t].append(f"Set.Inner.{n}")
            own.objects.append("Set.Inner")
        if self.chance(0.5):
            inside.append(text("Mode Own_ = Mode::Off;"))
            own.modes.append("Own_")
        if self.picks and self.chance(0.7):
            inside.append(text(f"double (*How)(double) = &{self.picks[0]};"))
            own.pointers.append("How")
            own.functions.append(Callable_("How", "double", ["double"], [False]))
        if self.classes:
            members, choose = self.chosen_object(own)
            inside += members
            setting.append(choose)
        if self.chance(0.25):
            inside.append(text("std::function<double(const Range &, double)> Asked;"))
            inside.append(text("double asked(double A) { return Asked(Global.Limits, A); }"))
            setting.append(self.kept_function(own))
        return setting

    def node(self, s: Scope, range_fields: list[tuple[str, str]]) -> list[Statement]:
        """A class with parameters and methods, and a function that runs it."""
        r = self.random
        inside: list[Statement] = []
        own = s.inner(publisher="Out")
        own.depth = 0
        for _ in range(r.randint(2, 5)):
            t, n = r.choice(TYPES), self.new("F")
            inside.append(text(f"{t} {n} = {STARTS[t]};"))
            own.variables[t].append(n)
        if self.chance(0.6):
            inside.append(text("Range Mine;"))
            for t, n in range_fields:
                own.variables[t].append(f"Mine.{n}")
            if self.extended:
                own.objects.append("Mine")
        if self.extended and self.chance(0.6):
            inside += [text("double Seen = 0.5;"), text("Keeper Own{Seen};")]
            own.variables["double"] += ["Seen", "Own.Kept"]
            own.functions += [
                Callable_("Own.keep", "void", ["double"], [False]),
                Callable_("Own.watch", "void", ["double"], [False]),
                Callable_("Own.isAbove", "bool", ["double"], [False]),
                Callable_("Own.isLow", "bool", [], []),
                Callable_("Own.kept", "double", [], []),
            ]
        setting: list[Callable[[Scope], Statement]] = []
        if self.extended:
            setting = self.more_members(own, inside)
        reading = own.inner(handle="Handle")
        reading.depth = 0
        reads = [s for _ in range(r.randint(1, 3)) for s in self.read(reading) or []]
        if self.extended:
            # What is a local of the constructor is gone when a lambda is called.
            fields = own.inner(depth=0)
            reads += [choose(fields) for choose in setting]
        extra = self.body(reading, r.randint(0, 2))
        inside.append(Statement(("explicit Node(ros::NodeHandle &Handle)", (*reads, *extra))))
        methods = []
        for _ in range(r.randint(1, 3)):
            made, f = self.function(own, "step", r.randint(1, 2 + self.deepest), method=True)
            inside.append(made)
            own.functions.append(f)
            methods.append(f)
        inside.append(text("ros::Publisher Out;"))
        run = s.inner(publisher="Out", handle="Handle")
        run.depth = 0
        for t, n in (("double", "V"), ("int", "N"), ("bool", "B")):
            run.variables[t].append(n)
        before = self.body(run, r.randint(0, 3))
        calls = []
        for f in methods:
            run.functions = [Callable_(f"It.{f.name}", f.result, f.arguments, f.by_reference)]
            if call := self.call(run, f.result):
                calls.append(text(f"{call};"))
        run.functions = [
            Callable_(f"It.{f.name}", f.result, f.arguments, f.by_reference) for f in methods
        ]
        after = self.body(run, r.randint(1, 4))
        head = "void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V, int N, bool B)"
        body = (*before, text("Node It(Handle);"), *calls, *after)
        return [
            text("class Node"),
            Statement(((text("public:"), *inside), ";")),
            Statement((head, body)),
        ]


def text(line: str) -> Statement:
    return Statement((line,))


def program(seed: int, name: str = "p", extended: bool = False) -> Program:
    """The program of a seed; `extended`: also with copies, lambdas, setters and templates."""
    return Generator(seed, name, extended).program()
