"""The computation on a parameter's value before it is compared: scale * inner + offset.

Up to two values that are not constant may take part (``x * self.speed``). They are kept as text.
"""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass, replace

from pytpc.python_analysis.ir.instructions import Instr
from pytpc.static.arithmetic import Tree
from pytpc.static.link_unit import Transform

_SIGNS = {"/": " / ", "rem": " rem ", "shr": " >> ", "and": " & "}
_MIXING = {"Add": "+", "Sub": "-", "Mult": "*", "Div": "/", "FloorDiv": "//", "Mod": "%"}
_SUMS = ("+", "-")
_MOST_OTHERS = 2
_LONGEST_TEXT = 60
_DEEPEST = 12
# Two to the power of this does not fit a double.
_LONGEST_SHIFT = 1024


@dataclass(frozen=True)
class How:
    """``inner`` is None where no function was applied to the parameter.

    ``others`` are the values in it that are not constant.
    """

    scale: float = 1.0
    offset: float = 0.0
    inner: Application | None = None
    others: tuple[Instr, ...] = ()

    @property
    def plain(self) -> bool:
        """True where nothing was done."""
        return self == How()

    @property
    def is_finite(self) -> bool:
        """False where a number in it is infinite or NaN, which JSON does not have."""
        inner = self.inner
        below = inner is None or (math.isfinite(inner.constant or 0.0) and inner.of.is_finite)
        return below and math.isfinite(self.scale) and math.isfinite(self.offset)

    @property
    def _has_size(self) -> bool:
        """True where the size of a list or a text is in it, from which no value follows."""
        inner = self.inner
        return inner is not None and (inner.op == "size" or inner.of._has_size)

    @property
    def depth(self) -> int:
        """How many functions were applied."""
        return 0 if self.inner is None else 1 + self.inner.of.depth

    def times(self, factor: float) -> How:
        """Multiplied by a number."""
        return replace(self, scale=self.scale * factor, offset=self.offset * factor)

    def plus(self, term: float) -> How:
        """A number added."""
        return replace(self, offset=self.offset + term)

    def call(self, op: str, constant: float | None = None, first: bool = False) -> How | None:
        """``op`` of it and of ``constant``, which may come ``first``; None where it is too deep."""
        if self.depth >= _DEEPEST:
            return None
        return How(inner=Application(op, self, constant, first), others=self.others)

    def mixed(self, op: str, other: Instr, first: bool) -> How | None:
        """After a binary operator (its class in ``ast``) with a value that is not constant.

        None where there is no notation for it.
        """
        text = _text_of(other)
        if op not in _MIXING or text is None or len(self.others) >= _MOST_OTHERS:
            return None
        inner = Application(_MIXING[op], self, None, first, text)
        return How(inner=inner, others=(*self.others, other))

    @property
    def is_difference(self) -> bool:
        """True where another value is only added to it, or taken from it."""
        inner = self.inner
        alone = self.scale == 1 and self.offset == 0
        return alone and inner is not None and bool(inner.other) and inner.op in _SUMS

    def tree(self) -> Tree:
        """The tree of docs/reference/formats.md."""
        found: Tree = "x"
        if self.inner is not None:
            parts: list[Tree] = [self.inner.of.tree()]
            if self.inner.constant is not None:
                parts.insert(0 if self.inner.first else 1, self.inner.constant)
            found = (self.inner.op, *parts)
        if self.scale != 1:
            found = ("*", self.scale, found)
        return found if self.offset == 0 else ("+", found, self.offset)

    def text(self) -> str:
        """A text for people: ``2 * sqrt(x + 1)``."""
        text = "x" if self.inner is None else self.inner.text()
        inner = self.inner
        if inner is not None:
            scaled = self.scale != 1 or (self.offset != 0 and not inner.other)
            if scaled and (inner.other or inner.op in _SIGNS):
                text = f"({text})"
        if self.scale == -1 and self.inner is not None:
            text = f"-{text}"
        elif self.scale != 1:
            text = f"{_number(self.scale)} * {text}"
        if self.offset:
            text += f" {'-' if self.offset < 0 else '+'} {_number(abs(self.offset))}"
        return text

    def operand(self) -> str:
        """Its text next to an operator."""
        simple = self.scale == 1 and self.offset == 0
        inner = self.inner
        alone = inner is None or not (inner.other or inner.op in _SIGNS or inner.is_square)
        if simple and alone:
            return self.text()
        return f"({self.text()})"

    def to_json(self) -> Transform | None:
        """The transform of the static information; None where nothing was done."""
        if self.plain:
            return None
        if self.inner is None:
            return Transform("affine", self.scale, self.offset, self.text())
        tree = None if self.others or self._has_size else self.tree()
        return Transform("expression", text=self.text(), tree=tree)


