"""The analysis of one link unit of Python: the passes in order, and their result as a LinkUnit."""

from __future__ import annotations

import gc
import uuid
from collections.abc import Callable, Iterable
from dataclasses import astuple, dataclass, fields
from importlib.metadata import PackageNotFoundError, version
from typing import TypeVar

from pytpc.base.errors import InputError
from pytpc.python_analysis.budget import SECONDS, Budget, BudgetSpentError, what_failed
from pytpc.python_analysis.comparisons.facts import FLAG
from pytpc.python_analysis.comparisons.follow import Follower
from pytpc.python_analysis.comparisons.gather import (
    Found,
    Gatherer,
    find_constants,
    position,
    span_of,
)
from pytpc.python_analysis.comparisons.path import path_of
from pytpc.python_analysis.comparisons.reads import Exposed, Read, find_exposing, find_reads
from pytpc.python_analysis.comparisons.received_messages import Messages, type_shown
from pytpc.python_analysis.comparisons.slicing import Slice, Slicer
from pytpc.python_analysis.flow.constants import DYNAMIC, Constants
from pytpc.python_analysis.flow.raising import add_raising_calls
from pytpc.python_analysis.flow.value_flow import Flow
from pytpc.python_analysis.ir.instructions import Instr
from pytpc.python_analysis.ir.names import named_variable
from pytpc.python_analysis.ir.program import Program
from pytpc.python_analysis.points_to.points_to import PointsTo
from pytpc.python_analysis.rules_file import Rules
from pytpc.python_analysis.sources.scripts import Entry
from pytpc.static.link_unit import (
    BlindSpot,
    Comparison,
    Counts,
    Exposing,
    LinkUnit,
    NotExposed,
    ParameterRead,
    Place,
    Received,
    Tool,
)

# The passes make the keys of comparisons in the same namespace.
_NAMESPACE = uuid.UUID("6b0f7a52-2c9e-4d61-9a37-8f15c3405ed8")
_AT_MOST = 200
_Place = TypeVar("_Place")


@dataclass
class Analysed:
    """The results of all passes on a link unit."""

    program: Program
    rules: Rules
    flow: Flow
    reads: list[Read]
    exposed: list[Exposed]
    follower: Follower
    slice: Slice
    found: list[Found]
    others: list[Found]
    messages: Messages


def analyse(program: Program, rules: Rules) -> Analysed:
    """Run all passes on a program."""
    points = PointsTo(program, rules)
    leaving = add_raising_calls(points)
    flow = Flow(points)
    constants = Constants(flow)
    reads = find_reads(flow, constants, rules)
    exposed = find_exposing(flow, constants, rules)
    follower = Follower(flow, constants, rules)
    follower.run(reads)
    follower.decide()
    fixed = find_constants(follower) if rules.constants else []
    slicer = Slicer(flow, leaving, follower.outcomes.selecting)
    found_slice = slicer.run(exposed)
    gatherer = Gatherer(follower, found_slice, counts_shown=rules.profile != "thesis")
    found, others = gatherer.run()
    found += gatherer.constants(fixed, [*found, *others])
    messages = Messages.of(flow, constants, rules, slicer)
    return Analysed(
        program, rules, flow, reads, exposed, follower, found_slice, found, others, messages
    )


def analyse_entry(
    entry: Entry,
    rules: Rules,
    seconds: float = SECONDS,
    on_fault: Callable[[InputError], None] | None = None,
) -> LinkUnit:
    """The static information of a script.

    Its status is ``failed`` if the analysis takes longer than ``seconds`` (0: no limit) or ends in
    an internal error; it raises no other exception than the one below.

    Args:
        entry: which script.
        rules: what reads and what exposes.
        seconds: wall-clock time.
        on_fault: called with imported modules that cannot be read or parsed. The analysis treats
            them like modules of a library, and lists them as blind spots.

    Raises:
        InputError: the script itself cannot be read or parsed.
    """
    program = Program(entry)
    collecting = gc.isenabled()
    # Everything lives to the end, in millions of cycles; searching for garbage doubles the time.
    gc.disable()
    try:
        with Budget(seconds):
            program.load()
            unit = Writer(analyse(program, rules)).unit()
    except InputError:
        raise
    except BudgetSpentError:
        why = f"the analysis took more than {seconds:g} s (--max-seconds raises the limit)"
        return _failed(program, rules, why)
    except Exception as error:
        return _failed(program, rules, what_failed(error))
    finally:
        if collecting:
            gc.enable()
    if on_fault is not None:
        for fault in program.faults:
            on_fault(fault.error)
    return unit


