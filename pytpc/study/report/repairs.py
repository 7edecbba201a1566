"""Suggestions that were flown: is the error gone, and has a new one come?"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from statistics import fmean
from typing import Any

import pyarrow as pa

from pytpc.columns import read_table
from pytpc.errors import InputError
from pytpc.study.report.folder import HALVES
from pytpc.study.report.measures import Interval, interval
from pytpc.tables import Cell, Column, Table
from pytpc.words import show

REPAIRS_FILE = "results/suggestions.parquet"
TARGET = 0.80
"""The share of treatments in which the error is to be gone (the issue's target)."""


@dataclass(frozen=True, slots=True)
class Repair:
    """A mission flown again with a suggested value of the changed parameter.

    ``suggested`` is None where nothing was suggested; then the error is not ``gone``. ``fresh``
    says whether the observer saw an error that the mission before had not.
    """

    system: str
    treatment: str
    type: str
    half: str
    seed: int
    parameter: str
    old: float
    new: float
    suggested: float | None
    gone: bool
    fresh: bool


def read_repairs(path: Path) -> list[Repair]:
    """Read the table, sorted.

    Raises:
        InputError: the file cannot be read, or a column is missing.
    """
    names = [field.name for field in fields(Repair)]

    def rows(table: pa.Table) -> list[Repair]:
        missing = [name for name in names if name not in table.column_names]
        if missing:
            raise InputError(f"no column {missing[0]}")
        found = [_repair(row) for row in table.select(names).to_pylist()]
        return sorted(found, key=lambda r: (r.system, r.type, r.treatment, r.seed))

    return read_table(path, "suggestions", rows)


def gone(rows: Iterable[Repair], half: str) -> Interval:
    """The share of treatments of a half in which the error is gone."""
    return _share((row for row in rows if row.half == half), "gone")


def repairs_summary(rows: Sequence[Repair]) -> Table:
    """Shares by half and type of treatment."""
    columns = (
        Column("Half", 0),
        Column("Treatments", 0),
        Column("Error gone %", 0),
        Column("New error %", 0),
        Column("Target", 0),
        Column("Verdict", 0),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for half in HALVES:
        for name, kinds in (("all", {"type1", "type2"}), ("type I", {"type1"}),
                            ("type II", {"type2"})):  # fmt: skip
            own = [row for row in rows if row.half == half and row.type in kinds]
            if own:
                share = _share(own, "gone")
                hit = share.value is not None and share.value >= TARGET
                cells = (half, share.n, share.shown(), _share(own, "fresh").shown())
                lines.append((name, (*cells, f">= {100 * TARGET:.0f}", "hit" if hit else "miss")))
    return Table("repairs", "Suggestions, flown", columns, tuple(lines), (), "Treatments of")


def repairs_table(rows: Sequence[Repair], tipping: Mapping[tuple[str, str], float | None]) -> Table:
    """Every mission that was flown again.

    Args:
        rows: in order.
        tipping: (system, treatment) -> the value at which the behaviour tips.
    """
    columns = tuple(
        Column(heading, 0)
        for heading in (
            "Treatment", "Half", "Seed", "Parameter", "Old", "Tipping", "New", "Suggested",
            "Error", "New error",
        )
    )  # fmt: skip
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for row in rows:
        tips = tipping.get((row.system, row.treatment))
        cells: tuple[Cell, ...] = (
            row.treatment,
            row.half,
            row.seed,
            row.parameter,
            show(row.old),
            None if tips is None else show(tips),
            show(row.new),
            "nothing" if row.suggested is None else show(row.suggested),
            "gone" if row.gone else "still there",
            "yes" if row.fresh else "no",
        )
        lines.append((row.system, cells))
    return Table("repairs-all", "Missions flown again", columns, tuple(lines), (), "System")


def _share(rows: Iterable[Repair], what: str) -> Interval:
    groups: dict[tuple[str, str], list[float]] = defaultdict(list)
    for row in rows:
        groups[row.system, row.treatment].append(float(getattr(row, what)))
    return interval([fmean(groups[place]) for place in sorted(groups)])


def _repair(row: dict[str, Any]) -> Repair:
    suggested = row["suggested"]
    nothing = suggested is None or math.isnan(suggested)
    return Repair(**{**row, "suggested": None if nothing else float(suggested)})
