"""Forward: from the outcome of a comparison to the predicates that it decides."""

from __future__ import annotations

from pytpc.python_analysis.flow.constants import Constants
from pytpc.python_analysis.flow.value_flow import Flow, Stack
from pytpc.python_analysis.ir.instructions import Instr
from pytpc.python_analysis.rules_file import Rules

_OF_OUTCOMES = {"any", "all", "sum", "max", "min", "item", "copy", "astype", "tolist"}
"""Methods of numpy's arrays of outcomes."""


class Outcomes:
    """Follows outcomes of comparisons.

    ``selecting``: instructions that choose elements by an outcome without a branch, as in
    ``scan[scan < limit]``.
    """

    def __init__(self, flow: Flow, constants: Constants, rules: Rules) -> None:
        self.flow = flow
        self.constants = constants
        self.rules = rules
        self.selecting: dict[Instr, None] = {}

    def predicates(self, outcome: Instr, stack: Stack = ()) -> list[Instr]:
        """The branches that the outcome of a comparison decides; the outcome came by ``stack``."""
        seen = {(outcome, stack)}
        waiting = [(outcome, stack)]
        found: dict[Instr, None] = {}
        while waiting:
            value, here = waiting.pop()
            following = [(to, after) for to, _, after in self.flow.moves(value, here)]
            found.update(dict.fromkeys(self._filtering(value)))
            for user in self.flow.users.get(value, ()):
                if self._selects(user, value):
                    self.selecting[user] = None
                    found[user] = None
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
        """The calls of ``filter`` and similar functions to which a function returns ``value``."""
        if all(user.op != "return" for user in self.flow.users.get(value, ())):
            return []
        calls = self.flow.points.calls
        return [
            call
            for call in calls.registered.get(value.function, ())
            if any(path in self.rules.filters for path, _ in calls.outside.get(call, ()))
        ]

    def _selects(self, user: Instr, value: Instr) -> bool:
        """True where the outcome ``value`` chooses elements: a mask, ``numpy.where``."""
        if user.op == "item":
            return user.args[1] is value
        outside = self.flow.points.calls.outside.get(user, {})
        return any(path in self.rules.filters for path, _ in outside)

    def _passes(self, user: Instr, value: Instr) -> bool:
        """True where the value of ``user`` has the information of the outcome ``value``."""
        match user.op:
            case "unary" | "match" | "iter" | "next":
                return True
            case "binary":
                return str(user.data).startswith("Bit")
            case "compare":
                return self._with_truth(user, value)
            case "call":
                return self._passes_outcome(user, value)
            case "attr":
                return str(user.data) in _OF_OUTCOMES and self.flow.is_called(user)
            case "item":
                return user.args[0] is value
            case _:
                return False

    def _with_truth(self, compare: Instr, value: Instr) -> bool:
        other = compare.args[1] if compare.args[0] is value else compare.args[0]
        values = self.constants.values(other)
        return bool(values) and all(isinstance(each, bool) for each in values)

    def _passes_outcome(self, call: Instr, value: Instr) -> bool:
        if call.args[0] is value:
            return value.op == "attr"
        outside = self.flow.points.calls.outside.get(call, {})
        return any(path in self.rules.outcomes for path, _ in outside)
