"""Programs made at random, in which every operand has a side effect; for Python 3.8 and up.

    python hook_programs.py COUNT [SEED]

Runs so many programs plain, and with reports of all comparisons and of half of all flags, loops,
cases and calls that compare inside. Prints those that differ; ends with exit status 1 if one does.
Operands are numbers, texts, None, NaN, arrays, and objects whose comparison and truth are the
program's own, and may raise.
"""

from __future__ import annotations

import functools
import random
import sys
from pathlib import Path

if __name__ == "__main__":
    sys.path[:0] = [str(Path(__file__).resolve().parents[2])]

from hook_samples import PATH, at_random, everywhere, outcome, taking, without_addresses

OPERATORS = ["<", "<=", ">", ">=", "==", "!=", "is", "is not", "in", "not in"]

PRELUDE = '''\
import dataclasses, decimal, enum, fractions, functools, math, operator
log = []
class Odd:
    """Compares by its own code, gives objects without a truth, or raises."""
    def __init__(self, name, mode):
        self.name, self.mode = name, mode
    def _compare(self, how, other):
        log.append((how, self.name))
        if self.mode == "raise":
            raise ValueError(how + self.name)
        if self.mode == "odd":
            return Odd(self.name + "'", "plain")
        return self.mode == "plain"
    def __lt__(self, other): return self._compare("lt", other)
    def __le__(self, other): return self._compare("le", other)
    def __gt__(self, other): return self._compare("gt", other)
    def __ge__(self, other): return self._compare("ge", other)
    def __eq__(self, other): return self._compare("eq", other)
    def __ne__(self, other): return self._compare("ne", other)
    def __contains__(self, other): return self._compare("in", other)
    def __bool__(self):
        log.append(("bool", self.name))
        if self.mode == "raise":
            raise ValueError("bool" + self.name)
        return self.mode == "plain"
    def __repr__(self): return "Odd " + self.name
    __hash__ = None
@functools.total_ordering
class Total:
    def __init__(self, at): self.at = at
    def __eq__(self, other): log.append("eq"); return self.at == getattr(other, "at", None)
    def __lt__(self, other):
        log.append("lt")
        return self.at < other.at if isinstance(other, Total) else NotImplemented
    def __repr__(self): return "Total %r" % self.at
@dataclasses.dataclass(order=True)
class Point:
    x: object
    y: object = 0
class Colour(enum.IntEnum):
    low = 1
    high = 2
class Float(float):
    def __lt__(self, other): log.append("Float"); return float.__lt__(self, other)
    def __float__(self): log.append("never"); return 0.0
class Limits:
    low, high, text, odd = 1, 2.5, "a", Odd("m", "plain")
def t(number, value):
    log.append(number)
    return value
class Context:
    def __init__(self, kept): self.kept = kept
    def __enter__(self): return self.kept
    def __exit__(self, kind, *rest): log.append(kind); return self.kept is True
    async def __aenter__(self): return self.kept
    async def __aexit__(self, kind, *rest): log.append(kind)
async def several(*values):
    for value in values:
        yield value
async def given(value): return value
def driven(coroutine):
    try:
        while True: log.append(coroutine.send(None))
    except StopIteration as stop: return stop.value
def decorated(value): log.append(repr(value)); return lambda function: function
nan = float("nan")
'''

VALUES = [
    "0", "1", "2.5", "-3", "nan", "True", "None", "'a'", "'b'", "(1, 2)", "[1]", "10**400",
    "Odd('p', 'plain')", "Odd('f', 'false')", "Odd('o', 'odd')", "Odd('r', 'raise')",
    "Total(1)", "Total(2)", "Point(1)", "Point(1, 2)", "Colour.low", "Limits.high", "Float(2)",
    "decimal.Decimal('1.5')", "fractions.Fraction(1, 3)", "{1, 2}", "frozenset([1])", "{1: 2}",
    "2j", "b'a'", "range(3)", "...", "float('inf')", "decimal.Decimal('sNaN')",
]  # fmt: skip
NUMPY = ["array([1, 2])", "array([1.5])", "float64(1.5)", "int32(2)", "bool_(True)"]


