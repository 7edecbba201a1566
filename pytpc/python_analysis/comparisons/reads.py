"""The parameter reads and the exposing statements of a program."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pytpc.python_analysis.comparisons.parameter_lists import ParameterLists
from pytpc.python_analysis.flow.constants import DYNAMIC, Constants
from pytpc.python_analysis.flow.value_flow import Flow, Stack
from pytpc.python_analysis.ir.instructions import Function, Instr
from pytpc.python_analysis.points_to.call_table import CallTable, Given
from pytpc.python_analysis.points_to.objects import Obj
from pytpc.python_analysis.rules_file import Argument, ConfigRule, Rules
from pytpc.static.link_unit import Default

Context = tuple[Stack, dict[Instr, tuple[object, ...]]]
_MOST_CONTEXTS = 64
_DEEPEST = 3


@dataclass(eq=False, slots=True)
class Read:
    """A parameter read: ``instr`` has its value.

    ``is_table``: the value has parameters as its fields (a dynamic_reconfigure config), whose names
    are in ``namespace``. ``stacks``: the calls, the innermost last, through which its function
    reads this name.
    """

    name: str
    api: str
    instr: Instr
    default: Default = None
    is_table: bool = False
    namespace: str = ""
    type: str = ""
    stacks: tuple[Stack, ...] = ((),)


@dataclass(eq=False, slots=True)
class Exposed:
    """An exposing statement."""

    instr: Instr
    api: str
    topic: str | None


def argument(given: list[Given], where: Argument) -> Instr | None:
    """The argument of a call that a rule names; None where the call does not give it."""
    for keyword, value in given:
        if keyword is not None and keyword == where.keyword:
            return value
    positional = []
    for keyword, value in given:
        if keyword == "*":
            break
        if keyword is None:
            positional.append(value)
    place = where.place
    return positional[place] if place is not None and place < len(positional) else None


def find_reads(flow: Flow, constants: Constants, rules: Rules) -> list[Read]:
    """All reads in the order of the program, one for each name that a call may read."""
    found: list[Read] = []
    lists = ParameterLists(constants)
    for instr, paths in flow.points.calls.outside.items():
        given = CallTable.arguments(instr)
        for path, _ in paths:
            if path in rules.reads:
                found += _read(instr, path, given, constants, rules)
            if path in rules.configs:
                row = rules.configs[path]
                namespace = _namespace(argument(given, row.namespace), row, constants)
                params = _handed(flow, argument(given, row.callback), row.config)
                found += [
                    Read("", path, param, is_table=True, namespace=namespace) for param in params
                ]
            if path in rules.lists:
                found += _listed(flow, instr, path, given, lists)
    return sorted(found, key=lambda read: (read.instr.number, read.name))


def _namespace(given: Instr | None, row: ConfigRule, constants: Constants) -> str:
    """The namespace of a config's fields: ``~``, ``~planner``, ``/robot/planner``."""
    texts = [""] if given is None else constants.names(given)
    text = texts[0] if len(texts) == 1 else DYNAMIC
    own = row.is_private and not text.startswith(("/", "~"))
    return f"~{text}" if own else text


def _read(
    instr: Instr, path: str, given: list[Given], constants: Constants, rules: Rules
) -> list[Read]:
    where_name, where_default = rules.reads[path]
    name = argument(given, where_name)
    default = argument(given, where_default)
    names = [DYNAMIC] if name is None else constants.names(name)
    if name is None or (len(names) == 1 and DYNAMIC not in names[0]):
        return [_made(each, path, instr, _default(constants, default), ((),)) for each in names]
    # The name is an argument of the function that reads: each of its calls reads another name.
    found: dict[tuple[str, Default], list[Stack]] = {}
    for stack, known in _contexts(constants, instr.function, _DEEPEST):
        with constants.where(known):
            value = _default(constants, default)
            for each in constants.names(name):
                found.setdefault((each, value), []).append(stack)
    return [
        _made(each, path, instr, value, tuple(stacks)) for (each, value), stacks in found.items()
    ]


def _made(name: str, path: str, instr: Instr, value: Default, stacks: tuple[Stack, ...]) -> Read:
    kind = type(value).__name__ if value is not None else ""
    return Read(name, path, instr, value, type=_TYPES.get(kind, kind), stacks=stacks)


