"""The parameter reads and the exposing statements of a program."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from pytpc.python_analysis.comparisons.parameter_lists import ParameterLists
from pytpc.python_analysis.flow.constants import DYNAMIC, Constants
from pytpc.python_analysis.flow.value_flow import Flow, Stack
from pytpc.python_analysis.ir.instructions import Function, Instr
from pytpc.python_analysis.points_to.call_table import CallTable, Given, argument
from pytpc.python_analysis.points_to.objects import Obj
from pytpc.python_analysis.rules_file import Argument, ConfigRule, ReadRule, Rules
from pytpc.static.link_unit import Default

Context = tuple[Stack, dict[Instr, tuple[object, ...]]]
_MOST_CONTEXTS = 64
_DEEPEST = 3


@dataclass(eq=False, slots=True)
class Read:
    """A parameter read: ``instr`` has its value.

    ``is_table``: the value has parameters as its fields (a dynamic_reconfigure config), whose names
    begin with ``namespace`` and ``separator``. ``is_object``: the value is an attribute of it.
    ``stacks``: the calls, the innermost last, through which its function reads this name.
    """

    name: str
    api: str
    instr: Instr
    default: Default = None
    is_table: bool = False
    is_object: bool = False
    namespace: str = ""
    separator: str = "/"
    type: str = ""
    stacks: tuple[Stack, ...] = ((),)


@dataclass(eq=False, slots=True)
class Exposed:
    """An exposing statement."""

    instr: Instr
    api: str
    topic: str | None


def find_reads(flow: Flow, constants: Constants, rules: Rules) -> list[Read]:
    """All reads in the order of the program, one for each name that a call may read."""
    found: list[Read] = []
    lists = ParameterLists(constants)
    for instr, paths in flow.points.calls.outside.items():
        given = CallTable.arguments(instr)
        for path, _ in paths:
            if path in rules.reads and _is_own(flow, argument(given, rules.reads[path].node)):
                found += _read(flow, instr, path, constants)
            if path in rules.configs:
                row = rules.configs[path]
                namespace = _namespace(argument(given, row.namespace), row, constants)
                params = handed(flow, argument(given, row.callback), row.config)
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


def _is_own(flow: Flow, node: Instr | None) -> bool:
    """True where a call does not say whose parameter it reads, or names its own node."""
    if node is None:
        return True
    origins = [node] if node.op in ("const", "call") else list(flow.origins(node))
    return all(
        (each.op == "const" and each.data is None)
        or any(path.endswith(_OWN_NAMES) for path, _ in flow.points.calls.outside.get(each, ()))
        for each in origins
    )


_OWN_NAMES = (".get_name", ".get_fully_qualified_name")


def _read(flow: Flow, instr: Instr, path: str, constants: Constants) -> list[Read]:
    row = flow.points.rules.reads[path]
    given = CallTable.arguments(instr)
    found: list[Read] = []
    for name, value, stacks in _named(instr, row, given, constants):
        starts = [instr]
        if row.callback != Argument(None):
            starts = list(handed(flow, argument(given, row.callback), 0))
        kind = type(value).__name__ if value is not None else ""
        for start in starts:
            read = Read(name, path, start, value, type=_TYPES.get(kind, kind), stacks=stacks)
            read.is_object = row.is_object
            if row.separator:
                read.is_table, read.name, read.namespace = True, "", name
                read.separator = row.separator
            found.append(read)
    return found


def _named(
    instr: Instr, row: ReadRule, given: list[Given], constants: Constants
) -> Iterator[tuple[str, Default, tuple[Stack, ...]]]:
    """The names that a call reads, each with its default and the calls that lead to it."""
    name = argument(given, row.name)
    default = argument(given, row.default)
    names = [DYNAMIC] if name is None else constants.names(name)
    if name is None or (len(names) == 1 and DYNAMIC not in names[0]):
        yield from ((each, _default(constants, default), ((),)) for each in names)
        return
    # The name is an argument of the function that reads: each of its calls reads another name.
    found: dict[tuple[str, Default], list[Stack]] = {}
    for stack, known in _contexts(constants, instr.function, _DEEPEST):
        with constants.where(known):
            value = _default(constants, default)
            for each in constants.names(name):
                found.setdefault((each, value), []).append(stack)
    yield from ((each, value, tuple(stacks)) for (each, value), stacks in found.items())


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


def handed(flow: Flow, callback: Instr | None, place: int) -> Iterator[Instr]:
    """The parameter of a callback that gets the argument number ``place``."""
    for each in flow.points.of(callback) if callback is not None else ():
        params = each.function.param_instrs if each.function is not None else []
        number = place + (1 if each.kind == "method" else 0)
        if number < len(params):
            yield params[number]


def _listed(
    flow: Flow, instr: Instr, path: str, given: list[Given], lists: ParameterLists
) -> Iterator[Read]:
    """The elements of lists of parameters."""
    row = flow.points.rules.lists[path]
    asked = argument(given, row.names)
    starts: list[tuple[Instr, list[str]]] = []
    if asked is not None:
        above = lists.text(argument(given, row.namespace))
        starts = [(instr, [f"{above}.{name}" if above else name for name in lists.named(asked)])]
    starts += [(each, []) for each in handed(flow, argument(given, row.callback), 0)]
    for start, names in starts:
        for name, value in lists.taken(start, names):
            yield Read(name, path, value)
        for table in lists.tables(start):
            yield Read("", path, table, is_table=True)


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
    for exposed in overriding(flow):
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
    given = CallTable.arguments(instr)
    callbacks = [argument(given, row) for row in rules.services[path]]
    topic = topic_of(instr, path, constants, rules)
    return [
        Exposed(inner, path, topic)
        for callback in callbacks
        for each in (flow.points.of(callback) if callback is not None else ())
        if each.function is not None
        for inner in each.function.instructions()
        if inner.op == "return"
    ]


def overriding(flow: Flow) -> Iterator[Exposed]:
    """The results of methods that a class of a library calls, such as ``on_configure``."""
    points = flow.points
    for info in points.bases:
        for path in dict.fromkeys(points.outside_bases(info)):
            for name in points.rules.overriding.get(path, ()):
                for each in points.of((points.heap.class_(info), name)):
                    if each.function is not None:
                        for inner in each.function.instructions():
                            if inner.op == "return":
                                yield Exposed(inner, f"{path}.{name}", None)


def _topic(owner: Obj | None, constants: Constants, rules: Rules) -> str | None:
    while owner is not None and owner.kind == "part":
        owner = owner.parent
    if owner is None or owner.site is None:
        return None
    for path, _ in constants.flow.points.calls.outside.get(owner.site, ()):
        topic = topic_of(owner.site, path, constants, rules)
        if topic is not None:
            return topic
    return None


def topic_of(instr: Instr, path: str, constants: Constants, rules: Rules) -> str | None:
    """The topic or service that the call ``instr`` of ``path`` is given; None if not constant."""
    names = [each for each in (path, rules.class_of(path)) if each in rules.topics]
    name = argument(CallTable.arguments(instr), rules.topics[names[0]]) if names else None
    values = constants.names(name) if name is not None else []
    return values[0] if len(values) == 1 and DYNAMIC not in values[0] else None
