"""What became of every parameter that is read: compared, lost on the way, or never compared.

``coverage`` sorts the parameters of the static information into these states; ``pytpc coverage``
prints them. The analysis follows a value to all its uses, so each parameter has one of them. What
another link unit of the same process does with a value counts for the unit that reads it.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Literal

from pytpc.static.explanations import where
from pytpc.static.link_unit import BlindSpot, Comparison, LinkUnit, NotExposed
from pytpc.static.static_info import StaticInfo

State = Literal["compared", "hidden", "lost", "unread", "used"]
STATES: dict[State, str] = {
    "compared": "compared",
    "hidden": "compared, but nothing exposed depends on it",
    "lost": "lost on the way",
    "unread": "stored or passed on, and not read in its link unit",
    "used": "used, and never compared",
}
"""The states, the first that fits first, and their names for people."""

_UNREAD = "unread"
# These say where a name or an outcome is unknown, not where a value is lost.
_NO_LOSS = frozenset({"dynamic_name", "lost_outcome", _UNREAD})


@dataclass(frozen=True, slots=True)
class Lost:
    """A place behind which the value of a parameter is not followed, and why."""

    place: str
    why: str


@dataclass(frozen=True, slots=True)
class Covered:
    """One parameter of a link unit.

    ``comparisons`` are the places in the source that report, ``hidden`` those on which nothing
    exposed depends. ``lost`` and ``unread`` are all places of their kind, also of a parameter that
    is compared elsewhere. A place in another link unit of the process has its name behind it:
    ``src/limit.cpp:7 in nav/limits``.
    """

    package: str
    link_unit: str
    parameter: str
    state: State
    reads: tuple[str, ...]
    comparisons: tuple[str, ...]
    hidden: tuple[str, ...]
    lost: tuple[Lost, ...]
    unread: tuple[Lost, ...]


@dataclass(slots=True)
class _Known:
    """What link units say about one parameter, each thing with the unit that says it."""

    reads: list[str] = field(default_factory=list)
    comparisons: list[tuple[LinkUnit, Comparison]] = field(default_factory=list)
    hidden: list[tuple[LinkUnit, NotExposed]] = field(default_factory=list)
    spots: list[tuple[LinkUnit, BlindSpot]] = field(default_factory=list)

    def state(self) -> State:
        kinds = {spot.kind for _, spot in self.spots}
        if self.comparisons:
            return "compared"
        if self.hidden:
            return "hidden"
        if kinds - _NO_LOSS:
            return "lost"
        return "unread" if _UNREAD in kinds else "used"


def coverage(static: StaticInfo) -> tuple[Covered, ...]:
    """Every parameter of every link unit that reads it, in the order of the units and names."""
    known = [_of(unit) for unit in static.units]
    _hand_to_readers(static.units, known)
    pairs = zip(static.units, known, strict=True)
    return tuple(found for unit, names in pairs for found in _covered(unit, names))


def totals(covered: Iterable[Covered]) -> dict[State, int]:
    """How many parameters have each state."""
    counted = Counter(found.state for found in covered)
    return {state: counted[state] for state in STATES}


_Names = dict[str, _Known]


def _of(unit: LinkUnit) -> _Names:
    """What a link unit says of each parameter."""
    names: defaultdict[str, _Known] = defaultdict(_Known)
    for read in unit.parameters:
        names[read.name].reads.append(where(read))
    tables = list(names)
    for found in unit.comparisons:
        if found.type != "constant":
            names[found.source or ""].comparisons.append((unit, found))
    for hidden in unit.not_exposed:
        names[hidden.source].hidden.append((unit, hidden))
    for spot in unit.blind_spots:
        if spot.parameter is not None:
            names[spot.parameter].spots.append((unit, spot))
    # In Python, an entry of a table is a parameter of its own, read with the table.
    for name, known in names.items():
        if not known.reads:
            known.reads += [
                read
                for table in tables
                if name.startswith(f"{table.rstrip('/')}/") or table in ("", "~", "/")
                for read in names[table].reads
            ]
    return dict(names)


def _hand_to_readers(units: Iterable[LinkUnit], known: Iterable[_Names]) -> None:
    """Give what a unit says of a parameter to the units of its processes that read it.

    A unit that does not read it itself then says nothing of it.
    """
    pairs = list(zip(units, known, strict=True))
    readers: defaultdict[str, list[tuple[LinkUnit, _Known]]] = defaultdict(list)
    for unit, names in pairs:
        for name in {read.name for read in unit.parameters}:
            readers[name].append((unit, names[name]))
    for unit, names in pairs:
        if not unit.processes:
            continue
        read_here = {read.name for read in unit.parameters}
        for name, said in list(names.items()):
            others = [
                (reader, of)
                for reader, of in readers[name]
                if reader is not unit and _share(reader.processes, unit.processes)
            ]
            compared = [found for found in said.comparisons if found[0] is unit]
            for found in compared:
                its = [of for reader, of in others if _reads(reader, *found)]
                if not its and name not in read_here:
                    its = [of for _, of in others]
                for of in its:
                    of.comparisons.append(found)
            if others and name not in read_here:
                for _, of in others:
                    of.hidden += said.hidden
                    of.spots += said.spots
                del names[name]


def _share(some: tuple[str, ...] | None, others: tuple[str, ...] | None) -> bool:
    return not set(some or ()).isdisjoint(others or ())


def _reads(reader: LinkUnit, unit: LinkUnit, found: Comparison) -> bool:
    """Whether a comparison of ``unit`` is with a value that ``reader`` reads, in one process."""
    places = {(unit.absolute(at.file), at.lineno) for at in found.param_reads}
    return _share(reader.processes, found.processes) and any(
        read.name == found.source and (reader.absolute(read.file), read.lineno) in places
        for read in reader.parameters
    )


def _covered(unit: LinkUnit, names: _Names) -> Iterator[Covered]:
    def place(of: LinkUnit, found: Comparison | NotExposed | BlindSpot) -> str:
        return where(found) if of is unit else f"{where(found)} in {of.package}/{of.link_unit}"

    def lost(known: _Known, is_wanted: Callable[[str], bool]) -> tuple[Lost, ...]:
        found = (Lost(place(of, s), s.what) for of, s in known.spots if is_wanted(s.kind))
        return tuple(dict.fromkeys(found))

    for name in sorted(names):
        known = names[name]
        yield Covered(
            unit.package,
            unit.link_unit,
            name,
            known.state(),
            tuple(dict.fromkeys(known.reads)),
            _once(place(*each) for each in known.comparisons),
            _once(place(*each) for each in known.hidden),
            lost(known, lambda kind: kind not in _NO_LOSS),
            lost(known, lambda kind: kind == _UNREAD),
        )


def _once(places: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(places))
