"""The threshold predicate comparisons: those that both ways, forward and backward, lead to."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Literal

from pytpc.python_analysis.comparisons.facts import FLAG, Compared, Fact
from pytpc.python_analysis.comparisons.follow import Follower
from pytpc.python_analysis.comparisons.slicing import Slice
from pytpc.python_analysis.flow.constants import Constants
from pytpc.python_analysis.flow.library_calls import INSIDE, TURNED, Inside
from pytpc.python_analysis.flow.value_flow import Stack
from pytpc.python_analysis.ir.instructions import Instr, Variable
from pytpc.python_analysis.ir.names import named_variable

RELATIONS = {
    "Lt": "<", "LtE": "<=", "Gt": ">", "GtE": ">=", "Eq": "==", "NotEq": "!=",
    "Is": "==", "IsNot": "!=", "In": "==", "NotIn": "!=",
}  # fmt: skip
_ALL_KINDS = 3


Span = tuple[tuple[int, int], tuple[int, int]]
"""Line and column of the first character, and of the one after the last, from 1."""


@dataclass
class Found:
    """A comparison with one parameter at one place of the source, for all its copies in blocks.

    For a comparison with a constant, ``parameter`` is the constant's name and ``facts`` is empty.
    """

    at: Instr
    operand: int
    parameter: str
    facts: list[Fact]
    predicates: dict[Instr, None] = field(default_factory=dict)
    distance: int = 0
    predicate: Instr | None = None
    inside: Inside | None = None

    @property
    def span(self) -> Span:
        """Where it stands."""
        return span_of(self.at, self.operand)

    @property
    def relation(self) -> str:
        """The operator, with the threshold on the right-hand side."""
        if self.inside is not None:
            return self.inside.relation
        if self.operand < 0:
            return "flag" if self.operand == FLAG else "<"
        sign = RELATIONS[str(self.at.data)]
        return TURNED.get(sign, sign) if self.operand == 0 else sign

    @property
    def threshold(self) -> Instr:
        """The value that is the threshold."""
        if self.inside is not None:
            return self.at.args[1 + INSIDE - self.operand]
        return self.at.args[self.operand] if self.operand >= 0 else self.at

    @property
    def operand_text(self) -> str | None:
        """Which operand the threshold is, as in the schema."""
        if self.inside is not None:
            return self.inside.operand
        return ("left", "right")[self.operand] if self.operand >= 0 else None

    @property
    def type(self) -> Literal["parameter", "flag", "derived", "constant"]:
        """As in the schema."""
        if not self.facts:
            return "constant"
        if not self.facts[0].how.plain:
            return "derived"
        return "flag" if self.operand == FLAG else "parameter"


def _parts(values: Iterable[Instr]) -> Iterator[Instr]:
    """Values, and what they are computed from in the same expression."""
    for value in values:
        yield value
        if value.op in ("binary", "unary", "call"):
            yield from _parts(value.args)


def position(instr: Instr) -> tuple[int, int]:
    """Line and column from 1; 0 where the instruction has none."""
    return _start(instr.node)


def span_of(at: Instr, operand: int) -> Span:
    """Where the comparison ``at`` (or a flag) begins and ends.

    The first link of a chain begins where the chain does (with the parentheses around its left
    operand), the others at their left operand. A value pattern is the whole comparison.
    """
    node = at.node
    if operand < 0 or not isinstance(node, ast.Compare):
        return _start(node), _end(node)
    first = at.args[0].node is node.left
    last = at.args[1].node is node.comparators[-1]
    return _start(node if first else at.args[0].node), _end(node if last else at.args[1].node)


def _start(node: ast.AST) -> tuple[int, int]:
    return getattr(node, "lineno", 0), getattr(node, "col_offset", -1) + 1


def _end(node: ast.AST) -> tuple[int, int]:
    return getattr(node, "end_lineno", 0), getattr(node, "end_col_offset", -1) + 1


class Gatherer:
    """Joins the comparisons of each place, and drops those whose threshold is not a parameter."""

    def __init__(self, follower: Follower, found: Slice, counts_shown: bool) -> None:
        """``counts_shown``: a comparison whose outcome is itself exposed counts."""
        self.follower = follower
        self._shown = found.shown if counts_shown else {}
        self.slice = found
        self._kinds: dict[tuple[Instr, Stack], frozenset[str]] = {}

    def run(self) -> tuple[list[Found], list[Found]]:
        """The comparisons that decide something exposed, and the others."""
        joined: dict[tuple[object, ...], Found] = {}
        both = {each.at for each in self._exposed() if each.operand == 0} & {
            each.at for each in self._exposed() if each.operand == 1
        }
        for compared in self.follower.compared.values():
            if self._is_measured(compared, both):
                if compared.fact.how.others:
                    self.follower.lost.setdefault(compared.at, compared.fact)
                continue
            key = (
                compared.at.function.module,
                span_of(compared.at, compared.operand),
                compared.operand, compared.fact.name,
            )  # fmt: skip
            if key not in joined:
                joined[key] = Found(compared.at, compared.operand, compared.fact.name, [])
                joined[key].inside = compared.inside
            joined[key].facts.append(compared.fact)
            joined[key].predicates.update(dict.fromkeys(compared.predicates))
        exposed: list[Found] = []
        others: list[Found] = []
        for found in joined.values():
            found.facts.sort(key=lambda fact: (not fact.how.plain, fact.how.inner is not None))
            (exposed if self._nearest(found) else others).append(found)
        return exposed, others

    def constants(self, candidates: Iterable[Found], taken: Iterable[Found]) -> list[Found]:
        """The comparisons with constants that decide something exposed.

        Args:
            candidates: all of them.
            taken: the comparisons with parameters, which count only as such.
        """
        with_parameter = {each.at.node for each in taken}
        return [
            each
            for each in candidates
            if each.at.node not in with_parameter and self._nearest(each)
        ]

    def _exposed(self) -> list[Compared]:
        distance = self.slice.distance
        return [
            each
            for each in self.follower.compared.values()
            if each.at in self._shown or any(branch in distance for branch in each.predicates)
        ]

    def _nearest(self, found: Found) -> bool:
        distance = self.slice.distance
        near = [predicate for predicate in found.predicates if predicate in distance]
        if not near:
            if not found.facts or found.at not in self._shown:
                return False
            found.predicate, found.distance = found.at, self._shown[found.at]
            return True
        found.predicate = min(near, key=lambda each: (distance[each], each.number))
        found.distance = distance[found.predicate]
        return True

    def _is_measured(self, compared: Compared, both: set[Instr]) -> bool:
        """True where the operand may be a parameter, and may be something else.

        An operand that may be measured is the threshold only if the other side is measured, too.
        """
        stack = compared.fact.stack
        if compared.fact.how.others:
            return compared.operand < 0 or not self._is_threshold(compared, both)
        if compared.inside is not None:
            others = (self.kinds(each, stack) for each in compared.inside.others)
            only = frozenset[str]().union(*others) <= {"const"}
            return only and "other" in self.kinds(compared.fact.at, stack)
        if compared.operand < 0:
            return "other" in self.kinds(compared.fact.at, stack)
        own = self.kinds(compared.at.args[compared.operand], stack)
        if "other" not in own:
            return False
        other = self.kinds(compared.at.args[1 - compared.operand], stack)
        return other <= {"const"} or (compared.at in both and "other" not in other)

    def _is_threshold(self, compared: Compared, both: set[Instr]) -> bool:
        """True where a value that was computed with others is what something is compared with.

        Not where the parameter, or one of the others, is on the other side, too.
        """
        fact = compared.fact
        other = compared.at.args[1 - compared.operand]
        if any(each.name == fact.name for each in self.follower.facts.get(other, ())):
            return False
        if not self._was_kept(fact) and any(
            self.follower.same(other, part) for part in _parts(fact.how.others)
        ):
            return False
        if self.follower.constants.number(other) == 0:
            return fact.how.is_difference
        kinds = self.kinds(other, fact.stack)
        return not kinds <= {"const"} and not (compared.at in both and "other" not in kinds)

    def _was_kept(self, fact: Fact) -> bool:
        """True where the sum was stored, and another run of the function may have done that."""
        here: Fact | None = fact
        while here is not None and here.how.others:
            if here.at in self.follower.flow.reaching.open:
                return True
            here = here.before
        return False

    def kinds(self, instr: Instr, stack: Stack) -> frozenset[str]:
        """Where a value may come from, in a function that ``stack`` calls.

        Returns:
            Those of ``param``, ``const`` and ``other`` that are possible.
        """
        way = (instr, stack)
        if way not in self._kinds:
            found: set[str] = set()
            seen = {way}
            waiting = [way]
            while waiting and len(found) < _ALL_KINDS:
                here = waiting.pop()
                if here in self._kinds:
                    found |= self._kinds[here]
                    continue
                own, further = self._step(*here)
                found |= own
                waiting += [each for each in further if each not in seen]
                seen.update(further)
            self._kinds[way] = frozenset(found)
        return self._kinds[way]

    def _step(self, instr: Instr, stack: Stack) -> tuple[set[str], list[tuple[Instr, Stack]]]:
        """What a value is itself, and the values that it may come from."""
        facts = self.follower.facts.get(instr, ())
        if any(fact.before is None or fact.before.name != fact.name for fact in facts):
            return {"param"}, []
        calls = self.follower.flow.points.calls
        values: Iterable[Instr] = ()
        match instr.op:
            case "const" | "function" | "class" | "module" | "external":
                return {"const"}, []
            case "binary" | "unary" | "copy":
                return set(), [(value, stack) for value in instr.args]
            case "call" if instr not in calls.callees and (facts or self._computes(instr)):
                values = instr.args[1:]
                alone = {"param"} if facts else {"const"}
                return set() if values else alone, [(value, stack) for value in values]
            case "build":
                values = instr.args
                return set() if values else {"const"}, [(value, stack) for value in values]
            case "param" if stack and self._given(instr, stack):
                return set(), [(value, stack[:-1]) for value in self._given(instr, stack)]
        if instr.op == "param" and instr.function in calls.registered:
            return {"other"}, []
        origins = list(self.follower.flow.origins(instr))
        if not origins:
            values = instr.args[:1] if facts else ()
            return set() if facts else {"other"}, [(value, stack) for value in values]
        own = instr.function
        return set(), [(each, stack if each.function is own else ()) for each in origins]

    def _given(self, param: Instr, stack: Stack) -> list[Instr]:
        return self.follower.flow.points.calls.given.get((stack[-1], param), [])

    def _computes(self, instr: Instr) -> bool:
        """True for a call whose result depends on its arguments alone: ``abs``, ``max``."""
        flow = self.follower.flow
        paths = flow.points.calls.outside.get(instr, {})
        return any(path in self.follower.rules.arithmetic for path, _ in paths)


def find_constants(follower: Follower) -> list[Found]:
    """The comparisons with hard-coded numbers, and the predicates that they decide, in order.

    Such a number is a literal, or a name of a module or class that is bound to one. Left out are
    truth values, ``None``, texts, ``!= 0``, and comparisons that have a parameter on one side.
    """
    found: dict[tuple[object, ...], Found] = {}
    for instr in follower.flow.points.program.instructions():
        if instr.op != "compare":
            continue
        for operand in (0, 1):
            name = _constant(instr, operand, follower.constants)
            if name is not None:
                key = (instr.function.module, span_of(instr, operand))
                one = found.setdefault(key, Found(instr, operand, name, []))
                one.predicates.update(dict.fromkeys(follower.outcomes.predicates(instr)))
                break
    return list(found.values())


def _constant(instr: Instr, operand: int, constants: Constants) -> str | None:
    """The name of the constant that is one operand, if the other operand is not a constant."""
    threshold, other = instr.args[operand], instr.args[1 - operand]
    number = constants.number(threshold)
    values = constants.values(threshold)
    if number is None or isinstance(values[0], bool) or instr.data in ("In", "NotIn"):
        return None
    if constants.number(other) is not None or (number == 0 and instr.data == "NotEq"):
        return None
    is_negative = threshold.op == "unary" and threshold.args[0].op == "const"
    if threshold.op == "const" or is_negative:
        return repr(values[0])
    if threshold.op == "load" and isinstance(threshold.data, Variable):
        return named_variable(threshold) if threshold.data.owner.qualname == "<module>" else None
    if threshold.op == "attr" and str(threshold.data).isupper():
        return named_variable(threshold)
    return None
