"""What the study was made of: the table of the systems, and that of the treatments."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from pytpc.base.wording import show
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.stats.runtime import runtime_statistics
from pytpc_evaluation.study.report.folder import FlownMission, FlownSystem
from pytpc_evaluation.tables import Cell, Column, Table
from pytpc_evaluation.treatment import Treatment

NEAR = 0.5
"""A treatment is near the tipping point if it goes less than this part of the way again."""

_KINDS = ("type1", "type2", "fault", "clean")


def systems_table(systems: Sequence[FlownSystem]) -> Table:
    """How large the systems are."""
    columns = (
        Column("Nodes that report", 0),
        Column("Lines of code", 0),
        Column("TPCs", 0),
        Column("Parameters", 0),
        Column("Compared when clean", 0),
        Column("C++", 0),
        Column("Python", 0),
        Column("Treatments", 0),
        Column("Missions", 0),
    )
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    for system in systems:
        recordings = [mission.recording for mission in system.clean]
        found = runtime_statistics(recordings, system.static_info)
        nodes = {
            node for flight in system.flights for node in flight.mission.recording.events.nodes
        }
        languages = [system.language(name) for name in system.parameters]
        rows.append(
            (
                system.name,
                (
                    len(nodes),
                    system.lines,
                    locations(system.static_info),
                    len(system.parameters),
                    len(found.rows) if recordings else None,
                    sum(language in {"C++", "both"} for language in languages),
                    sum(language in {"Python", "both"} for language in languages),
                    len({flight.treatment.name for flight in system.flights}),
                    len(system.flights),
                ),
            )
        )
    return Table("systems", "The systems", columns, tuple(rows), (), first="System")


def treatments_table(systems: Sequence[FlownSystem]) -> Table:
    """What was done to the systems, and what comes of it."""
    columns = tuple(
        Column(heading, 0)
        for heading in (
            "Treatment", "Type", "Half", "Round", "Parameter", "Node", "Language", "Old", "New",
            "Tipping", "Near or far", "What happens",
        )
    )  # fmt: skip
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    for system in systems:
        halves: dict[str, set[str]] = {}
        for flight in system.flights:
            halves.setdefault(flight.treatment.name, set()).add(flight.half)
        for flight in one_of_each(system.flights):
            treated = flight.treatment
            cells: tuple[Cell, ...] = (
                treated.name,
                treated.type,
                " and ".join(sorted(halves[treated.name])),
                treated.round,
                treated.parameter,
                treated.node,
                language_of(system, treated),
                _number(treated.old),
                _number(treated.new),
                _number(treated.tipping),
                nearness(treated),
                treated.effect,
            )
            rows.append((system.name, cells))
    return Table("treatments", "The treatments", columns, tuple(rows), (), first="System")


def rounds_of(systems: Sequence[FlownSystem]) -> dict[str, int]:
    """How many treatments changed a parameter: by half and round, ``tuning-1``, ``held-back-2``."""
    found = Counter(
        f"{flight.half}-{flight.treatment.round}"
        for system in systems
        for flight in one_of_each(system.flights)
        if flight.treatment.parameter is not None
    )
    return dict(sorted(found.items()))


def one_of_each(flights: Sequence[FlownMission]) -> list[FlownMission]:
    """The first mission of each treatment: type I, type II, faults, clean, each by name."""
    found = {
        (_KINDS.index(flight.treatment.type), flight.treatment.name): flight
        for flight in reversed(flights)
    }
    return [found[place] for place in sorted(found)]


def nearness(treatment: Treatment) -> str | None:
    """``near`` or ``far``; None where the tipping value is not known.

    How far the new value is beyond the tipping value, against the way from the old value to it.
    """
    old, new, tipping = treatment.old, treatment.new, treatment.tipping
    if old is None or new is None or tipping is None:
        return None
    beyond, way = abs(new - tipping), abs(tipping - old)
    return "near" if beyond < NEAR * way else "far"


def language_of(system: FlownSystem, treatment: Treatment) -> str:
    """The language of what a treatment changed; a dash where it changed no parameter."""
    return "-" if treatment.parameter is None else system.language(treatment.parameter)


def locations(static_info: StaticInfo) -> int:
    """Places in the source at which a parameter is compared."""
    return runtime_statistics([], static_info).locations


def _number(value: float | None) -> str | None:
    return None if value is None else show(value)
