"""Suggestions that were flown: is the error gone, and has a new one come?"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from pytpc.base.columns import read_table
from pytpc.base.errors import InputError
from pytpc.base.wording import show
from pytpc_evaluation.study.metrics import Estimate, share
from pytpc_evaluation.study.report.folder import FlownMission
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.positions import ordered
from pytpc_evaluation.study.report.ranked import percent, verdict_of
from pytpc_evaluation.study.suggestion_chains import (
    FIX_RUNS,
    HEADLINE,
    MOST_TRIES,
    VARIANTS,
    Chain,
    outcomes,
)
from pytpc_evaluation.tables import Cell, Column, Table

TARGET = 0.80
"""The share of treatments in which the error is to be gone."""

_MISSION = ("system", "treatment", "seed")
_COLUMNS = (*_MISSION, "parameter", "value", "gone", "new", "failure")


@dataclass(frozen=True, slots=True)
class Repair:
    """A treated mission, and the result of its suggestion.

    ``parameter`` and ``value`` are what was set, None where nothing was suggested. ``gone`` is None
    where in the treated mission no error was seen; ``fresh`` is whether an error was seen that was
    not there before, None where the mission was not flown again.
    """

    flight: FlownMission
    parameter: str | None = None
    value: float | None = None
    gone: bool | None = False
    fresh: bool | None = None
    failure: str = ""

    @property
    def said(self) -> str:
        """What came of it, in words."""
        if self.value is None:
            return "nothing was suggested"
        if self.failure:
            return "the flight failed"
        if self.fresh is None:
            return "still to be flown"
        return {None: "none was seen before", True: "gone", False: "still there"}[self.gone]


def read_repairs(path: Path, flights: Iterable[FlownMission]) -> list[Repair]:
    """What came of the suggestions for all ``flights`` with a changed parameter, in their order.

    Where nothing was suggested, or the flight failed, the error is not gone.

    Raises:
        InputError: the file cannot be read, or a column is missing.
    """

    def by_mission(table: pa.Table) -> dict[tuple[Any, ...], dict[str, Any]]:
        missing = [name for name in _COLUMNS if name not in table.column_names]
        if missing:
            raise InputError(f"no column {missing[0]}")
        rows = table.select(list(_COLUMNS)).to_pylist()
        return {tuple(row[name] for name in _MISSION): row for row in rows}

    found = read_table(path, "suggestions", by_mission)
    treated = [flight for flight in flights if flight.treatment.parameter is not None]
    return [_repair(one, found.get((one.system, one.treatment.name, one.seed))) for one in treated]


def gone(rows: Iterable[Repair], part: Part, *, clean: bool = False) -> Estimate:
    """The share of treatments of a part in which the error is gone; ``clean``: and no new one."""
    return _gone(_of(rows, part), clean=clean)


def repairs_summary(rows: Sequence[Repair], parts: Sequence[Part]) -> Table:
    """Shares by part and type of treatment, and where the first error is not the treatment's."""
    columns = (
        Column("Part", 0),
        Column("Treatments", 0),
        Column("Error gone %", 0),
        Column("New error %", 0),
        Column("Target", 0),
        Column("Verdict", 0),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    kinds: dict[str, Callable[[FlownMission], bool]] = {
        "all": lambda _: True,
        "type I": lambda flight: flight.treatment.type == "type1",
        "type II": lambda flight: flight.treatment.type == "type2",
        "first error of another type": lambda flight: flight.strayed,
    }
    for part in parts:
        for name, is_of in kinds.items():
            own = [row for row in _of(rows, part) if is_of(row.flight)]
            went = _gone(own)
            if not went.treatments:
                continue
            flown = [row for row in own if row.fresh is not None]
            fresh = share([float(row.fresh or 0) for row in flown], _units(flown))
            cells = (part.name, went.treatments, percent(went), percent(fresh))
            lines.append((name, (*cells, f">= {100 * TARGET:.0f}", verdict_of(went, TARGET))))
    return Table("repairs", "Suggestions, flown", columns, tuple(lines), (), "Treatments of")


def chains_in(chains: Iterable[Chain], part: Part, flights: Iterable[FlownMission]) -> list[Chain]:
    """The chains of a part; ``flights`` say of what round a treatment is."""
    rounds = {(one.system, one.treatment.name): one.treatment.round for one in flights}
    return [
        chain
        for chain in chains
        if part.has(chain.half, rounds.get((chain.system, chain.treatment), 1))
    ]


def first_try(chains: Sequence[Chain], variant: str, *, clean: bool = False) -> Estimate:
    """The share of treatments in which the first try of a variant took the error away.

    ``clean``: and brought no new one.
    """
    found, _ = outcomes(chains, variant, 1)
    well = [one.gone and not (clean and one.new_error) for one in found]
    return share(np.array(well, np.float64), [one.unit for one in found])


def tries_table(
    chains: Sequence[Chain], parts: Sequence[Part], flights: Sequence[FlownMission]
) -> Table:
    """What came of each variant within so many tries, by part; chains that wait are left out.

    Args:
        chains: of any variants; those of ``pytpc fix`` have a table of their own.
        parts: those that are shown.
        flights: see ``chains_in``.
    """
    columns = (
        Column("Part", 0),
        Column("Tries", 0),
        Column("Treatments", 0),
        Column("Error gone %", 0),
        Column("New error %", 0),
        Column("Gone, and no new one %", 0),
        Column("Missions waiting", 0),
        Column("Target", 0),
        Column("Verdict", 0),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for part in parts:
        own = chains_in(chains, part, flights)
        others = (chain.variant for chain in own if chain.variant not in FIX_RUNS)
        for variant in ordered(others, list(VARIANTS)):
            for most in range(1, MOST_TRIES.get(variant, 1) + 1):
                found, waiting = outcomes(own, variant, most)
                if not found and not waiting:
                    continue
                units = [one.unit for one in found]
                went = share([float(one.gone) for one in found], units)
                fresh = share([float(one.new_error) for one in found], units)
                whole = share([float(one.gone and not one.new_error) for one in found], units)
                name = f"{variant} (headline)" if (variant, most) == (HEADLINE, 1) else variant
                cells: tuple[Cell, ...] = (
                    part.name,
                    most,
                    went.treatments,
                    *map(percent, (went, fresh, whole)),
                    waiting,
                    f">= {100 * TARGET:.0f}",
                    verdict_of(went, TARGET),
                )
                lines.append((name, cells))
    return Table("tries", "Suggestions by variant", columns, tuple(lines), (), "Variant")


def repairs_table(rows: Sequence[Repair]) -> Table:
    """Every treated mission and the result of its suggestion."""
    headings = (
        *("Treatment", "Half", "Seed", "Changed", "Old", "Tipping", "New"),
        *("Suggested for", "Suggested", "Error", "New error"),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for row in rows:
        treated = row.flight.treatment
        cells: tuple[Cell, ...] = (
            treated.name,
            row.flight.half,
            row.flight.seed,
            treated.parameter,
            show(treated.old),
            None if treated.tipping is None else show(treated.tipping),
            show(treated.new),
            row.parameter,
            None if row.value is None else show(row.value),
            row.said,
            None if row.fresh is None else "yes" if row.fresh else "no",
        )
        lines.append((row.flight.system, cells))
    columns = tuple(Column(heading, 0) for heading in headings)
    return Table("repairs-all", "Missions flown again", columns, tuple(lines), (), "System")


def _of(rows: Iterable[Repair], part: Part) -> list[Repair]:
    return [row for row in rows if part.has(row.flight.half, row.flight.treatment.round)]


def _gone(rows: Iterable[Repair], *, clean: bool = False) -> Estimate:
    """Where no error was seen before there is nothing that could go."""
    judged = [row for row in rows if row.gone is not None]
    well = [bool(row.gone) and not (clean and row.fresh) for row in judged]
    return share(np.array(well, np.float64), _units(judged))


def _units(rows: Iterable[Repair]) -> list[tuple[str, str]]:
    return [(row.flight.system, row.flight.treatment.name) for row in rows]


def _repair(flight: FlownMission, row: dict[str, Any] | None) -> Repair:
    if row is None:
        return Repair(flight)
    failure = str(row["failure"] or "")
    # Of a suggestion that was not flown nothing is known: it has not helped.
    gone = False if failure or row["new"] is None else row["gone"]
    return Repair(flight, row["parameter"], row["value"], gone, row["new"], failure)
