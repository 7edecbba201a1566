"""Is a confident verdict right, and is nobody accused where no parameter is to blame?

How well confidence is calibrated is told of the marks as people set them, the ``SAID`` ones: by
typed and untyped marks the same missions have nearly the same verdicts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import product

from pytpc.base.wording import many
from pytpc_evaluation.study.data import ALL, LABELS
from pytpc_evaluation.study.metrics import (
    CONFIDENT,
    SPARSE,
    Bin,
    Estimate,
    calibration_error,
    reliability,
    upper_limit,
)
from pytpc_evaluation.study.report.positions import Position, ordered
from pytpc_evaluation.study.report.ranked import BESIDE_CLEAN, OURS
from pytpc_evaluation.tables import Cell, Column, Table

SURE_METHODS = (OURS, BESIDE_CLEAN)
"""Those whose confidence is looked at."""
SAID = "confused"


@dataclass(frozen=True, slots=True)
class Calibration:
    """How often verdicts are right by their confidence, and by how much it is off."""

    bins: tuple[Bin, ...]
    error: Estimate

    @property
    def drawn(self) -> list[Bin]:
        """The bins that are worth a bar."""
        return [one for one in self.bins if not one.is_sparse]

    @property
    def said(self) -> str:
        """The error in words."""
        error = self.error
        return f"calibration error {error.value:.2f} [{error.low:.2f}, {error.high:.2f}]"


@dataclass(frozen=True, slots=True)
class Accusations:
    """How many missions somebody is accused in, of those that have marks, of how many in all."""

    accused: int
    marked: int
    missions: int

    @property
    def said(self) -> str:
        """In words, with the share that cannot be ruled out."""
        limit = 100 * upper_limit(self.accused, self.marked)
        return (
            f"{self.accused} of {many(self.marked, 'mission')} with marks (of {self.missions});"
            f" up to {limit:.0f} % cannot be ruled out"
        )


def judged(rows: Iterable[Position], method: str) -> list[Position]:
    """The verdicts of a method by all users' marks; without a mark they have no confidence."""
    return [row for row in rows if row.method == method and row.who == ALL]


def rightness(row: Position) -> float:
    """Whether the first is to blame, a share where it is tied; 0 on clean missions and faults."""
    return row.within(1) if row.changed else 0.0


def accuses(row: Position) -> bool:
    """Whether a verdict is confident; without marks nobody asked."""
    return row.marks > 0 and row.confidence is not None and row.confidence >= CONFIDENT


def calibration(rows: Iterable[Position], half: str, method: str) -> Calibration:
    """How often verdicts from ``SAID`` marks are right; missions without a mark are left out.

    Of one half alone: what was fitted on the other is well calibrated there by its making.
    """
    own = (row for row in judged(rows, method) if row.half == half and row.labels == SAID)
    found = [row for row in own if row.marks > 0 and row.confidence is not None]
    confidence = [row.confidence or 0.0 for row in found]
    right = [rightness(row) for row in found]
    units = [(row.system, row.treatment) for row in found]
    return Calibration(
        tuple(reliability(confidence, right, units)), calibration_error(confidence, right, units)
    )


def reliability_table(found: Calibration, half: str, method: str) -> Table:
    """The numbers of the diagram, and of the bins that are too sparse for it."""
    columns = (
        Column("Verdicts", 0),
        Column("Treatments", 0),
        Column("Mean confidence", 2),
        Column("Share right", 2),
    )
    rows = tuple(
        (f"{b.low:.1f} to {b.high:.1f}", (b.verdicts, b.treatments, b.confidence, b.right))
        for b in found.bins
    )
    notes: tuple[str, ...] = ()
    if found.bins:
        sparse = any(one.is_sparse for one in found.bins)
        left = f" Bins of fewer than {SPARSE} treatments are not drawn." if sparse else ""
        notes = (f"{found.said[0].upper()}{found.said[1:]}.{left}",)
    title = f"Reliability of {method}, the {half} half"
    return Table(
        f"reliability-{method}-{half}", title, columns, rows, (), "Confidence", notes=notes
    )


def accusations_table(rows: Sequence[Position]) -> Table:
    """Missions in which no parameter is to blame: who is first, and how confidently."""
    own = [row for method in SURE_METHODS for row in judged(rows, method) if not row.changed]
    columns = tuple(
        Column(heading, digits)
        for heading, digits in (
            ("Treatment", 0), ("Half", 0), ("Seed", 0), ("Labels", 0), ("Marks", 0), ("Method", 0),
            ("First", 0), ("Confidence", 2), ("Accused", 0),
        )
    )  # fmt: skip
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for row in sorted(own, key=lambda r: (r.system, r.type, r.treatment, r.seed)):
        accused = "yes" if accuses(row) else "no"
        cells = (
            row.treatment,
            row.half,
            row.seed,
            row.labels,
            row.marks,
            row.method,
            row.top or None,
        )
        lines.append((row.system, (*cells, row.confidence, accused)))
    return Table("accusations", "Where nobody is to blame", columns, tuple(lines), (), "System")


def accusation_counts(rows: Sequence[Position], halves: Sequence[str]) -> Table:
    """How many verdicts are confident, and how many of those are right, by what was done."""
    columns = (
        Column("Method", 0),
        Column("Half", 0),
        Column("Labels", 0),
        Column("Missions", 0),
        Column("with marks", 0),
        Column("Confident", 0),
        Column("of them right", 0),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for name, kinds in (
        ("changed parameter", {"type1", "type2"}),
        ("fault in the source", {"fault"}),
        ("clean", {"clean"}),
    ):
        for method, half in product(SURE_METHODS, halves):
            own = [r for r in judged(rows, method) if r.type in kinds and r.half == half]
            for labels in ordered((row.labels for row in own), LABELS):
                here = [row for row in own if row.labels == labels]
                confident = [row for row in here if accuses(row)]
                right = sum(rightness(row) for row in confident)
                marked = sum(row.marks > 0 for row in here)
                cells = (method, half, labels, len(here), marked, len(confident), right)
                lines.append((name, cells))
    return Table("confident", "Confident verdicts", columns, tuple(lines), (), "Missions with")


def false_accusations(rows: Sequence[Position], half: str, kind: str, method: str) -> Accusations:
    """In how many missions of a ``kind`` a verdict accuses somebody, by whichever labels."""
    own = [row for row in judged(rows, method) if row.type == kind and row.half == half]

    def missions(of: Callable[[Position], bool]) -> int:
        return len({(row.system, row.treatment, row.seed) for row in own if of(row)})

    return Accusations(
        missions(accuses), missions(lambda row: row.marks > 0), missions(lambda _: True)
    )
