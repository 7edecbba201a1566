"""How large the harmless changes are beside those of the treatments, and what both turned.

The size of a change is |ln(new / old)|; where one of the values is 0, or they differ in sign, it
has none. A change turns a decision of the log where with the old value the comparison would have
come out otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean, median

import numpy as np

from pytpc.base.errors import InputError
from pytpc.diagnosis.thresholds.replay import tracks_of
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.study.report.folder import FlownMission, FlownSystem, Progress
from pytpc_evaluation.tables import Cell, Column, Table


@dataclass(frozen=True, slots=True)
class TurnedChange:
    """A change in a mission, and how many of the decisions in its log it turned."""

    system: str
    change: Change
    turned: int

    @property
    def what(self) -> tuple[str, str, str]:
        """Which change it is, in whatever mission."""
        return (self.system, self.change.node, self.change.parameter)


@dataclass(frozen=True, eq=False)
class Changed:
    """All changes of a study: harmless ones, and those of the treatments, by mission.

    ``counts`` has for each mission how many harmless ones there are.
    """

    harmless: tuple[TurnedChange, ...]
    treated: tuple[TurnedChange, ...]
    counts: tuple[int, ...]

    @property
    def in_a_mission(self) -> str:
        """How many harmless changes a mission has: ``8``, or ``7 to 8``."""
        return " to ".join(dict.fromkeys(str(of(self.counts)) for of in (min, max)))

    @property
    def factor(self) -> str:
        """By what the median harmless change multiplies or divides: ``3.1``."""
        return _factor(_median_size(_once(self.harmless)))

    @property
    def treated_factor(self) -> str:
        """The same of the treatments."""
        return _factor(_median_size(_once(self.treated)))

    @property
    def turned(self) -> str:
        """Of how many harmless changes a decision was turned, in % of all missions' changes."""
        return "-" if not self.harmless else f"{_turned_percent(self.harmless):.0f}"


def changed_in(systems: Sequence[FlownSystem], on_progress: Progress | None = None) -> Changed:
    """The changes of all missions.

    Args:
        systems: with their missions.
        on_progress: called with (missions done, missions in all).
    """
    harmless, treated, counts = [], [], []
    flights = [(flight, system.static_info) for system in systems for flight in system.flights]
    for number, (flight, static_info) in enumerate(flights, start=1):
        found = [_made(flight, change, static_info) for change in flight.changes]
        own = [made for made in found if _is_treated(made.change, flight)]
        others = [made for made in found if made not in own]
        harmless += others
        treated += own
        counts.append(len(others))
        if on_progress is not None:
            on_progress(number, len(flights))
    return Changed(tuple(harmless), tuple(treated), tuple(counts))


def turned(recording: Recording, static_info: StaticInfo, change: Change) -> int:
    """How many decisions in the log of the change's node its old value would have turned.

    What cannot be evaluated again counts as not turned.
    """
    try:
        _, tracks, _ = tracks_of(
            recording.events, recording.summaries, static_info, change.parameter
        )
    except InputError:
        return 0
    nodes, count = recording.events.nodes, 0
    for track in tracks:
        own = track.node == (nodes.index(change.node) if change.node in nodes else -1)
        count += int(np.count_nonzero(track.turned(track.threshold(change.old)) & own))
    return count


def changes_table(changed: Changed, systems: Sequence[FlownSystem]) -> Table:
    """Sizes of the harmless changes and of the treatments' by system."""
    columns = (
        Column("Harmless changes", 0),
        Column("Median size", 2, "Harmless"),
        Column("Median factor", 0, "Harmless"),
        Column("Turned decisions %", 0, "Harmless"),
        Column("Treatments", 0),
        Column("Median size", 2, "Treatments"),
        Column("Median factor", 0, "Treatments"),
        Column("Turned decisions %", 0, "Treatments"),
    )
    rows: list[tuple[str, tuple[Cell, ...]]] = []
    for name in (system.name for system in systems):
        cells: list[Cell] = []
        for made in (changed.harmless, changed.treated):
            own = [one for one in made if one.system == name]
            size = _median_size(_once(own))
            share = _turned_percent(own) if own else None
            cells += [len(_once(own)), size, _factor(size), share]
        rows.append((name, tuple(cells)))
    return Table("changes", "Sizes of changes", columns, tuple(rows), (), "System")


def _made(flight: FlownMission, change: Change, static_info: StaticInfo) -> TurnedChange:
    count = turned(flight.mission.recording, static_info, change)
    return TurnedChange(flight.system, change, count)


def _is_treated(change: Change, flight: FlownMission) -> bool:
    parameter = flight.treatment.parameter
    if parameter is None:
        return False
    return change.node == flight.treatment.node and same_parameter(parameter, change.parameter)


def _once(made: Iterable[TurnedChange]) -> list[TurnedChange]:
    """Each change once, of however many missions."""
    return list({(one.what, one.change.new): one for one in made}.values())


def _median_size(made: Iterable[TurnedChange]) -> float | None:
    sizes = [
        abs(math.log(one.change.new / one.change.old))
        for one in made
        if one.change.old * one.change.new > 0
    ]
    return median(sizes) if sizes else None


def _factor(size: float | None) -> str:
    return "-" if size is None else f"{math.exp(size):.3g}"


def _turned_percent(made: Sequence[TurnedChange]) -> float:
    return 100 * fmean(one.turned > 0 for one in made)
