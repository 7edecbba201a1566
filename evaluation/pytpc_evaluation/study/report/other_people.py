"""How much depends on the people: the ranking by other people's marks, as a table of the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pytpc_evaluation.study.data import LABELS
from pytpc_evaluation.study.metrics import exact_share
from pytpc_evaluation.study.other_marks import VARIANTS
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.positions import Position, ordered
from pytpc_evaluation.study.report.ranked import METHODS, TARGET_PLACES, percent, top
from pytpc_evaluation.study.report.sensitivity import ALONE_METHODS, CROWDS
from pytpc_evaluation.tables import Cell, Column, Table

_WORDS: Mapping[str, str] = {
    "thesis": "the study's own",
    "fast": "delays x 0.5",
    "slow": "delays x 2",
    "spread": "delays spread by 0.6",
    "two-marks": "two marks for each error",
    "alone": "user 2 alone",
    "coin": "types by a coin",
}


def parts_with_others(rows: Sequence[Position], parts: Sequence[Part]) -> list[Part]:
    """Those of the parts whose treatments were ranked by other people's marks."""
    return [part for part in parts if _of(rows, part)]


def others_table(rows: Sequence[Position], part: Part) -> Table:
    """Top 3 by crowd and labels, of one part; ``who`` of a row is the crowd."""
    own = [row for row in _of(rows, part) if row.who in CROWDS]
    methods = ordered((row.method for row in own), METHODS)
    columns = (
        Column("Labels", 0),
        Column("Treatments", 0),
        Column("Marks", 1),
        *(Column(method, 0) for method in methods),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for crowd in ordered((row.who for row in own), CROWDS):
        for labels in ordered((row.labels for row in own), LABELS):
            here = [row for row in own if (row.who, row.labels) == (crowd, labels)]
            if not here:
                continue
            shares = [
                top([row for row in here if row.method == method], TARGET_PLACES)
                for method in methods
            ]
            count = max(share.treatments for share in shares)
            marks = sum(row.marks for row in here) / len(here)
            words = _WORDS.get(crowd, crowd)
            lines.append((words, (labels, count, marks, *map(percent, shares))))
    title = f"Top 3 in % by other people's marks, the {part.title}"
    return Table(f"others-{part.name}", title, columns, tuple(lines), (), "People")


def marks_table(rows: Sequence[Position], part: Part) -> Table:
    """Top 1 and top 3 of one observer by what is different about the marks, of one part.

    Missions in which nothing was marked, or everything after their end, are left out.
    """
    own = [row for row in _of(rows, part) if row.who in VARIANTS and row.marks]
    columns = [Column("Treatments", 0)]
    for method in ALONE_METHODS:
        columns += [Column(f"{method}, top 1 %", 0), Column(f"{method}, top 3 %", 0)]
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for variant in ordered((row.who for row in own), tuple(VARIANTS)):
        here = [row for row in own if row.who == variant]
        shares = [
            exact_share(
                [row.within(k) for row in here if row.method == method],
                [(row.system, row.treatment) for row in here if row.method == method],
            )
            for method in ALONE_METHODS
            for k in (1, TARGET_PLACES)
        ]
        words, _ = VARIANTS[variant]
        lines.append((words, (shares[0].treatments, *map(percent, shares))))
    title = f"One observer's other marks, the {part.title}"
    return Table(f"other-marks-{part.name}", title, tuple(columns), tuple(lines), (), "Marks")


def _of(rows: Sequence[Position], part: Part) -> list[Position]:
    return [row for row in rows if row.changed and part.has(row.half, row.round)]
