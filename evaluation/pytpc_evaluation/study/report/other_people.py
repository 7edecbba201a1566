"""How much depends on the people: the ranking by other people's marks, as a table of the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pytpc_evaluation.study.data import LABELS
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.positions import Position, ordered
from pytpc_evaluation.study.report.ranked import METHODS, TARGET_PLACES, percent, top
from pytpc_evaluation.study.report.sensitivity import CROWDS
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
    own = _of(rows, part)
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


def _of(rows: Sequence[Position], part: Part) -> list[Position]:
    return [row for row in rows if row.changed and part.has(row.half, row.round)]
