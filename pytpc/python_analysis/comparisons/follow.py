"""Forward: from parameter reads to the comparisons with their values, and on to predicates."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

from pytpc.python_analysis.comparisons.facts import FLAG, RANGE, Compared, Fact, keeps_formula
from pytpc.python_analysis.comparisons.outcomes import Outcomes
from pytpc.python_analysis.comparisons.reads import Read
from pytpc.python_analysis.comparisons.transform import How, by_function, by_operator
from pytpc.python_analysis.flow.constants import DYNAMIC, Constants
from pytpc.python_analysis.flow.library_calls import INSIDE, Inside, compared_inside
from pytpc.python_analysis.flow.value_flow import Flow, Stack
from pytpc.python_analysis.ir.instructions import Instr, Shape
from pytpc.python_analysis.rules_file import Rules

_VARIANTS = 3
_LONGEST_NAME = 200
_TAKING = {"get", "pop", "setdefault"}
"""Methods of a dict that give the entry of their first argument."""


class Follower:
    """Follows values from reads; ``compared`` and ``lost`` are the results.

    ``lost``: where a parameter's value is not followed any further.
    """

    def __init__(self, flow: Flow, constants: Constants, rules: Rules) -> None:
        self.flow = flow
        self.constants = constants
        self.rules = rules
        self.facts: dict[Instr, list[Fact]] = {}
        self.compared: dict[tuple[Instr, int, int, str, Stack], Compared] = {}
        self.lost: dict[Instr, Fact] = {}
        self._inside: dict[Instr, dict[int, Inside]] = {}
        self.outcomes = Outcomes(flow, constants, rules)
        self._waiting: deque[Fact] = deque()

    def run(self, reads: list[Read]) -> None:
        """Follow all reads."""
        for read in reads:
            for stack in read.stacks:
                self._reach(
                    Fact(read.instr, read, read.name, How(), stack, is_object=read.is_object)
                )
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
        if how is not None and not how.is_finite:
            self._lose(fact, at)
            return
        self._reach(replace(fact, at=at, how=how or fact.how, before=fact, via=via))

    def _value(self, fact: Fact, at: Instr, via: Instr | None, name: str) -> None:
        """The attribute ``name``, or what a method of this name returns, is the value."""
        how = fact.how.times(self.rules.values[name])
        self._reach(replace(fact, at=at, how=how, before=fact, via=via, is_object=False))

    def _step(self, fact: Fact) -> None:
        for to, via, stack in self.flow.moves(fact.at, fact.stack):
            if to.op == "attr" and self.flow.is_by_unknown_name(to, via):
                continue
            if fact.how.others and not keeps_formula(fact, to, via):
                self._lose(fact, via or to)
                continue
            if via is not None and (fact.at, via) in self.flow.points.spread:
                self._entry(fact, to)
                continue
            self._reach(replace(fact, at=to, stack=stack, before=fact, via=via))
        for user in self.flow.users.get(fact.at, ()):
            self._use(fact, user)

    def _entry(self, fact: Fact, to: Instr) -> None:
        """An entry of a table of parameters that became one of another dict, or an attribute."""
        if to.op == "attr":
            self._named(fact, to, [str(to.data)])
        elif to.op == "item":
            self._item(fact, to, to.args[1])
        elif to.op == "call" and len(to.args) > 1:
            # `get` of a dict; `getattr`.
            self._item(fact, to, to.args[1 if to.args[0].op == "attr" else -1])
        else:
            self._on(fact, to, None)

    def _use(self, fact: Fact, user: Instr) -> None:
        if fact.how.others and user.op in ("branch", "match", "item", "iter"):
            self._lose(fact, user)
            return
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
        self.lost.setdefault(at, fact)

    def _binary(self, fact: Fact, user: Instr) -> None:
        left, right = user.args
        if left is not right and self.same(left, right):
            if user.data == "Mult" and left is fact.at:
                self._arithmetic(fact, user, fact.how.call("pow", 2.0))
            return
        if left is right:
            self._lose(fact, user)
            return
        other = right if left is fact.at else left
        number = self.constants.number(other)
        if number is not None:
            how = by_operator(fact.how, str(user.data), number, other is left)
        elif fact.read.type == "string" or self._is_no_number(other):
            how = None
        else:
            how = fact.how.mixed(str(user.data), other, other is left)
        self._arithmetic(fact, user, how)

    def _is_no_number(self, value: Instr) -> bool:
        """True for text, and for what is built on the spot: a list, a tuple, a dict."""
        if value.op == "build":
            return True
        values = self.constants.values(value)
        return bool(values) and all(isinstance(each, str) for each in values)

    def same(self, one: Instr, other: Instr) -> bool:
        """True where two instructions read the same variable, with nothing stored in between."""
        if one.op != other.op or one.data != other.data:
            return False
        stores = self.flow.reaching.stores
        if one.op == "load":
            return stores.get(one) == stores.get(other)
        if one.op == "attr":
            return self.same(one.args[0], other.args[0]) and stores.get(one) == stores.get(other)
        return False

    def _arithmetic(self, fact: Fact, user: Instr, how: How | None) -> None:
        if how is None or (fact.read.is_table and not fact.name):
            self._lose(fact, user)
        else:
            self._on(fact, user, None, how)

    def _attribute(self, fact: Fact, user: Instr) -> None:
        name = str(user.data)
        if fact.read.is_table and not fact.name:
            if not name.startswith("_") and not self.flow.is_called(user):
                self._named(fact, user, [name])
        elif not self.flow.is_called(user):
            if name in self.rules.values:
                self._value(fact, user, None, name)
            return
        for call in self.flow.users.get(user, ()):
            if call.op == "call" and call.args[0] is user:
                self._method(fact, call, name)

    def _item(self, fact: Fact, user: Instr, key: Instr) -> None:
        keys = self.constants.values(key)
        if key.op == "build" or (keys and all(isinstance(each, int) for each in keys)):
            self._on(fact, user, None)
            return
        self._named(fact, user, [each if isinstance(each, str) else DYNAMIC for each in keys])

    def _named(self, fact: Fact, user: Instr, keys: list[str]) -> None:
        """An entry of a table of parameters."""
        for key in dict.fromkeys(keys):
            above = (fact.name or fact.read.namespace).rstrip("/")
            sign = fact.read.separator if above not in ("", "~") else ""
            name = f"{above}{sign}{key}"
            if len(name) <= _LONGEST_NAME:
                self._reach(replace(fact, at=user, name=name, before=fact, via=None))

    def _call(self, fact: Fact, user: Instr) -> None:
        function = user.args[0]
        outside = self.flow.points.calls.outside.get(user, {})
        if function is fact.at:
            return
        for path, _ in outside:
            self._argument(fact, user, path)
        self._unpacked(fact, user)

    def _unpacked(self, fact: Fact, call: Instr) -> None:
        """``f(x, **table)``: each entry comes to the parameter of its name if that is free."""
        names = getattr(call.data, "names", ())
        if not any(n == "**" and v is fact.at for n, v in zip(names, call.args[1:], strict=True)):
            return
        calls = self.flow.points.calls
        for function in calls.callees.get(call, {}):
            for place, variable in enumerate(function.parameters):
                param = function.param_instrs[place]
                if place == function.kwarg:
                    self._on(fact, param, None)
                elif place != function.vararg and calls.may_unpack(call, param):
                    self._named(fact, param, [variable.name])

    def _method(self, fact: Fact, call: Instr, name: str) -> None:
        """A call of a method of the value."""
        if name in self.rules.values:
            self._value(fact, call, call, name)
        elif name in _TAKING and len(call.args) > 1:
            self._item(fact, call, call.args[1])
        elif name == "copy":
            self._on(fact, call, call)
        elif name == "values":
            self._named(fact, call, [DYNAMIC])
        elif name == "items":
            self._pairs(fact, call)
        elif name != "keys":
            self._lose(fact, call)

    def _pairs(self, fact: Fact, call: Instr) -> None:
        """``for name, value in table.items()``: the value is an entry."""
        users = self.flow.users
        loops = [each for each in users.get(call, ()) if each.op == "iter"]
        if not loops:
            self._lose(fact, call)
        for pair in (each for loop in loops for each in users.get(loop, ()) if each.op == "next"):
            for part in users.get(pair, ()):
                if part.op == "item" and self.constants.values(part.args[1]) == (1,):
                    self._named(fact, part, [DYNAMIC])

    def _argument(self, fact: Fact, user: Instr, path: str) -> None:
        """A value that is passed to a function outside the sources."""
        if (fact.at, user) in self.flow.points.spread:
            return
        op = self.rules.arithmetic.get(path)
        if fact.how.others and op != "same":
            if not self._is_exposing(path):
                self._lose(fact, user)
            return
        if path in self.rules.comparisons and self._compare_inside(fact, user):
            return
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
        names = user.data.names if isinstance(user.data, Shape) else ()
        for name, value in zip(names, args, strict=False):
            if value is fact.at and name in self.rules.units and how is not None:
                how = how.times(self.rules.units[name])
        self._arithmetic(fact, user, how)

    def _compare_inside(self, fact: Fact, call: Instr) -> bool:
        """A comparison inside a library function; true where the function returns the outcome."""
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
        if fact.is_object or (fact.read.is_table and not fact.name):
            return
        key = (at, operand, id(fact.read), fact.name, fact.stack)
        if key not in self.compared:
            inside = self._inside[at][INSIDE - operand] if operand <= INSIDE else None
            self.compared[key] = Compared(at, operand, fact, inside)
        predicates = self.compared[key].predicates
        predicates += [branch for branch in branches if branch not in predicates]

    def decide(self) -> None:
        """Find the predicates that each comparison's outcome decides."""
        self._drop_measured()
        known: dict[tuple[Instr, Stack], list[Instr]] = {}
        for compared in self.compared.values():
            if compared.inside is not None and compared.inside.chooses:
                compared.predicates = [compared.at]
            elif compared.operand >= 0 or compared.inside is not None:
                way = (compared.at, compared.fact.stack)
                if way not in known:
                    known[way] = self.outcomes.predicates(*way)
                compared.predicates = known[way]
            elif compared.operand == FLAG:
                compared.predicates += [
                    branch
                    for user in self.flow.users.get(compared.at, ())
                    if user.op == "match"
                    for branch in self.flow.users.get(user, ())
                    if branch.op == "branch" and branch not in compared.predicates
                ]

    def _drop_measured(self) -> None:
        """A measurement that is clamped to a parameter is still one: nothing is lost there."""
        for call, fact in list(self.lost.items()):
            for place, inside in self._inside.get(call, {}).items():
                is_bound = call.args[1 + place] is fact.at
                if is_bound and not any(other in self.facts for other in inside.others):
                    del self.lost[call]
                    break