class Maker:
    """Programs of one seed."""

    def __init__(self, seed):
        self._random = random.Random(seed)

    def program(self):
        """A text with a generator, which is run to its end."""
        parts = [self.statement(2) for _ in range(self._random.randint(1, 4))]
        return (
            "def f():\n"
            + "\n".join(map(_indented, parts))
            + "\n    yield\nfor sent in f():\n    log.append(repr(sent))\n"
        )

    def value(self):
        """An operand."""
        return f"t({self._random.randint(0, 999)}, {self._random.choice(VALUES)})"

    def expression(self, depth):
        """An expression with comparisons in it."""
        if depth <= 0:
            return self.value() if self._random.random() < 0.5 else self._chain(0)
        if self._random.random() < 0.45:
            return self._chain(depth - 1)
        text = self._random.choice(EXPRESSIONS)
        return self._filled(text, depth - 1)

    def _chain(self, depth):
        words = [self._operand(depth)]
        for _ in range(self._random.choice((1, 1, 1, 2, 3))):
            words += [self._random.choice(OPERATORS), self._operand(depth)]
        return f"({' '.join(words)})"

    def _operand(self, depth):
        return self.value() if self._random.random() < 0.7 else self.expression(depth)

    def _filled(self, text, depth):
        while "@" in text:
            at = text.index("@")
            made = self.value() if text[at + 1] == "v" else self.expression(depth)
            text = text[:at] + made + text[at + 2 :]
        return text

    def statement(self, depth):
        """A statement, its body among them."""
        text = self._random.choice(STATEMENTS)
        while "#" in text:
            at = text.index("#")
            column = at - (text.rfind("\n", 0, at) + 1)
            body = self.statement(depth - 1) if depth > 0 else "log.append('end')"
            text = text[:at] + body.replace("\n", "\n" + " " * column) + text[at + 1 :]
        return self._filled(text, depth)


# @e is an expression, @v an operand, # a statement.
EXPRESSIONS = [
    "(@e and @e)", "(@e or @e)", "(not @e)", "(@e if @e else @e)", "t(1, (lambda: @e)())",
    "[@e for x in (1, 2) if @e]", "next((y for y in [@e] if @e), 7)", "(w := @e)", "(yield @e)",
    "f'{@v}'", "f'{(@v) < (@v)!r:>10}'", "{@v: @e for z in (1,)}", "[*(@e,), *[@e]]",
    "{**{1: @e}}", "(lambda a, b=@e: a < b)(@v)",
    "[[(u := x < y) for x in (1, @v)] for y in (2, @v) if (v := y > 1)]",
    "sorted([@v, @v], key=lambda k: @e)", "dict(a=@e)['a']", "[1, 2][@e:]", "-(@v < @v)",
    "driven(given(@e))", "any(@e for _ in '12')", "(@e\n      < @e)", "(await_ if @e else 3)",
    "min(@e, @v)", "max(@v, @e, @v)", "min(@v, @v, key=lambda k: @e)", "min(*@v, @e)",
    "t(2, max)(\n        @v, @e)", "operator.lt(@v, @e)", "operator.ge(@v, @v)",
    "operator.is_not(@v, @e)", "math.isclose(@v, @v, abs_tol=@v)", "(not @v)", "(@v and @v)",
    "[i for i in range(3) if @v]",
]  # fmt: skip
STATEMENTS = [
    "log.append(repr(@e))",
    "if @e:\n    #\nelif @e:\n    #\nelse:\n    log.append('no')",
    "n = 0\nwhile @e and n < 2:\n    n += 1\n    if @e: continue\nelse:\n    #",
    "assert @e, @e",
    "try:\n    x = (@e\n         < @e)\nexcept ValueError as e:\n    log.append(str(e))",
    "try:\n    #\nexcept (TypeError, ValueError) as e:\n    log.append(str(e))\nelse:\n    #\n"
    "finally:\n    log.append(@v)",
    "for i in range(@v if @e else 2):\n    log.append(i)\n"
    "    if i > @v or i > 3: break\nelse:\n    #",
    "return @e",
    "x = {@v: 1}\nif @e: del x",
    "class C:\n    here = @e\n    if here is @v: there = @e\n    def m(self, a=@e): return a\n"
    "log.append(repr(C().m()))",
    "@decorated(@e)\ndef g(a, *, b=@e): return a == b\nlog.append(repr(g(@v)))".replace(
        "@decorated", "\0"
    ),
    "def outer():\n    k = 0\n    def inner():\n        nonlocal k\n        global seen\n"
    "        k = seen = @e\n        return k != 1\n    return inner(), k\n"
    "log.append(repr(outer()))",
    "with Context(@e) as kept:\n    #",
    "async def a():\n    async with Context(@v) as c:\n        log.append(repr(c))\n"
    "    async for v in several(@v, @v):\n        if v < @v: log.append(repr(await given(@e)))\n"
    "    return [v async for v in several(1, @v) if v > (await given(@v))]\n"
    "log.append(repr(driven(a())))",
    "first, *rest = @e, @v, @e\nlog.append(repr(rest))",
    "x = y = @e\nx = [@v]\nx[0] = @e\nx += [@e]",
    "yield from [@e, (yield)]",
    "raise ValueError(@e) from None",
]
WITH_NUMPY = [
    "minimum(@v, @e)", "clip(@v, @v, @v)", "less(@v, @e)", "isclose(@v, @v, atol=@v)",
    "min(array(@v), @v)",
]  # fmt: skip
MATCHES = [
    "match @v:\n    case 1 if @e:\n        #\n    case Limits.high | Limits.text:\n"
    "        #\n    case _:\n        #",
    "match @v, @v:\n    case (1, x) if x > @v:\n        #\n    case [Limits.low, Point(x=y)]:\n"
    "        #\n    case {'a': 1} | None:\n        #",
    "match @e:\n    case Point(x=1, y=2) | Colour.low:\n        #\n    case Limits.odd:\n        #",
]
GROUPS = [
    "try:\n    raise ExceptionGroup('g', [ValueError(@e), TypeError(@v)])\n"
    "except* ValueError as g:\n    if @e: #\nexcept* TypeError:\n    #",
]
NEWEST_EXPRESSIONS = ["f'{f'{@v < @e}' if @e else '{}'}'"]
NEWEST = ["def h[T](a: T = @e): return a\nlog.append(repr(h()))"]
try:
    import numpy as np