@dataclass(frozen=True)
class Application:
    """One function of a transform; ``other`` is the text of an operand that is not constant."""

    op: str
    of: How
    constant: float | None
    first: bool
    other: str = ""

    @property
    def is_square(self) -> bool:
        """True for ``x^2``."""
        return self.op == "pow" and not self.first and self.constant == 2

    def text(self) -> str:
        """A text for people."""
        if self.other:
            # Only what follows a minus needs parentheses in a sum.
            bare = self.op in _SUMS and not (self.first and self.op == "-")
            parts = [self.of.text() if bare else self.of.operand(), self.other]
            return f" {self.op} ".join(reversed(parts) if self.first else parts)
        if self.is_square:
            return f"{self.of.operand()}^2"
        if self.constant is None:
            return f"{self.op}({self.of.text()})"
        sign = _SIGNS.get(self.op)
        own = self.of.text() if sign is None else self.of.operand()
        parts = [own, _number(self.constant)]
        if self.first:
            parts.reverse()
        return f"{self.op}({', '.join(parts)})" if sign is None else sign.join(parts)


def _text_of(other: Instr) -> str | None:
    """An operand as it is in the source; None where it has no place there."""
    node = other.node
    if not isinstance(node, ast.expr):
        return None
    text = ast.unparse(node)
    if len(text) > _LONGEST_TEXT:
        return None
    alone = (ast.Name, ast.Attribute, ast.Call, ast.Subscript)
    return text if isinstance(node, alone) else f"({text})"


def _number(value: float) -> str:
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


def by_operator(how: How, op: str, constant: float, left: bool) -> How | None:
    """``how`` after a binary operator of Python with a number.

    Args:
        how: what was done before.
        op: the name of the operator's class in ``ast``.
        constant: the other operand.
        left: the number is the left operand.
    """
    if not math.isfinite(constant):
        return None
    match op:
        case "Add":
            return how.plus(constant)
        case "Sub":
            return how.times(-1.0).plus(constant) if left else how.plus(-constant)
        case "Mult":
            return how.times(constant)
        case "Div" if left:
            return how.call("/", constant, first=True)
        case "Div":
            return how.times(1.0 / constant) if constant else None
        case "FloorDiv" if not left and constant:
            return how.times(1.0 / constant).call("floor")
        case "Pow":
            return how.call("pow", constant, first=left)
        case "BitAnd":
            return how.call("and", constant)
        case "RShift" if not left:
            return how.call("shr", constant)
        case "LShift" if not left and constant < _LONGEST_SHIFT:
            return how.times(2.0**constant)
        case _:
            return None


def by_function(how: How, op: str, constant: float | None, left: bool) -> How | None:
    """``how`` after a function of the table ``arithmetic`` of the rules; arguments as above."""
    match op:
        case "same":
            return how
        case "radians":
            return how.times(math.pi / 180)
        case "degrees":
            return how.times(180 / math.pi)
        case "square":
            return how.call("pow", 2.0)
        case "round" if constant not in (None, 0.0):
            return how
        case "log" if constant is not None:
            return None
        case "min" | "max" | "pow":
            return None if constant is None else how.call(op, constant, left and op == "pow")
        case _:
            return how.call(op)
