"""Small tables that a terminal shows as text and a notebook as HTML."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TypeVar, overload

from rich.cells import cell_len

from pytpc.base.wording import plain

_GAP = 2
Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class NotebookTable:
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


def _html(text: str) -> str:
    return escape(plain(text))


class TableSequence(Sequence[Item]):
    """Answers in their order, which a terminal shows as a table and a notebook as HTML."""

    @property
    @abstractmethod
    def items(self) -> tuple[Item, ...]:
        """The answers."""

    @abstractmethod
    def table(self) -> NotebookTable:
        """The answers to look at."""

    def __len__(self) -> int:
        """How many there are."""
        return len(self.items)

    @overload
    def __getitem__(self, index: int) -> Item: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Item, ...]: ...

    def __getitem__(self, index: int | slice) -> Item | tuple[Item, ...]:
        """One of them."""
        return self.items[index]

    def __str__(self) -> str:
        """The table as text."""
        return str(self.table())

    def _repr_html_(self) -> str:
        """The table for a notebook, escaped."""
        return self.table()._repr_html_()