except ImportError:
    OF_NUMPY = {}
else:
    OF_NUMPY = {
        name: getattr(np, name)
        for name in ("array", "float64", "int32", "bool_", "minimum", "clip", "less", "isclose")
    }
    VALUES += NUMPY
    EXPRESSIONS += WITH_NUMPY
VERSION = tuple(sys.version_info[:2])
STATEMENTS += MATCHES if VERSION >= (3, 10) else []
STATEMENTS += GROUPS if VERSION >= (3, 11) else []
STATEMENTS += NEWEST if VERSION >= (3, 12) else []
EXPRESSIONS += NEWEST_EXPRESSIONS if VERSION >= (3, 12) else []


def _indented(text):
    return "\n".join("    " + line for line in text.splitlines())


def program(seed):
    """The text of a program; several seeds have none that may be compiled."""
    return Maker(seed).program().replace("\0", "@decorated")


@functools.lru_cache(maxsize=2)
def _prelude(is_plain):
    """The names of the prelude, with reports or without; made once, because that takes long."""
    names = {"__name__": "program", **OF_NUMPY}
    code = compile(PRELUDE, PATH, "exec", dont_inherit=True) if is_plain else everywhere(PRELUDE)
    exec(code, names)
    return names


def _run(code, is_plain):
    """How it ends, what a tracer sees, its log, and the names that it leaves."""
    names = dict(_prelude(is_plain))
    names["log"].clear()
    ended = outcome(code, names)
    return ended, without_addresses(str(names["log"])), sorted(names)


def difference(seed):
    """What a program does differently with the hook; an empty text where it does the same.

    Returns None where the program cannot be compiled, as for ``yield`` in a comprehension.
    """
    source = program(seed)
    try:
        code = compile(source, PATH, "exec", dont_inherit=True)
    except SyntaxError:
        return None
    (expected, lines), *others = _run(code, True)
    with taking():
        (found, seen), *found_others = _run(at_random(source, seed), False)
    if (found, found_others) != (expected, others):
        return f"{(expected, others)}\n{(found, found_others)}"
    if lines == seen:
        return ""
    pairs = zip(lines, seen)  # noqa: B905
    return f"trace {next((pair for pair in pairs if pair[0] != pair[1]), 'longer')}"


def main(count, first):
    """Run ``count`` programs; the counts come every thousand, and at the end or at Ctrl-C."""
    done = same = left_out = 0

    def told():
        print(f"{done} programs: {same} the same, {left_out} no programs", flush=True)

    try:
        for seed in range(first, first + count):
            what = difference(seed)
            done += 1
            same += what == ""
            left_out += what is None
            if what:
                print(f"seed {seed}: {what}", flush=True)
                if count == 1:
                    print(program(seed))
            if done % 1000 == 0 and done < count:
                told()
    except KeyboardInterrupt:
        return 130
    finally:
        told()
    return 0 if done == same + left_out else 1


if __name__ == "__main__":
    sys.exit(
        main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else random.randrange(1 << 40))
    )
