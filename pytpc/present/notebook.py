"""Small tables that a terminal shows as text and a notebook as HTML."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from rich.cells import cell_len

from pytpc.base import tables
from pytpc.base.wording import plain

_GAP = 2


@dataclass(frozen=True, slots=True)
class Table:
    """Headings and rows of text; ``right`` says which columns hold numbers.

    Texts may come from a robot: ``str`` shows control characters as what they are, HTML is escaped.
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    right: frozenset[int] = frozenset()
    title: str = ""

    def __str__(self) -> str:
        """Columns under their headings, without spaces at the ends of lines."""
        cells = [self.headings, *self.rows]
        shown = [[plain(cell) for cell in row] for row in cells]
        widths = [max(cell_len(row[n]) for row in shown) for n in range(len(self.headings))]
        lines = [self._line(row, widths) for row in shown]
        return "\n".join([self.title, *lines] if self.title else lines)

    def _repr_html_(self) -> str:
        """For a notebook."""
        head = "".join(self._cell("th", n, text) for n, text in enumerate(self.headings))
        body = "".join(
            "<tr>" + "".join(self._cell("td", n, text) for n, text in enumerate(row)) + "</tr>"
            for row in self.rows
        )
        caption = f"<caption>{_html(self.title)}</caption>" if self.title else ""
        return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

    def _line(self, row: Sequence[str], widths: Sequence[int]) -> str:
        parts = []
        for n, (text, width) in enumerate(zip(row, widths, strict=True)):
            room = " " * (width - cell_len(text))
            parts.append(room + text if n in self.right else text + room)
        return (" " * _GAP).join(parts).rstrip()

    def _cell(self, tag: str, column: int, text: str) -> str:
        align = "right" if column in self.right else "left"
        return f'<{tag} style="text-align:{align}">{_html(text)}</{tag}>'


@dataclass(frozen=True, slots=True)
class StudyTable:
    """A table of `pytpc.base.tables` that prints, and shows itself in a notebook."""

    table: tables.Table

    def rows(self) -> list[dict[str, object]]:
        """The rows with their numbers in full; ``pandas.DataFrame(table.rows())``."""
        return [dict(row) for row in tables.as_json(self.table)["rows"]]

    def shown(self) -> Table:
        """The same as a person reads it, with the statistics below."""
        headings = [f"{column.group} {column.heading}".strip() for column in self.table.columns]
        rows = [(name, *tables.shown(self.table, cells)) for name, cells in self.table.rows]
        rows += [
            (name, *tables.shown(self.table, cells, statistic=True))
            for name, cells in self.table.summary
        ]
        right = frozenset(range(1, len(headings) + 1))
        return Table((self.table.first, *headings), tuple(rows), right, self.table.title)

    def __str__(self) -> str:
        """The table as text."""
        return str(self.shown())

    def _repr_html_(self) -> str:
        """The table for a notebook, escaped."""
        return self.shown()._repr_html_()


def _html(text: str) -> str:
    return escape(plain(text))
