"""Is a confident verdict right, and is nobody accused where no parameter is to blame?"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pytpc.study.data import ALL, LABELS
from pytpc.study.metrics import CONFIDENT, Bin, reliability
from pytpc.study.report.positions import Position, ordered
from pytpc.study.report.ranked import OURS
from pytpc.tables import Cell, Column, Table


def judged(rows: Iterable[Position], method: str = OURS) -> list[Position]:
    """The verdicts of a method by all users' marks; without a mark they have no confidence."""
    return [row for row in rows if row.method == method and row.who == ALL]


def rightness(row: Position) -> float:
    """Whether the first is to blame, a share where it is tied; on clean runs and faults nobody."""
    return row.within(1) if row.changed else 0.0


def accuses(row: Position) -> bool:
    """Whether a verdict is confident; without marks nobody asked."""
    return row.marks > 0 and row.confidence is not None and row.confidence >= CONFIDENT


def calibration(rows: Iterable[Position], half: str) -> list[Bin]:
    """How often verdicts are right, by their confidence; those without a mark are left out.

    Of one half alone: what was fitted on the other is well calibrated there by its making.
    """
    own = (row for row in judged(rows) if row.half == half)
    found = [row for row in own if row.marks > 0 and row.confidence is not None]
    return reliability([row.confidence or 0.0 for row in found], [rightness(row) for row in found])


def calibration_error(bins: Sequence[Bin]) -> float | None:
    """The expected calibration error (Naeini et al. 2015): the mean gap, weighted by verdicts."""
    total = sum(one.verdicts for one in bins)
    gaps = (one.verdicts * abs(one.confidence - one.right) for one in bins)
    return sum(gaps) / total if total else None


def reliability_table(bins: Sequence[Bin], half: str) -> Table:
    """The numbers of the diagram."""
    columns = (Column("Verdicts", 0), Column("Mean confidence", 2), Column("Share right", 2))
    rows = tuple(
        (f"{b.low:.1f} to {b.high:.1f}", (b.verdicts, b.confidence, b.right)) for b in bins
    )
    title = f"Reliability, the {half} half"
    return Table(f"reliability-{half}", title, columns, rows, (), "Confidence")


def accusations_table(rows: Sequence[Position]) -> Table:
    """Missions in which no parameter is to blame: who is first, and how confidently."""
    own = [row for row in judged(rows) if not row.changed]
    columns = tuple(
        Column(heading, digits)
        for heading, digits in (
            ("Treatment", 0), ("Half", 0), ("Seed", 0), ("Labels", 0), ("Marks", 0), ("First", 0),
            ("Confidence", 2), ("Accused", 0),
        )
    )  # fmt: skip
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for row in sorted(own, key=lambda r: (r.system, r.type, r.treatment, r.seed)):
        accused = "yes" if accuses(row) else "no"
        cells = (row.treatment, row.half, row.seed, row.labels, row.marks, row.top or None)
        lines.append((row.system, (*cells, row.confidence, accused)))
    return Table("accusations", "Where nobody is to blame", columns, tuple(lines), (), "System")


def accusation_counts(rows: Sequence[Position], halves: Sequence[str]) -> Table:
    """How many verdicts are confident, and how many of those are right, by what was done."""
    columns = (
        Column("Half", 0),
        Column("Labels", 0),
        Column("Missions", 0),
        Column("Confident", 0),
        Column("of them right", 0),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for name, kinds in (
        ("changed parameter", {"type1", "type2"}),
        ("fault in the source", {"fault"}),
        ("clean", {"clean"}),
    ):
        for half in halves:
            own = [row for row in judged(rows) if row.type in kinds and row.half == half]
            for labels in ordered((row.labels for row in own), LABELS):
                here = [row for row in own if row.labels == labels]
                confident = [row for row in here if accuses(row)]
                right = sum(rightness(row) for row in confident)
                lines.append((name, (half, labels, len(here), len(confident), right)))
    return Table("confident", "Confident verdicts", columns, tuple(lines), (), "Missions with")


def false_accusations(rows: Sequence[Position], half: str, kind: str) -> tuple[int, int]:
    """How many verdicts on missions of a ``kind`` accuse somebody, and how many there are."""
    own = [row for row in judged(rows) if row.type == kind and row.half == half]
    return sum(map(accuses, own)), len(own)
