"""The path of a comparison in the words of the source: from the first read to the exposing one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pytpc.python_analysis.comparisons.facts import Fact
from pytpc.python_analysis.comparisons.gather import Found, position
from pytpc.python_analysis.comparisons.slicing import Slice
from pytpc.python_analysis.ir.instructions import Function, Instr, Variable
from pytpc.python_analysis.ir.names import named_variable
from pytpc.static.link_unit import PathStep

_AT_MOST = 32
_TELLING = (
    "expose", "compare", "decide", "control", "value", "read", "call", "pass", "return", "store",
    "compute", "load",
)  # fmt: skip


@dataclass(frozen=True)
class _Event:
    step: str
    at: Instr
    what: str


def path_of(
    found: Found, within: Slice, source: Callable[[Instr, int], str | None]
) -> tuple[PathStep, ...]:
    """The steps of docs/reference/formats.md, one for each line.

    Args:
        found: a comparison with a parameter that decides something exposed.
        within: the slice.
        source: gives the text of a line of an instruction's file.
    """
    before = _merged(_to_comparison(found), source)
    after = _merged(_to_exposing(found, within), source)
    return (*_shortened(before), *_shortened(after))


def _shortened(steps: list[PathStep]) -> list[PathStep]:
    if len(steps) <= _AT_MOST:
        return steps
    what = f"{len(steps) - _AT_MOST} steps are left out"
    return [*steps[: _AT_MOST - 1], PathStep("omitted", "", 0, 0, "", what, None), steps[-1]]


def _to_comparison(found: Found) -> list[_Event]:
    facts: list[Fact] = []
    fact: Fact | None = found.facts[0]
    while fact is not None:
        facts.append(fact)
        fact = fact.before
    facts.reverse()
    events = [_Event("read", facts[0].read.instr, f"{found.parameter} is read")]
    for fact in facts[1:]:
        events += _arrival(fact)
    is_value = found.operand < 0 and found.inside is None
    decides = "is the condition" if is_value else "compared"
    events.append(_Event("compare", found.at, decides))
    if found.predicate is not None and found.predicate is not found.at:
        same = position(found.predicate)[0] == position(found.at)[0]
        if not same:
            events.append(_Event("decide", found.predicate, "the outcome decides this branch"))
    return events


def _arrival(fact: Fact) -> list[_Event]:
    at, via = fact.at, fact.via
    name = named_variable(at)
    if at.op == "param" and isinstance(at.data, int):
        site = fact.stack[-1] if fact.stack else at
        variable = at.function.parameters[at.data].name
        return [_Event("pass", site, f"handed to {_shown(at.function)} as {variable}")]
    events = []
    if via is not None and via.op in ("store", "setattr", "setitem"):
        events.append(_Event("store", via, f"stored in {_target(via)}"))
    if at.op in ("load", "attr", "item", "next"):
        events.append(_Event("load", at, f"{name} is used" if name else "used"))
    elif at.op in ("binary", "unary"):
        events.append(_Event("compute", at, "computed with"))
    elif at.op == "call" and fact.before is not None:
        inner = fact.before.at.function
        returned = inner is not at.function
        what = f"returned by {_shown(inner)}" if returned else "converted"
        events.append(_Event("return" if returned else "compute", at, what))
    return events


def _shown(function: Function) -> str:
    return f"{function.qualname.rsplit('.', 1)[-1]}()"


def _target(store: Instr) -> str:
    if isinstance(store.data, Variable):
        return "the chosen value" if store.data.name.startswith("<") else store.data.name
    owner = named_variable(store.args[0]) or "an object"
    return f"{owner}.{store.data}" if store.op == "setattr" else f"an element of {owner}"


def _to_exposing(found: Found, within: Slice) -> list[_Event]:
    events: list[_Event] = []
    here = found.predicate
    seen: set[Instr] = set()
    while here is not None and here not in seen:
        seen.add(here)
        because = within.because.get(here)
        if because is None and here in within.holder:
            because = (within.holder[here], "data")
        if because is None:
            break
        after, how = because
        last = within.because.get(after) is None
        if last:
            break
        if after.op == "branch":
            step = "control" if how == "control" else "value"
            what = "guards what follows" if how == "data" else "is guarded by the step before"
            events.append(_Event(step, after, what))
        elif after.op in ("store", "setattr", "setitem"):
            events.append(_Event("store", after, f"stored in {_target(after)}"))
        elif after.op == "call":
            events.append(_Event("call", after, "called"))
        elif after.op == "return":
            events.append(_Event("return", after, f"returned by {_shown(after.function)}"))
        here = after
    if found.predicate is not None:
        exposed = within.nearest[found.predicate]
        on = f" on {exposed.topic}" if exposed.topic else ""
        events.append(_Event("expose", exposed.instr, f"{exposed.api.rsplit('.', 1)[-1]}{on}"))
    return events


def _merged(events: list[_Event], source: Callable[[Instr, int], str | None]) -> list[PathStep]:
    """One step for each line; of several events on a line it has the most telling one."""
    groups: list[list[_Event]] = []
    for event in events:
        line = (event.at.function.module, position(event.at)[0])
        if line[1] == 0:
            continue
        last = groups[-1][-1].at if groups else None
        if last is not None and line == (last.function.module, position(last)[0]):
            groups[-1].append(event)
        else:
            groups.append([event])
    return [_step(group, source) for group in groups]


def _step(group: list[_Event], source: Callable[[Instr, int], str | None]) -> PathStep:
    told = min(group, key=lambda event: _TELLING.index(event.step))
    line, column = position(told.at)
    function = told.at.function
    what = "; ".join(dict.fromkeys(event.what for event in group))
    return PathStep(
        told.step, function.module.path, line, column, function.qualname, what,
        source(told.at, line),
    )  # fmt: skip
