"""Forward: from parameter reads to the comparisons with their values, and on to predicates."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from pytpc.pynodes.constants import DYNAMIC, Constants
from pytpc.pynodes.contexts import Stack, moves
from pytpc.pynodes.flow import Flow
from pytpc.pynodes.ir import Instr, Variable
from pytpc.pynodes.library_calls import INSIDE, Inside, compared_inside
from pytpc.pynodes.reads import Read
from pytpc.pynodes.rules_file import Rules
from pytpc.pynodes.transform import How, by_function, by_operator

FLAG = -1
"""In place of an operand: the value itself is the condition."""
RANGE = -2
"""The value bounds the ``range`` that a loop runs over."""
_VARIANTS = 3
_LONGEST_NAME = 200


@dataclass(eq=False, slots=True)
class Fact:
    """``at`` has the value of the parameter ``name``, after ``how``.

    ``before`` is the fact that it follows from, ``via`` the store or call that brought it, and
    ``stack`` the calls by which it came into its function.
    """

    at: Instr
    read: Read
    name: str
    how: How
    stack: Stack = ()
    before: Fact | None = None
    via: Instr | None = None


@dataclass(eq=False, slots=True)
class Compared:
    """A comparison ``at`` with the operand number ``operand``, or one of the kinds above.

    ``inside``: it is in the library function that ``at`` calls.
    """

    at: Instr
    operand: int
    fact: Fact
    inside: Inside | None = None
    predicates: list[Instr] = field(default_factory=list)


@dataclass(eq=False, slots=True)
class Lost:
    """Where a parameter's value, or a comparison's outcome, is not followed any further."""

    at: Instr
    fact: Fact
    is_outcome: bool = False


class Follower:
    """Follows values from reads; ``compared`` and ``lost`` are what is found."""

    def __init__(self, flow: Flow, constants: Constants, rules: Rules) -> None:
        """Nothing is followed yet."""
        self.flow = flow
        self.constants = constants
        self.rules = rules
        self.facts: dict[Instr, list[Fact]] = {}
        self.compared: dict[tuple[Instr, int, int, str, Stack], Compared] = {}
        self.lost: dict[Instr, Lost] = {}
        self._inside: dict[Instr, dict[int, Inside]] = {}
        self._waiting: deque[Fact] = deque()

    def run(self, reads: list[Read]) -> None:
        """Follow all reads."""
        for read in reads:
            for stack in read.stacks:
                self._reach(Fact(read.instr, read, read.name, How(), stack))
        while self._waiting:
            self._step(self._waiting.popleft())

    def _reach(self, fact: Fact) -> None:
        known = self.facts.setdefault(fact.at, [])
        alike = [
            each
            for each in known
            if each.read is fact.read and each.name == fact.name and each.stack == fact.stack
        ]
        if len(alike) >= _VARIANTS or any(each.how == fact.how for each in alike):
            return
        known.append(fact)
        self._waiting.append(fact)

    def _on(self, fact: Fact, at: Instr, via: Instr | None, how: How | None = None) -> None:
        self._reach(Fact(at, fact.read, fact.name, how or fact.how, fact.stack, fact, via))

    def _step(self, fact: Fact) -> None:
        for to, via, stack in moves(self.flow, fact.at, fact.stack):
            self._reach(Fact(to, fact.read, fact.name, fact.how, stack, fact, via))
        for user in self.flow.users.get(fact.at, ()):
            self._use(fact, user)

    def _use(self, fact: Fact, user: Instr) -> None:
        match user.op:
            case "compare":
                for operand in (0, 1):
                    if user.args[operand] is fact.at:
                        self._compare(fact, user, operand)
            case "branch":
                self._compare(fact, fact.at, FLAG, user)
            case "match":
                self._compare(fact, fact.at, FLAG)
            case "binary":
                self._binary(fact, user)
            case "unary":
                how = fact.how.times(-1.0) if user.data == "USub" else fact.how
                self._on(fact, user, None, how)
            case "attr":
                self._attribute(fact, user)
            case "item":
                if user.args[0] is fact.at:
                    self._item(fact, user, user.args[1])
            case "iter":
                for each in self.flow.users.get(user, ()):
                    if each.op == "next":
                        self._on(fact, each, None)
            case "call":
                self._call(fact, user)
            case "build" if user.data == "text":
                self._lose(fact, user)
            case _:
                pass

    def _lose(self, fact: Fact, at: Instr) -> None:
        self.lost.setdefault(at, Lost(at, fact))

    def _binary(self, fact: Fact, user: Instr) -> None:
        left, right = user.args
        if left is not right and self._same(left, right):
            if user.data == "Mult" and left is fact.at:
                self._arithmetic(fact, user, fact.how.call("pow", 2.0))
            return
        if left is right:
            self._lose(fact, user)
            return
        other = right if left is fact.at else left
        number = self.constants.number(other)
        how = None
        if number is not None:
            how = by_operator(fact.how, str(user.data), number, other is left)
        self._arithmetic(fact, user, how)

    def _same(self, one: Instr, other: Instr) -> bool:
        """True where two instructions read the same variable, with nothing stored in between."""
        if one.op != other.op or one.data != other.data:
            return False
        stores = self.flow.reaching.stores
        if one.op == "load":
            return stores.get(one) == stores.get(other)
        if one.op == "attr":
            return self._same(one.args[0], other.args[0]) and stores.get(one) == stores.get(other)
        return False

    def _arithmetic(self, fact: Fact, user: Instr, how: How | None) -> None:
        if how is None or (fact.read.is_table and not fact.name):
            self._lose(fact, user)
        else:
            self._on(fact, user, None, how)

    def _attribute(self, fact: Fact, user: Instr) -> None:
        name = str(user.data)
        if fact.read.is_table and not fact.name:
            if not name.startswith("_") and not self._is_called(user):
                self._named(fact, user, [name])
        elif not self._is_called(user):
            if name in self.rules.values:
                self._on(fact, user, None, fact.how.times(self.rules.values[name]))
            return
        for call in self.flow.users.get(user, ()):
            if call.op == "call" and call.args[0] is user:
                self._method(fact, call, name)

    def _is_called(self, attr: Instr) -> bool:
        users = self.flow.users.get(attr, ())
        return any(user.op == "call" and user.args[0] is attr for user in users)

    def _item(self, fact: Fact, user: Instr, key: Instr) -> None:
        keys = self.constants.values(key)
        if key.op == "build" or (keys and all(isinstance(each, int) for each in keys)):
            self._on(fact, user, None)
            return
        self._named(fact, user, [each if isinstance(each, str) else DYNAMIC for each in keys])

    def _named(self, fact: Fact, user: Instr, keys: list[str]) -> None:
        """An entry of a table of parameters."""
        for key in dict.fromkeys(keys):
            name = f"{fact.name.rstrip('/')}/{key}" if fact.name else key
            if len(name) <= _LONGEST_NAME:
                self._reach(Fact(user, fact.read, name, fact.how, fact.stack, fact))

    def _call(self, fact: Fact, user: Instr) -> None:
        function = user.args[0]
        outside = self.flow.points.calls.outside.get(user, {})
        if function is fact.at:
            return
        for path, _ in outside:
            self._argument(fact, user, path)

    def _method(self, fact: Fact, call: Instr, name: str) -> None:
        """A call of a method of the value."""
        if name in self.rules.values:
            self._on(fact, call, call, fact.how.times(self.rules.values[name]))
        elif name == "get" and len(call.args) > 1:
            self._item(fact, call, call.args[1])
        elif name in ("items", "values", "keys", "copy"):
            pass
        else:
            self._lose(fact, call)

    def _argument(self, fact: Fact, user: Instr, path: str) -> None:
        """A value that is handed to a function outside the sources."""
        if path in self.rules.comparisons and self._compare_inside(fact, user):
            return
        op = self.rules.arithmetic.get(path)
        args = user.args[1:]
        if op is None:
            if path == "builtins.range":
                self._compare(fact, user, RANGE, *self._loops_over(user))
            elif path not in self.rules.reads and not self._is_exposing(path):
                self._lose(fact, user)
            return
        others = [arg for arg in args if arg is not fact.at]
        if op == "second":
            if args and args[-1] is fact.at:
                self._on(fact, user, user)
            return
        if op in ("min", "max") and not others:
            self._lose(fact, user)
            return
        number = self.constants.number(others[0]) if len(others) == 1 else None
        left = bool(others) and others[0] is args[0]
        if len(others) > 1 or (others and number is None and op not in ("same", "round")):
            self._lose(fact, user)
            return
        how = by_function(fact.how, op, number, left)
        self._arithmetic(fact, user, how)

    def _compare_inside(self, fact: Fact, call: Instr) -> bool:
        """A comparison inside of a library function; True where its result is the outcome."""
        if call not in self._inside:
            self._inside[call] = compared_inside(self.flow, call)
        is_outcome = False
        for place, inside in self._inside[call].items():
            if call.args[1 + place] is fact.at:
                self._compare(fact, call, INSIDE - place)
                is_outcome |= not inside.chooses
        return is_outcome

    def _is_exposing(self, path: str) -> bool:
        return path in self.rules.exposing or path.startswith(("rospy.log", "builtins.print"))

    def _loops_over(self, value: Instr) -> list[Instr]:
        """The branches of the loops over a value."""
        found = []
        for source in self.flow.users.get(value, ()):
            if source.op == "iter":
                for more in self.flow.users.get(source, ()):
                    users = self.flow.users.get(more, ()) if more.op == "more" else ()
                    found += [user for user in users if user.op == "branch"]
        return found

    def _compare(self, fact: Fact, at: Instr, operand: int, *branches: Instr) -> None:
        if fact.read.is_table and not fact.name:
            return
        key = (at, operand, id(fact.read), fact.name, fact.stack)
        if key not in self.compared:
            inside = self._inside[at][INSIDE - operand] if operand <= INSIDE else None
            self.compared[key] = Compared(at, operand, fact, inside)
        predicates = self.compared[key].predicates
        predicates += [branch for branch in branches if branch not in predicates]

    # Outcomes

    def decide(self) -> None:
        """Find the predicates that each comparison's outcome decides."""
        self._keep_lost()
        known: dict[tuple[Instr, Stack], list[Instr]] = {}
        for compared in self.compared.values():
            if compared.inside is not None and compared.inside.chooses:
                compared.predicates = [compared.at]
            elif compared.operand >= 0 or compared.inside is not None:
                way = (compared.at, compared.fact.stack)
                if way not in known:
                    known[way] = self.predicates(*way)
                compared.predicates = known[way]
            elif compared.operand == FLAG:
                compared.predicates += [
                    branch
                    for user in self.flow.users.get(compared.at, ())
                    if user.op == "match"
                    for branch in self.flow.users.get(user, ())
                    if branch.op == "branch" and branch not in compared.predicates
                ]

    def _keep_lost(self) -> None:
        """What is measured, and cut to a parameter, is measured: no threshold is lost there."""
        for call, lost in list(self.lost.items()):
            others = [arg for arg in call.args[1:] if arg is not lost.fact.at]
            if self._inside.get(call) and not any(arg in self.facts for arg in others):
                del self.lost[call]

    def predicates(self, outcome: Instr, stack: Stack = ()) -> list[Instr]:
        """The branches that the outcome of a comparison decides, where it came by ``stack``."""
        seen = {(outcome, stack)}
        waiting = [(outcome, stack)]
        found: dict[Instr, None] = {}
        while waiting:
            value, here = waiting.pop()
            following = [(to, after) for to, _, after in moves(self.flow, value, here)]
            found.update(dict.fromkeys(self._filtering(value)))
            for user in self.flow.users.get(value, ()):
                if user.op == "branch":
                    found[user] = None
                elif self._passes(user, value):
                    following.append((user, here))
            for to, after in following:
                if to.op == "branch":
                    found[to] = None
                elif (to, after) not in seen:
                    seen.add((to, after))
                    waiting.append((to, after))
        return list(found)

    def _filtering(self, value: Instr) -> list[Instr]:
        """The calls of ``filter`` and its kin to which a function returns ``value``."""
        if all(user.op != "return" for user in self.flow.users.get(value, ())):
            return []
        calls = self.flow.points.calls
        return [
            call
            for call in calls.registered.get(value.function, ())
            if any(path in self.rules.filters for path, _ in calls.outside.get(call, ()))
        ]

    def _passes(self, user: Instr, value: Instr) -> bool:
        """True where the value of ``user`` says what the outcome ``value`` says."""
        match user.op:
            case "unary" | "match" | "iter" | "next":
                return True
            case "binary":
                return str(user.data).startswith("Bit")
            case "compare":
                return self._with_truth(user, value)
            case "call":
                return self._passes_outcome(user)
            case _:
                return False

    def _with_truth(self, compare: Instr, value: Instr) -> bool:
        other = compare.args[1] if compare.args[0] is value else compare.args[0]
        values = self.constants.values(other)
        return bool(values) and all(isinstance(each, bool) for each in values)

    def _passes_outcome(self, call: Instr) -> bool:
        outside = self.flow.points.calls.outside.get(call, {})
        return any(path in self.rules.outcomes for path, _ in outside)


def named_variable(instr: Instr) -> str | None:
    """The variable or attribute whose value an instruction has."""
    if instr.op == "load" and isinstance(instr.data, Variable):
        return None if instr.data.name.startswith("<") else instr.data.name
    if instr.op == "attr":
        owner = named_variable(instr.args[0])
        return f"{owner}.{instr.data}" if owner else str(instr.data)
    if instr.op in ("copy", "item") and instr.args:
        return named_variable(instr.args[0])
    return None
