"""The messages that a comparison depends on.

A node gets messages through the callbacks of its subscriptions. From a comparison backwards over
data and control dependence, this finds the callbacks whose messages it depends on: first for the
compared value, then for whether it is evaluated. The search ends at the callbacks.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Literal

from pytpc.python_analysis.comparisons.facts import FLAG
from pytpc.python_analysis.comparisons.gather import Found
from pytpc.python_analysis.comparisons.reads import Exposed, handed, topic_of
from pytpc.python_analysis.comparisons.slicing import Slicer
from pytpc.python_analysis.flow.constants import Constants
from pytpc.python_analysis.flow.value_flow import Flow
from pytpc.python_analysis.ir.instructions import Function, Instr
from pytpc.python_analysis.points_to.call_table import CallTable, argument
from pytpc.python_analysis.points_to.objects import Obj
from pytpc.python_analysis.rules_file import Rules

_MOST = 2000
"""Instructions of one search: what is farther says little of the message."""
_ROS1 = ("rospy.", "message_filters.")


@dataclass(frozen=True, eq=False, slots=True)
class Subscription:
    """A call that subscribes; ``topic`` and ``type`` are None where they are not constant."""

    instr: Instr
    topic: str | None
    type: str | None


@dataclass(frozen=True, slots=True)
class Arrival:
    """A subscription whose messages a comparison depends on, by its value or by control."""

    subscription: Subscription
    by: Literal["value", "control"]


def message_type(flow: Flow, given: Instr | None, api: str) -> str | None:
    """``std_msgs/Bool`` (ROS 2: ``std_msgs/msg/Bool``) for the class that a call is given."""
    names = set() if given is None else set(_dotted(flow, given))
    parts = names.pop().split(".") if len(names) == 1 else []
    if len(parts) < 3 or parts[1] != "msg":
        return None
    return "/".join([parts[0], *([] if api.startswith(_ROS1) else ["msg"]), parts[-1]])


def _dotted(flow: Flow, value: Instr) -> Iterator[str]:
    if value.op == "external":
        yield str(value.data)
    elif value.op == "attr":
        yield from (f"{above}.{value.data}" for above in _dotted(flow, value.args[0]))
    elif value.op == "load":
        for origin in flow.origins(value):
            yield from _dotted(flow, origin)


def type_shown(flow: Flow, exposed: Exposed, rules: Rules) -> str | None:
    """The type of the messages that an exposing statement publishes; None if it is not known."""
    function = exposed.instr.args[0] if exposed.instr.op == "call" else None
    owners: Iterable[Obj] = (
        () if function is None or not function.args else (flow.points.of(function.args[0]))
    )
    found = {
        message_type(flow, argument(CallTable.arguments(owner.site), rules.types[path]), path)
        for owner in owners
        if owner.site is not None
        for path, _ in flow.points.calls.outside.get(owner.site, ())
        if path in rules.types
    }
    return found.pop() if len(found) == 1 else None


@dataclass(slots=True)
class Messages:
    """The subscriptions of a program, and the search."""

    flow: Flow
    slicer: Slicer
    functions: dict[Function, list[Subscription]] = field(default_factory=dict)
    params: dict[Instr, list[Subscription]] = field(default_factory=dict)

    @classmethod
    def of(cls, flow: Flow, constants: Constants, rules: Rules, slicer: Slicer) -> Messages:
        """Find the subscriptions."""
        made = cls(flow, slicer)
        for instr, paths in flow.points.calls.outside.items():
            for path, _ in paths:
                if path not in rules.subscriptions:
                    continue
                given = CallTable.arguments(instr)
                kind = message_type(flow, argument(given, rules.types[path]), path)
                found = Subscription(instr, topic_of(instr, path, constants, rules), kind)
                callback = argument(given, rules.subscriptions[path])
                for param in handed(flow, callback, 0):
                    made.params.setdefault(param, []).append(found)
                    made.functions.setdefault(param.function, []).append(found)
        return made

    def received(self, found: Found) -> list[Arrival]:
        """What a comparison depends on: the nearest first, those of the value before the others."""
        if not self.functions:
            return []
        search = _Search(self)
        values = (
            [] if found.operand == FLAG
            else [each for each in found.at.args if each is not found.threshold]
        )  # fmt: skip
        search.run(values, [], "value")
        search.run([], [found.at], "control")
        return list(search.found.values())


class _Search:
    def __init__(self, of: Messages) -> None:
        self.of = of
        self.found: dict[Subscription, Arrival] = {}
        self._seen: set[tuple[Instr, bool]] = set()
        self._work: deque[tuple[Instr, bool]] = deque()

    def run(
        self, values: Iterable[Instr], running: Iterable[Instr], by: Literal["value", "control"]
    ) -> None:
        self._work.clear()
        self._push(values, is_value=True)
        self._push(running, is_value=False)
        most = len(self._seen) + _MOST
        while self._work and len(self._seen) < most:
            instr, is_value = self._work.popleft()
            arrived = self._value(instr) if is_value else self._runs(instr)
            for each in arrived:
                self.found.setdefault(each, Arrival(each, by))

    def _push(self, instrs: Iterable[Instr], *, is_value: bool) -> None:
        for instr in instrs:
            if (instr, is_value) not in self._seen:
                self._seen.add((instr, is_value))
                self._work.append((instr, is_value))

    def _value(self, instr: Instr) -> list[Subscription]:
        """Go on to what the value of ``instr`` is computed from."""
        if instr in self.of.params:
            return self.of.params[instr]
        for source in self.of.flow.sources(instr):
            self._push([source], is_value=True)
            if source.op in ("store", "setattr", "setitem", "return"):
                self._push([source], is_value=False)
        is_own_call = instr.op == "call" and instr in self.of.flow.points.calls.callees
        if instr.op in ("setattr", "setitem"):
            self._push(instr.args[1:], is_value=True)
        elif not is_own_call and instr.op not in ("function", "class"):
            # The arguments of a call of one's own count where the function uses them.
            self._push(instr.args, is_value=True)
        return []

    def _runs(self, instr: Instr) -> list[Subscription]:
        """Go on to what decides whether ``instr`` runs."""
        for deciding in self.of.slicer.controlling(instr):
            if deciding.op == "branch":
                self._push(deciding.args, is_value=True)
            self._push([deciding], is_value=False)
        arrived = self.of.functions.get(instr.function, [])
        if not arrived:
            self._push(self.of.flow.points.calls.callers.get(instr.function, ()), is_value=False)
        return arrived