def _contexts(constants: Constants, function: Function, depth: int) -> list[Context]:
    """The chains of calls of ``function``, each with the values that its parameters have then."""
    calls = constants.flow.points.calls
    found: list[Context] = []
    for site in calls.callers.get(function, ()) if depth else ():
        for stack, known in _contexts(constants, site.function, depth - 1):
            with constants.where(known):
                values = {
                    param: tuple(
                        each
                        for value in calls.given.get((site, param), ())
                        for each in constants.values(value)
                    )
                    for param in function.param_instrs
                }
            found.append(((*stack, site), {key: each for key, each in values.items() if each}))
    return found if 0 < len(found) <= _MOST_CONTEXTS else [((), {})]


_TYPES = {"str": "string", "float": "double"}


def _default(constants: Constants, instr: Instr | None) -> Default:
    values = constants.values(instr) if instr is not None else ()
    if len(values) != 1 or not isinstance(values[0], (bool, int, float, str)):
        return None
    value = values[0]
    finite = not isinstance(value, float) or abs(value) < float("inf")
    return value if finite else None


def _handed(flow: Flow, callback: Instr | None, place: int) -> Iterator[Instr]:
    """The parameter of a callback that gets the argument number ``place``."""
    for each in flow.points.of(callback) if callback is not None else ():
        params = each.function.param_instrs if each.function is not None else []
        number = place + (1 if each.kind == "method" else 0)
        if number < len(params):
            yield params[number]


def _listed(
    flow: Flow, instr: Instr, path: str, given: list[Given], lists: ParameterLists
) -> list[Read]:
    """The elements of lists of parameters."""
    where_names, where_callback = flow.points.rules.lists[path]
    asked = argument(given, where_names)
    starts = [(instr, lists.named(asked))] if asked is not None else []
    starts += [(each, []) for each in _handed(flow, argument(given, where_callback), 0)]
    return [
        Read(name, path, value)
        for start, names in starts
        for name, value in lists.taken(start, names)
    ]


def find_exposing(flow: Flow, constants: Constants, rules: Rules) -> list[Exposed]:
    """All exposing statements, in the order of the program."""
    found: dict[Instr, Exposed] = {}
    for instr, paths in flow.points.calls.outside.items():
        for path, owner in paths:
            if path in rules.exposing and instr not in found:
                found[instr] = Exposed(instr, path, _topic(owner, constants, rules))
            if path in rules.services:
                for exposed in _answers(flow, instr, path, constants, rules):
                    found.setdefault(exposed.instr, exposed)
    for instr in _unresolved(flow):
        found.setdefault(instr, Exposed(instr, "rospy.Publisher.publish", None))
    return sorted(found.values(), key=lambda exposed: exposed.instr.number)


def _unresolved(flow: Flow) -> list[Instr]:
    """``x.publish(...)`` where nothing is known of ``x`` is taken for an exposing statement."""
    return [
        instr
        for instr in flow.points.program.instructions()
        if instr.op == "call"
        and instr.args[0].op == "attr"
        and instr.args[0].data == "publish"
        and not list(flow.points.of(instr.args[0].args[0]))
    ]


def _answers(
    flow: Flow, instr: Instr, path: str, constants: Constants, rules: Rules
) -> list[Exposed]:
    """What the handler of a service returns."""
    callback = argument(CallTable.arguments(instr), rules.services[path])
    topic = _topic_of(instr, path, constants, rules)
    found = []
    for each in flow.points.of(callback) if callback is not None else ():
        if each.function is not None:
            for inner in each.function.instructions():
                if inner.op == "return":
                    found.append(Exposed(inner, path, topic))
    return found


def _topic(owner: Obj | None, constants: Constants, rules: Rules) -> str | None:
    while owner is not None and owner.kind == "part":
        owner = owner.parent
    if owner is None or owner.site is None:
        return None
    for path, _ in constants.flow.points.calls.outside.get(owner.site, ()):
        topic = _topic_of(owner.site, path, constants, rules)
        if topic is not None:
            return topic
    return None


def _topic_of(instr: Instr, path: str, constants: Constants, rules: Rules) -> str | None:
    names = [each for each in (path, rules.class_of(path)) if each in rules.topics]
    name = argument(CallTable.arguments(instr), rules.topics[names[0]]) if names else None
    values = constants.names(name) if name is not None else []
    return values[0] if len(values) == 1 and DYNAMIC not in values[0] else None
