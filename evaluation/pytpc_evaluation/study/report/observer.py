"""One observer: what a person gets who watches the robot alone, with types as people say them.

The unit is the treatment: the mean over its seeds, and over those who marked it. Intervals are
those of Clopper and Pearson (`metrics.exact_share`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from pytpc_evaluation.study.metrics import Estimate, estimate, exact_share
from pytpc_evaluation.study.report.confidence import SAID, accuses, rightness
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.positions import Position, ordered, with_absent
from pytpc_evaluation.study.report.ranked import METHODS, OURS, SAY_NONE, percent
from pytpc_evaluation.tables import Cell, Column, Table


def observer_table(rows: Sequence[Position], part: Part) -> Table:
    """The shares of each method, of missions that the observer marked; in the last column of all.

    "None first" and "wrongly accused" are of missions with a wrong parameter, "somebody accused" of
    those without one; the Brier score is of all of them.
    """
    own = [
        row
        for row in with_absent(rows)
        if row.users == 1 and row.labels == SAID and row.half == part.half
    ]
    changed = [row for row in own if row.changed and part.has(row.half, row.round)]
    columns = tuple(
        Column(heading, 0)
        for heading in (
            "Top 1 %",
            "Top 3 %",
            "None first %",
            "Wrongly accused %",
            "Somebody accused %",
            "Brier score",
            "Top 3 % of all missions",
        )
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for method in ordered((row.method for row in own), METHODS):
        found = [row for row in changed if row.method == method]
        marked = [row for row in found if row.marks]
        nobody = [row for row in own if row.method == method and not row.changed and row.marks]
        sure = method in {OURS, *SAY_NONE}
        cells = (
            percent(_share(marked, lambda row: row.within(1))),
            percent(_share(marked, lambda row: row.within(3))),
            percent(_share(marked, _is_none_first)) if sure else None,
            percent(_share(marked, _is_wrong)) if sure else None,
            percent(_share(nobody, accuses)) if sure else None,
            _brier([*marked, *nobody]) if sure else None,
            percent(_share(found, lambda row: row.within(3))),
        )
        lines.append((method, cells))
    title = f"One observer, types as people say them, the {part.title}"
    return Table(f"observer-{part.name}", title, columns, tuple(lines), (), "Method")


def _brier(rows: Iterable[Position]) -> str:
    """The mean squared error of the first suspect's probability (Brier 1950), by bootstrap."""
    own = [row for row in rows if row.confidence is not None]
    errors = [((row.confidence or 0.0) - rightness(row)) ** 2 for row in own]
    found = estimate(errors, [(row.system, row.treatment) for row in own])
    if not found.treatments:
        return "-"
    return f"{found.value:.2f} [{found.low:.2f}, {found.high:.2f}]"


def _is_none_first(row: Position) -> bool:
    return row.none is not None and row.confidence is not None and row.none > row.confidence


def _is_wrong(row: Position) -> bool:
    return accuses(row) and row.within(1) < 1.0


def _share(rows: Iterable[Position], of: Callable[[Position], float]) -> Estimate:
    own = list(rows)
    return exact_share([float(of(row)) for row in own], [(r.system, r.treatment) for r in own])
