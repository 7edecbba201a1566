"""What is known of a value without running the program: numbers and names."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import product

from pytpc.python_analysis.flow.value_flow import Flow
from pytpc.python_analysis.ir.instructions import Instr

DYNAMIC = "<dynamic>"
_MOST = 8
_KNOWN = {
    "math.pi": math.pi,
    "math.e": math.e,
    "math.tau": math.tau,
    "numpy.pi": math.pi,
    "numpy.e": math.e,
    "math.inf": math.inf,
    "numpy.inf": math.inf,
}
_OPERATORS: dict[str, Callable[[float, float], float]] = {
    "Add": operator.add,
    "Sub": operator.sub,
    "Mult": operator.mul,
    "Div": operator.truediv,
    "FloorDiv": operator.floordiv,
    "Mod": operator.mod,
    "Pow": operator.pow,
}


UNKNOWN = object()
"""A value that is not known."""


class Constants:
    """Folds constants over variables, attributes, arguments and results."""

    def __init__(self, flow: Flow) -> None:
        self.flow = flow
        self._known: dict[Instr, tuple[object, ...]] = {}
        self._meanwhile: dict[Instr, tuple[object, ...]] = {}
        self._active: set[Instr] = set()
        self._given: dict[Instr, tuple[object, ...]] = {}

    @contextmanager
    def where(self, given: dict[Instr, tuple[object, ...]]) -> Iterator[None]:
        """In this block parameters have the values in ``given``."""
        before = (self._given, self._known, self._meanwhile, self._active)
        self._given, self._known, self._meanwhile, self._active = given, {}, {}, set()
        try:
            yield
        finally:
            self._given, self._known, self._meanwhile, self._active = before

    def values(self, instr: Instr) -> tuple[object, ...]:
        """All values that ``instr`` may have; ``UNKNOWN`` among them stands for others."""
        known = self._known if instr in self._known else self._meanwhile
        if instr in known:
            return known[instr]
        if instr in self._active or len(self._active) > 200:
            return (UNKNOWN,)
        self._active.add(instr)
        found = self._fold(instr)
        self._active.discard(instr)
        unique = tuple({(type(each), each): each for each in found}.values())
        if len(unique) > _MOST:
            unique = (UNKNOWN,)
        # In a cycle of values only the result for the first one is complete.
        self._meanwhile[instr] = unique
        if not self._active:
            self._known[instr] = unique
            self._meanwhile.clear()
        return unique

    def number(self, instr: Instr) -> float | None:
        """The number that ``instr`` always is; None where it is not always the same."""
        values = self.values(instr)
        if len(values) == 1 and isinstance(values[0], (int, float)):
            try:
                return float(values[0])
            except OverflowError:
                return None
        return None

    def names(self, instr: Instr) -> list[str]:
        """The texts that ``instr`` may be, ``<dynamic>`` for unknown ones."""
        texts = [each if isinstance(each, str) else DYNAMIC for each in self.values(instr)]
        return list(dict.fromkeys(texts)) or [DYNAMIC]

    def _fold(self, instr: Instr) -> list[object]:
        match instr.op:
            case "const":
                plain = isinstance(instr.data, (str, int, float, bool, type(None)))
                return [instr.data if plain else UNKNOWN]
            case "build" if instr.data == "text":
                return self._text([self.values(part) for part in instr.args])
            case "binary":
                return self._binary(instr)
            case "unary":
                return self._unary(instr)
            case "call" | "attr" | "external":
                return self._named(instr) or self._sources(instr)
            case "load" | "item" | "param" | "next" | "copy":
                return self._sources(instr)
            case _:
                return [UNKNOWN]

    def _text(self, parts: list[tuple[object, ...]]) -> list[object]:
        if math.prod(len(part) for part in parts) > _MOST:
            return [UNKNOWN]
        return ["".join(_shown(each) for each in choice) for choice in product(*parts)]

    def _binary(self, instr: Instr) -> list[object]:
        left, right = (self.values(arg) for arg in instr.args)
        if len(left) * len(right) > _MOST:
            return [UNKNOWN]
        return [_calculated(str(instr.data), a, b) for a, b in product(left, right)]

    def _unary(self, instr: Instr) -> list[object]:
        values = self.values(instr.args[0])
        if instr.data != "USub":
            return [UNKNOWN]
        return [-each if isinstance(each, (int, float)) else UNKNOWN for each in values]

    def _named(self, instr: Instr) -> list[object]:
        """Constants of libraries, formatted texts, arithmetic with constants."""
        for found in self.flow.points.of(instr):
            if found.kind == "external" and found.path in _KNOWN:
                return [_KNOWN[found.path]]
        if instr.op != "call":
            return []
        function = instr.args[0]
        if function.op == "attr" and function.data == "format":
            return self._formatted(instr, function.args[0])
        for path, _ in self.flow.points.calls.outside.get(instr, ()):
            if path == "math.radians" and len(instr.args) == 2:
                number = self.number(instr.args[1])
                return [UNKNOWN if number is None else math.radians(number)]
            if path in ("builtins.str", "builtins.float", "builtins.int") and len(instr.args) == 2:
                return [_converted(path, each) for each in self.values(instr.args[1])]
        return []

    def _formatted(self, instr: Instr, pattern: Instr) -> list[object]:
        texts = self.values(pattern)
        names = getattr(instr.data, "names", ())
        parts = [self.values(arg) for arg in instr.args[1:]]
        if len(texts) != 1 or not isinstance(texts[0], str):
            return [UNKNOWN]
        if math.prod(len(part) for part in parts) > _MOST:
            return [UNKNOWN]
        found: list[object] = []
        for choice in product(*parts):
            shown = [_shown(each) for each in choice]
            places = [text for name, text in zip(names, shown, strict=True) if name is None]
            words = {name: text for name, text in zip(names, shown, strict=True) if name}
            try:
                found.append(texts[0].format(*places, **words))
            except (IndexError, KeyError, ValueError, AttributeError, TypeError):
                found.append(UNKNOWN)
        return found

    def _sources(self, instr: Instr) -> list[object]:
        found: list[object] = []
        if instr in self._given:
            return list(self._given[instr])
        if instr.op == "param" and instr.function in self.flow.points.calls.registered:
            found.append(UNKNOWN)
        for origin in self.flow.origins(instr):
            found += self.values(origin)
        return found or [UNKNOWN]


def _shown(value: object) -> str:
    return DYNAMIC if value is UNKNOWN else str(value)


def _converted(path: str, value: object) -> object:
    if value is UNKNOWN:
        return UNKNOWN
    try:
        if path == "builtins.str" or not isinstance(value, (str, int, float)):
            return str(value) if path == "builtins.str" else UNKNOWN
        return float(value) if path == "builtins.float" else int(value)
    except (TypeError, ValueError, OverflowError):
        return UNKNOWN


def _calculated(op: str, left: object, right: object) -> object:
    if op == "Add" and (isinstance(left, str) or isinstance(right, str)):
        return _shown(left) + _shown(right)
    if op == "Mod" and isinstance(left, str):
        try:
            return left % (DYNAMIC if right is UNKNOWN else right)
        except (TypeError, ValueError):
            return UNKNOWN
    if isinstance(left, (int, float)) and isinstance(right, (int, float)) and op in _OPERATORS:
        if op == "Pow" and abs(right) > 64:
            return UNKNOWN
        try:
            result = _OPERATORS[op](left, right)
        except (ArithmeticError, ValueError):
            return UNKNOWN
        return result if isinstance(result, (int, float)) else UNKNOWN
    return UNKNOWN
