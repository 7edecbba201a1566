"""Rows under headings that never break a name or a path: a table, or blocks where it is narrow."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, JustifyMethod, RenderableType, RenderResult
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

_GAP = 2
_INDENT = 3
_WORD = re.compile(r"\S+")


@dataclass(frozen=True, slots=True)
class Heading:
    """A column: what it is called, and whether it holds numbers.

    ``in_line``: where the terminal is narrow, it stands in the first line of a block, without its
    heading. The other columns get a line each.
    """

    name: str
    right: bool = False
    in_line: bool = False


@dataclass(frozen=True)
class Listing:
    """Rows with a cell for each heading; a cell may have several lines.

    A table breaks lines between words alone. If there is no room for the longest words, each row is
    a block. With ``one_line``, for output that is piped, each row is a line, however long.
    """

    headings: Sequence[Heading]
    rows: Sequence[Sequence[Text]]
    one_line: bool = False

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        """At least the longest words, at most the longest lines."""
        least, most = self._widths()
        gaps = _GAP * len(self.headings)
        widest = min(sum(most) + gaps, options.max_width)
        return Measurement(min(sum(least) + gaps, widest), widest)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """The table, or the blocks."""
        least, most = self._widths()
        room = options.max_width - _GAP * len(self.headings)
        if self.one_line or sum(least) <= room:
            yield self._table(_shared(least, most, room))
        else:
            yield from self._blocks(options.max_width)

    def _widths(self) -> tuple[list[int], list[int]]:
        """For each column the longest word, and the longest line."""
        least, most = [], []
        for number, heading in enumerate(self.headings):
            texts = [heading.name, *(self._cell(row[number]).plain for row in self.rows)]
            lines = [line for text in texts for line in text.split("\n")]
            words = [word for line in lines for word in line.split()]
            least.append(max((cell_len(word) for word in words), default=0))
            most.append(max(cell_len(line) for line in lines))
        return least, most

    def _cell(self, cell: Text) -> Text:
        return Text("  ").join(cell.split("\n")) if self.one_line else cell

    def _table(self, widths: Sequence[int]) -> Table:
        table = Table(box=None, pad_edge=False, padding=(0, _GAP, 0, 0))
        for heading, width in zip(self.headings, widths, strict=True):
            justify: JustifyMethod = "right" if heading.right else "left"
            table.add_column(heading.name, justify=justify, width=width, overflow="fold")
        for row in self.rows:
            table.add_row(*map(self._cell, row))
        return table

    def _blocks(self, width: int) -> Iterator[RenderableType]:
        for row in self.rows:
            cells = list(zip(self.headings, row, strict=True))
            first = Text("  ").join(cell for heading, cell in cells if heading.in_line)
            yield broken(first, width)
            for heading, cell in cells:
                if heading.in_line or not cell.plain:
                    continue
                head = Text.assemble((f"{heading.name}: ", "dim"), cell)
                for number, line in enumerate(head.split("\n")):
                    indent = _INDENT if number == 0 else _INDENT + _GAP
                    part = broken(line, width - indent)
                    yield Padding(part, (0, 0, 0, indent), expand=False)


def broken(line: Text, width: int) -> Text:
    """A line whose words fit into a width: longer ones are broken behind a slash if they can be."""
    cuts = []
    for word in _WORD.finditer(line.plain):
        begin = word.start()
        while cell_len(line.plain[begin : word.end()]) > max(1, width):
            end = begin + max(1, width)
            slash = line.plain.rfind("/", begin, end)
            begin = slash + 1 if slash >= begin else end
            cuts.append(begin)
    return Text("\n").join(line.divide(cuts)) if cuts else line


def _shared(least: Sequence[int], most: Sequence[int], room: int) -> list[int]:
    """Widths that fit: each column has its least, and those that need little get all they need."""
    widths, left = list(least), room - sum(least)
    order = sorted(range(len(widths)), key=lambda number: most[number] - least[number])
    for place, number in enumerate(order):
        share = max(0, left) // (len(order) - place)
        more = min(most[number] - least[number], share)
        widths[number] += more
        left -= more
    return widths
