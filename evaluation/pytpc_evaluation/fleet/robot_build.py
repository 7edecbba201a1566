"""The static information of the made-up robot, as ``pytpc build`` would write it."""

from __future__ import annotations

import uuid
from dataclasses import dataclass
from typing import Literal

from pytpc.static.link_unit import (
    Comparison,
    Counts,
    Exposing,
    LinkUnit,
    ParameterRead,
    Place,
    Tool,
    Transform,
)
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.fleet.robot_model import (
    DECISIONS,
    LOOPS,
    PACKAGE,
    SOURCES,
    Compared,
    Decision,
    Kind,
    Loop,
    comparisons_of,
)

# That of all keys (passes/support/Names.cpp).
_NAMESPACE = uuid.UUID("6b0f7a52-2c9e-4d61-9a37-8f15c3405ed8")
_COLUMN = 7
_FIRST_READ, _FIRST_COMPARISON, _FIRST_EXPOSED, _STEP = 20, 120, 800, 6
_MOVED = 9


@dataclass(frozen=True)
class Site:
    """A comparison of a build: what it compares, and its key."""

    compared: Compared
    key: str

    @property
    def decision(self) -> Decision:
        """What is decided."""
        return DECISIONS[self.compared.decision]


@dataclass(frozen=True)
class Build:
    """A build of the robot.

    In the ``older`` one every line stands elsewhere, so it has other keys, and the last comparison
    of each loop is not there yet.
    """

    older: bool = False

    def sites(self, loop: int) -> tuple[Site, ...]:
        """The comparisons of a loop, in the order in which it evaluates them."""
        found = comparisons_of(loop)
        kept = found[:-1] if self.older and len(found) > 1 else found
        return tuple(Site(one, self._key(one)) for one in kept)

    def reads(self, node: str) -> tuple[tuple[int, str], ...]:
        """The parameters that a node reads, each once: a decision, and the key of the read."""
        return tuple((number, self._read_key(number)) for number in _read_in(node))

    def static_info(self) -> StaticInfo:
        """All link units: a node is one."""
        return StaticInfo.of(self._unit(node) for node in dict.fromkeys(o.node for o in LOOPS))

    def _unit(self, node: str) -> LinkUnit:
        loops = [(number, loop) for number, loop in enumerate(LOOPS) if loop.node == node]
        comparisons = [
            self._comparison(site, loop) for number, loop in loops for site in self.sites(number)
        ]
        reads = [self._read(number) for number in _read_in(node)]
        exposing = [
            Exposing(
                "ros::Publisher::publish", loop.topic, loop.file, self._exposed(loop), 5,
                f"{loop.function}()",
            )
            for _, loop in loops
        ]  # fmt: skip
        return LinkUnit(
            link_unit=node,
            package=PACKAGE,
            source_root=SOURCES,
            tool=Tool("tpc", "0.2.0", "19.1.7", "default"),
            status="ok",
            failure=None,
            counts=Counts(
                functions=40,
                predicates=3 * len(comparisons),
                predicates_in_slice=2 * len(comparisons),
                parameter_reads=len(reads),
                exposing_statements=len(exposing),
                comparisons=len(comparisons),
                dynamic_names=0,
                indirect_calls=0,
                without_debug_info=0,
                outside_sources=0,
                lost_values=0,
                not_instrumented=0,
            ),
            parameters=tuple(reads),
            exposing=tuple(exposing),
            comparisons=tuple(sorted(comparisons, key=lambda one: (one.file, one.lineno))),
        )

    def _line(self, line: int) -> int:
        return line + _MOVED if self.older else line

    def _exposed(self, loop: Loop) -> int:
        return self._line(_FIRST_EXPOSED + LOOPS.index(loop))

    def _read(self, number: int) -> ParameterRead:
        one = DECISIONS[number]
        loop = LOOPS[one.loop]
        return ParameterRead(
            name=one.source,
            api="ros::NodeHandle::param",
            type="bool" if one.kind is Kind.FLAG else "double",
            default=None,
            file=loop.file,
            lineno=self._line(_FIRST_READ + number),
            column=_COLUMN,
            function=f"{_class_of(loop)}::{_class_of(loop)}()",
            key=self._read_key(number),
        )

    def _comparison(self, site: Site, loop: Loop) -> Comparison:
        one = site.decision
        read = Place(loop.file, self._line(_FIRST_READ + _read_of(site.compared.decision)))
        exposed = Place(loop.file, self._exposed(loop))
        return Comparison(
            key=site.key,
            type=_type_of(one),
            name=_variable(one),
            source=one.source,
            file=loop.file,
            lineno=self._line(_line_of(site.compared)),
            column=_COLUMN,
            function=f"{loop.function}()",
            distance=1 + site.compared.place,
            relation=one.relation,
            topic=loop.topic,
            source_code=_code(one, site.compared.place),
            other_thresholds=0,
            param_reads=(read,),
            publishes=(exposed,),
            transform=None
            if one.scale == 1.0
            else Transform("affine", one.scale, 0.0, "x * pi / 180"),
            default=None,
            read_at=read,
            exposed_at=exposed,
            loop_depth=0,
            message=loop.message,
        )

    def _key(self, compared: Compared) -> str:
        loop = LOOPS[DECISIONS[compared.decision].loop]
        return _uuid(self._name(compared.decision, loop.function, _line_of(compared)))

    def _read_key(self, number: int) -> str:
        name = _class_of(LOOPS[DECISIONS[number].loop])
        return _uuid(f"read\n{self._name(number, f'{name}::{name}', _FIRST_READ + number)}")

    def _name(self, number: int, function: str, line: int) -> str:
        """What a key is made of (passes/results/Keys.cpp)."""
        one = DECISIONS[number]
        loop = LOOPS[one.loop]
        place = str(self._line(line)), str(_COLUMN)
        return "\n".join((PACKAGE, loop.node, loop.file, function, *place, one.source))


def _uuid(name: str) -> str:
    return str(uuid.uuid5(_NAMESPACE, name))


def _read_in(node: str) -> tuple[int, ...]:
    """The decisions at which a node reads its parameters, each parameter once."""
    first: dict[str, int] = {}
    for number, one in enumerate(DECISIONS):
        if LOOPS[one.loop].node == node:
            first.setdefault(one.source, number)
    return tuple(first.values())


def _read_of(number: int) -> int:
    one = DECISIONS[number]
    node = LOOPS[one.loop].node
    return next(n for n in _read_in(node) if DECISIONS[n].source == one.source)


def _class_of(loop: Loop) -> str:
    return loop.function.partition("::")[0]


def _line_of(compared: Compared) -> int:
    return _FIRST_COMPARISON + _STEP * (2 * compared.decision + compared.place)


def _type_of(one: Decision) -> Literal["parameter", "flag", "derived"]:
    if one.kind is Kind.FLAG:
        return "flag"
    return "parameter" if one.scale == 1.0 else "derived"


def _variable(one: Decision) -> str:
    return f"{one.parameter.rpartition('/')[2]}_"


def _code(one: Decision, place: int) -> str:
    if one.kind is Kind.FLAG:
        return f"if ({_variable(one)}) {{"
    value = f"smooth_{one.value}" if place else one.value
    threshold = _variable(one) if one.scale == 1.0 else f"radians({_variable(one)})"
    return f"if ({value} {one.relation} {threshold}) {{"
