"""The tables of a study for a notebook, from the paths of its missions."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.api.missions import Source, load_static
from pytpc.present.answers import NotebookTable
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation import tables
from pytpc_evaluation.stats.missions import load_missions
from pytpc_evaluation.stats.thesis_tables import NUMBERS, thesis_tables


@dataclass(frozen=True, slots=True)
class StudyTable:
    """A table of `pytpc_evaluation.tables` that prints, and shows itself in a notebook."""

    table: tables.Table

    def rows(self) -> list[dict[str, object]]:
        """The rows with their numbers in full; ``pandas.DataFrame(table.rows())``."""
        return [dict(row) for row in tables.as_json(self.table)["rows"]]

    def shown(self) -> NotebookTable:
        """The same as a person reads it, with the statistics below."""
        headings = [f"{column.group} {column.heading}".strip() for column in self.table.columns]
        rows = [(name, *tables.shown(self.table, cells)) for name, cells in self.table.rows]
        rows += [
            (name, *tables.shown(self.table, cells, statistic=True))
            for name, cells in self.table.summary
        ]
        right = frozenset(range(1, len(headings) + 1))
        return NotebookTable((self.table.first, *headings), tuple(rows), right, self.table.title)

    def __str__(self) -> str:
        return str(self.shown())

    def _repr_html_(self) -> str:
        """The table for a notebook, escaped."""
        return self.shown()._repr_html_()


def study_tables(
    missions: Source | Sequence[Source],
    static_info: StaticInfo | Source,
    names: Sequence[str] = tuple(NUMBERS),
) -> dict[str, StudyTable]:
    """The tables of a study (6.12 to 6.16 of the thesis), by name.

    Args:
        missions: folders or files of recorded missions; a folder of them stands for all.
        static_info: of the build that was recorded.
        names: which, of ``runtime``, ``confusion``, ``delays``, ``marks`` and ``found``.

    Raises:
        InputError: a mission cannot be read.
        KeyError: there is no table of such a name.
    """
    given = [missions] if isinstance(missions, str | os.PathLike) else missions
    found = load_missions([Path(one) for one in given])
    made = thesis_tables(found, load_static(static_info), names)
    return {name: StudyTable(table) for name, table in zip(names, made, strict=True)}
