"""What became of every parameter that is read: compared, lost on the way, or never compared.

``coverage`` sorts the parameters of the static information into these states; ``pytpc coverage``
prints them. The analysis follows a value to all its uses, so each parameter has one of them.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
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
    is compared elsewhere.
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
    """What a link unit says about one parameter."""

    reads: list[str] = field(default_factory=list)
    comparisons: list[Comparison] = field(default_factory=list)
    hidden: list[NotExposed] = field(default_factory=list)
    spots: list[BlindSpot] = field(default_factory=list)

    def state(self) -> State:
        kinds = {spot.kind for spot in self.spots}
        if self.comparisons:
            return "compared"
        if self.hidden:
            return "hidden"
        if kinds - _NO_LOSS:
            return "lost"
        return "unread" if _UNREAD in kinds else "used"


def coverage(static: StaticInfo) -> tuple[Covered, ...]:
    """Every parameter of every link unit that reads it, in the order of the units and names."""
    return tuple(found for unit in static.units for found in _of(unit))


def totals(covered: Iterable[Covered]) -> dict[State, int]:
    """How many parameters have each state."""
    counted = Counter(found.state for found in covered)
    return {state: counted[state] for state in STATES}


def _of(unit: LinkUnit) -> Iterable[Covered]:
    names: defaultdict[str, _Known] = defaultdict(_Known)
    for read in unit.parameters:
        names[read.name].reads.append(where(read))
    tables = list(names)
    for found in unit.comparisons:
        if found.type != "constant":
            names[found.source or ""].comparisons.append(found)
    for hidden in unit.not_exposed:
        names[hidden.source].hidden.append(hidden)
    for spot in unit.blind_spots:
        if spot.parameter is not None:
            names[spot.parameter].spots.append(spot)
    # In Python, an entry of a table is a parameter of its own, read with the table.
    for name, known in names.items():
        if not known.reads:
            known.reads += [
                read
                for table in tables
                if name.startswith(f"{table.rstrip('/')}/") or table in ("", "~", "/")
                for read in names[table].reads
            ]
    for name in sorted(names):
        known = names[name]
        lost = {Lost(where(s), s.what): None for s in known.spots if s.kind not in _NO_LOSS}
        unread = {Lost(where(s), s.what): None for s in known.spots if s.kind == _UNREAD}
        yield Covered(
            unit.package,
            unit.link_unit,
            name,
            known.state(),
            tuple(dict.fromkeys(known.reads)),
            tuple(dict.fromkeys(map(where, known.comparisons))),
            tuple(dict.fromkeys(map(where, known.hidden))),
            tuple(lost),
            tuple(unread),
        )