def _failed(program: Program, rules: Rules, why: str) -> LinkUnit:
    nothing = {field.name: 0 for field in fields(Counts)}
    tool = Tool("tpc", _version(), "", rules.profile, "python")
    return LinkUnit(
        program.name, program.package, str(program.root), tool, "failed", why, Counts(**nothing),
        (), (), (),
    )  # fmt: skip


class Writer:
    """Writes the results as docs/reference/formats.md describes them."""

    def __init__(self, analysed: Analysed) -> None:
        self.all = analysed
        # Not `splitlines`: in Python a form feed does not end a line.
        modules = analysed.program.modules
        self._lines = {module.path: module.source.split("\n") for module in modules}

    def unit(self) -> LinkUnit:
        """The link unit, its lists in the order of the format."""
        program = self.all.program
        comparisons = self._comparisons()
        not_exposed = self._not_exposed()
        spots = self._blind_spots()
        reads = self._reads()
        return LinkUnit(
            link_unit=program.name,
            package=program.package,
            source_root=str(program.root),
            tool=Tool("tpc", _version(), "", self.all.rules.profile, "python"),
            status="ok",
            failure=None,
            counts=self._counts(comparisons, len(not_exposed), len(spots), len(reads)),
            parameters=tuple(reads),
            exposing=tuple(self._exposing()),
            comparisons=tuple(comparisons),
            not_exposed=_listed(not_exposed, lambda found: found.source),
            blind_spots=_listed(spots, _of_parameter),
        )

    def _counts(self, comparisons: list[Comparison], others: int, spots: int, reads: int) -> Counts:
        predicates = [each for each in self.all.program.instructions() if each.op == "branch"]
        places = {_where(each) for each in predicates}
        within = {_where(each) for each in self.all.slice.distance}
        dynamic = sum(1 for read in self.all.reads if DYNAMIC in read.name)
        return Counts(
            functions=len(self.all.program.functions),
            predicates=len(places | within),
            predicates_in_slice=len(within),
            parameter_reads=reads,
            exposing_statements=len({_where(each.instr) for each in self.all.exposed}),
            comparisons=sum(1 for each in comparisons if each.type != "constant"),
            constants=sum(1 for each in comparisons if each.type == "constant"),
            dynamic_names=dynamic,
            indirect_calls=len(self._unknown_calls()),
            without_debug_info=0,
            outside_sources=0,
            lost_values=len(self.all.follower.lost),
            not_instrumented=0,
            given_up=len(self.all.flow.points.given_up),
            not_exposed=others,
            blind_spots=spots,
        )

    def _unknown_calls(self) -> list[Instr]:
        points = self.all.flow.points
        return [
            each
            for each in self.all.program.instructions()
            if each.op == "call" and not list(points.of(each.args[0]))
        ]

    def _source(self, instr: Instr, number: int) -> str | None:
        lines = self._lines[instr.function.module.path]
        return lines[number - 1].strip() if 0 < number <= len(lines) else None

    def _place(self, instr: Instr) -> Place:
        return Place(instr.function.module.path, position(instr)[0])

    def _reads(self) -> list[ParameterRead]:
        found: dict[ParameterRead, None] = {}
        for read in self.all.reads:
            if not read.is_table:
                found[self._read(read, read.name, read.instr)] = None
        for facts in self.all.follower.facts.values():
            for fact in facts:
                if fact.before is not None and fact.before.name == "" and fact.name:
                    found[self._read(fact.read, fact.name, fact.at)] = None
        return sorted(found, key=lambda read: (read.file, read.lineno, read.column, read.name))

    def _read(self, read: Read, name: str, at: Instr) -> ParameterRead:
        line, column = position(at)
        return ParameterRead(
            name, read.api, read.type, read.default, at.function.module.path, line, column,
            at.function.qualname,
        )  # fmt: skip

    def _exposing(self) -> list[Exposing]:
        found: dict[Exposing, None] = {}
        for each in self.all.exposed:
            line, column = position(each.instr)
            function = each.instr.function
            file = function.module.path
            found[Exposing(each.api, each.topic, file, line, column, function.qualname)] = None
        return sorted(found, key=lambda each: (each.file, each.lineno, each.column))

    def _comparisons(self) -> list[Comparison]:
        conditions: dict[object, set[object]] = {}
        for found in self.all.found:
            place = (found.at.function.module.path, found.span)
            conditions.setdefault(self._condition(found), set()).add((place, found.parameter))
        keys: dict[tuple[str, ...], int] = {}
        comparisons = []
        for found in sorted(self.all.found, key=_order):
            others = len(conditions[self._condition(found)]) - 1
            comparisons.append(self._comparison(found, others, keys))
        return comparisons

    def _condition(self, found: Found) -> object:
        """Identifies the condition that a comparison is part of."""
        assert found.predicate is not None
        function = found.at.function
        return function.module.path, function.conditions.get(found.at.node, found.at.node)

    def _comparison(
        self, found: Found, others: int, keys: dict[tuple[str, ...], int]
    ) -> Comparison:
        program = self.all.program
        (line, column), (end_line, end_column) = found.span
        function = found.at.function
        file = function.module.path
        what = found.parameter if found.facts else f"constant {found.parameter}"
        parts = (
            program.package, program.name, file, function.qualname, str(line), str(column),
            what,
        )  # fmt: skip
        ordinal = keys.get(parts, 0)
        keys[parts] = ordinal + 1
        key = uuid.uuid5(_NAMESPACE, "\n".join([*parts, str(ordinal)] if ordinal else parts))
        assert found.predicate is not None
        exposed = self.all.slice.nearest[found.predicate]
        reads = [self._place(fact.read.instr) for fact in found.facts]
        return Comparison(
            key=str(key),
            type=found.type,
            name=named_variable(found.threshold) if found.facts else found.parameter,
            source=found.parameter if found.facts else None,
            file=file,
            lineno=line,
            column=column,
            function=function.qualname,
            distance=found.distance,
            relation=found.relation,
            topic=exposed.topic,
            source_code=self._source(found.at, line),
            other_thresholds=others,
            param_reads=tuple(dict.fromkeys(reads)),
            publishes=(self._place(exposed.instr),),
            transform=found.facts[0].how.to_json() if found.facts else None,
            default=found.facts[0].read.default if found.facts else None,
            read_at=reads[0] if reads else None,
            exposed_at=self._place(exposed.instr),
            path=path_of(found, self.all.slice, self._source) if found.facts else (),
            end_lineno=end_line,
            end_column=end_column,
            operand=found.operand_text,
            message=type_shown(self.all.flow, exposed, self.all.rules),
            received=self._received(found) if found.facts else None,
        )

    def _received(self, found: Found) -> tuple[Received, ...] | None:
        arrivals = [
            Received(
                each.subscription.topic, each.subscription.type, each.by,
                *astuple(self._place(each.subscription.instr)),
            )
            for each in self.all.messages.received(found)
        ]  # fmt: skip
        return tuple(arrivals) or None

    def _not_exposed(self) -> list[NotExposed]:
        found = []
        for each in sorted(self.all.others, key=_order):
            line, column = each.span[0]
            function = each.at.function
            found.append(
                NotExposed(
                    each.parameter, function.module.path, line, column, function.qualname,
                    self._source(each.at, line),
                )
            )  # fmt: skip
        return list(dict.fromkeys(found))

    def _blind_spots(self) -> list[BlindSpot]:
        spots = []
        for at, fact in self.all.follower.lost.items():
            what = "the value is not followed beyond this point"
            spots.append(self._spot("lost_value", fact.name or None, at, what))
        for read in self.all.reads:
            if DYNAMIC in read.name:
                what = "the parameter's name is computed at run time"
                spots.append(self._spot("dynamic_name", read.name, read.instr, what))
        for call in self._unknown_calls():
            what = "the function that is called here is unknown"
            spots.append(self._spot("indirect_call", None, call, what))
        for fault in self.all.program.faults:
            what = f"this imported module is left out: {fault.error.message}"
            line = fault.error.line or 1
            spots.append(
                BlindSpot("unread_module", None, fault.path, line, 1, "<module>", what, None)
            )
        unique = dict.fromkeys(spots)
        return sorted(unique, key=lambda each: (each.kind, each.file, each.lineno, each.column))

    def _spot(self, kind: str, parameter: str | None, at: Instr, what: str) -> BlindSpot:
        line, column = position(at)
        function = at.function
        return BlindSpot(
            kind, parameter, function.module.path, line, column, function.qualname, what,
            self._source(at, line),
        )  # fmt: skip


def _listed(found: Iterable[_Place], of: Callable[[_Place], object]) -> tuple[_Place, ...]:
    """Not too many, but one for each that ``of`` names, so that no parameter is silent."""
    kept: list[_Place] = []
    named: set[object] = set()
    for number, each in enumerate(found):
        name = of(each)
        if number < _AT_MOST or (name is not None and name not in named):
            kept.append(each)
        named.add(name)
    return tuple(kept)


def _of_parameter(spot: BlindSpot) -> object:
    return None if spot.parameter is None else (spot.kind, spot.parameter)


def _order(found: Found) -> tuple[object, ...]:
    return (
        found.at.function.module.path, found.span, found.parameter, found.operand,
    )  # fmt: skip


def _where(instr: Instr) -> tuple[object, ...]:
    return instr.function.module.path, span_of(instr, FLAG)


def _version() -> str:
    try:
        return version("pytpc")
    except PackageNotFoundError:
        return "0"
