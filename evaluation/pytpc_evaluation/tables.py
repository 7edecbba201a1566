"""Tables of figures, and how they are written: terminal, CSV, Markdown, LaTeX, JSON.

What a table holds is worked out elsewhere (``pytpc_evaluation.stats``,
``pytpc_evaluation.survey.static_tables``). Terminal, Markdown and LaTeX round as a person reads;
CSV and JSON have the numbers in full.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
from rich import box
from rich.cells import cell_len
from rich.table import Table as RichTable
from rich.text import Text

from pytpc.base.wording import plain

STATISTICS = ("mean", "median", "std", "min", "max", "sum")

Cell = float | int | str | None

_LATEX = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "$": r"\$",
    "&": r"\&",
    "#": r"\#",
    "%": r"\%",
    "_": r"\_",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
}
# Markdown gives these a meaning within a line or a table.
_MARKDOWN = re.compile(r"([\\`*_\[\]<>|])")
# In a terminal: so much of a name stays on one line however many columns there are, so much of a
# group's, and so much is between two columns.
_NAME_WIDTH = 28
_GROUP_WIDTH = 10
_BETWEEN = 3


@dataclass(frozen=True, slots=True)
class Column:
    """A column of figures: its heading and decimal places.

    Columns of one ``group`` stand side by side below its name. ``name`` is what CSV and JSON call
    the column; without one it is made of group and heading.
    """

    heading: str
    digits: int
    group: str = ""
    name: str = ""

    @property
    def key(self) -> str:
        """The name in CSV and JSON."""
        return self.name or f"{self.group} {self.heading}".strip().lower()


@dataclass(frozen=True, slots=True)
class Table:
    """A table ready to be written: ``label`` names it in files; the first column is the name.

    ``rows`` and ``summary`` are names with a cell for each column. ``first`` heads the names. A
    statistic of a column of whole numbers has ``statistic_digits`` decimal places. ``notes`` are
    sentences to stand below.
    """

    label: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, tuple[Cell, ...]], ...]
    summary: tuple[tuple[str, tuple[Cell, ...]], ...]
    first: str = "Name"
    statistic_digits: int = 1
    notes: tuple[str, ...] = ()


def statistics(values: Sequence[Cell]) -> dict[str, float | None]:
    """Mean, median, standard deviation, minimum, maximum and sum of the numbers among ``values``.

    The deviation is that of a sample (n - 1), so it is None for a single number. All are None
    where there is no number.
    """
    numbers = np.array(
        [value for value in values if isinstance(value, int | float)], dtype=np.float64
    )
    if not numbers.size:
        return dict.fromkeys(STATISTICS)
    return {
        "mean": float(numbers.mean()),
        "median": float(np.median(numbers)),
        "std": float(numbers.std(ddof=1)) if numbers.size > 1 else None,
        "min": float(numbers.min()),
        "max": float(numbers.max()),
        "sum": float(numbers.sum()),
    }


def as_csv(table: Table) -> str:
    """A table as CSV: heading, the rows, and the statistics; numbers in full."""
    heading = _names(table)
    body = [(name, *map(_full, cells)) for name, cells in (*table.rows, *table.summary)]
    return csv_text([heading, *body])


def as_markdown(table: Table) -> str:
    """A table in Markdown; the statistics are in italics, the notes below."""
    headings = [f"{column.group} {column.heading}".strip() for column in table.columns]
    lines = [
        markdown_row([table.first, *map(markdown, headings)]),
        markdown_row(["---", *("---" if text else "--:" for text in _texts(table))]),
    ]
    for name, cells in table.rows:
        lines.append(markdown_row([markdown(name), *map(markdown, shown(table, cells))]))
    for name, cells in table.summary:
        texts = shown(table, cells, statistic=True)
        lines.append(markdown_row([f"*{name}*", *map(markdown, texts)]))
    lines += [f"\n{markdown(note)}" for note in table.notes]
    return "\n".join(lines) + "\n"


def _texts(table: Table) -> list[bool]:
    """Whether each column has texts, which are aligned left."""
    every = [cells for _, cells in (*table.rows, *table.summary)]
    return [any(isinstance(cells[n], str) for cells in every) for n in range(len(table.columns))]


def as_latex(table: Table) -> str:
    """A table for a LaTeX document that uses the packages booktabs and longtable."""
    heading = [
        *_latex_groups(table),
        f"{' & '.join([latex(table.first), *(_stacked(c.heading) for c in table.columns)])} \\\\",
    ]
    width = len(table.columns) + 1
    lines = [
        r"{\footnotesize\setlength{\tabcolsep}{4pt}",
        rf"\begin{{longtable}}{{l{'r' * len(table.columns)}}}",
        rf"\caption{{{latex(table.title)}}}\label{{tab:{table.label}}}\\",
        r"\toprule",
        *heading,
        r"\midrule",
        r"\endfirsthead",
        r"\toprule",
        *heading,
        r"\midrule",
        r"\endhead",
        rf"\midrule\multicolumn{{{width}}}{{r}}{{Continued on next page}}\\",
        r"\endfoot",
        r"\bottomrule",
        r"\endlastfoot",
    ]
    lines += [_latex_row([name, *shown(table, cells)]) for name, cells in table.rows]
    if table.summary:
        lines.append(r"\midrule")
    lines += [
        _latex_row([name, *shown(table, cells, statistic=True)]) for name, cells in table.summary
    ]
    lines.append(r"\end{longtable}")
    lines += [rf"\noindent {latex(note)}\par" for note in table.notes]
    return "\n".join([*lines, "}", ""])


def as_json(table: Table) -> dict[str, Any]:
    """A table as an object for JSON: ``rows`` and ``summary`` are lists of objects by column.

    Unknown values and numbers that are not finite are null.
    """
    names = _names(table)

    def objects(rows: Sequence[tuple[str, tuple[Cell, ...]]]) -> list[dict[str, Cell]]:
        return [dict(zip(names, (name, *map(_finite, cells)), strict=True)) for name, cells in rows]

    return {
        "label": table.label,
        "title": table.title,
        "rows": objects(table.rows),
        "summary": objects(table.summary),
        "notes": list(table.notes),
    }


def as_rich(table: Table, width: int) -> list[RichTable]:
    """A table for a terminal of so many columns, without its title and notes.

    Columns that do not fit side by side go into further tables, with the names
    again: rich itself would leave them out.
    """
    names = [plain(name) for name, _ in (*table.rows, *table.summary)]
    first = min(max(map(cell_len, (table.first, *names))), max(_NAME_WIDTH, width // 3))
    rows = [shown(table, cells) for _, cells in table.rows]
    rows += [shown(table, cells, statistic=True) for _, cells in table.summary]
    rows = [[plain(text) for text in row] for row in rows]
    parts: list[list[tuple[int, int]]] = [[]]
    used = first
    for number, column in enumerate(table.columns):
        group = min(cell_len(plain(column.group)), _GROUP_WIDTH)
        need = max([group, *map(cell_len, (plain(column.heading), *(row[number] for row in rows)))])
        if parts[-1] and used + need + _BETWEEN > width - _BETWEEN:
            parts.append([])
            used = first
        used += need + _BETWEEN
        parts[-1].append((number, need))
    return [_rich_part(table, names, rows, part, first) for part in parts]


def _rich_part(
    table: Table,
    names: Sequence[str],
    rows: Sequence[Sequence[str]],
    columns: Sequence[tuple[int, int]],
    first: int,
) -> RichTable:
    """The ``columns``, each with its width, beside the names."""
    made = RichTable(box=box.SIMPLE_HEAD, pad_edge=False)
    made.add_column(Text(plain(table.first)), overflow="fold", width=first)
    for number, width in columns:
        column = table.columns[number]
        above = f"{plain(column.group)}\n" if column.group else ""
        heading = Text(above + plain(column.heading))
        made.add_column(heading, justify="right", overflow="fold", width=width)
    for place, (name, row) in enumerate(zip(names, rows, strict=True)):
        if place == len(table.rows):
            made.add_section()
        look = "italic" if place >= len(table.rows) else ""
        texts = (Text(row[number]) for number, _ in columns)
        made.add_row(Text(name, style=look), *texts)
    return made


def latex(text: str) -> str:
    """``text`` with LaTeX's own characters written so that they are printed."""
    return "".join(_LATEX.get(character, character) for character in plain(text))


def markdown(text: str) -> str:
    """``text`` with Markdown's own characters written so that they are printed."""
    return _MARKDOWN.sub(r"\\\1", plain(text))


def markdown_row(cells: Sequence[str]) -> str:
    """A line of a table in Markdown."""
    return f"| {' | '.join(cells)} |"


def csv_text(rows: Sequence[Sequence[str]]) -> str:
    """Rows of texts as CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def shown(table: Table, cells: Sequence[Cell], *, statistic: bool = False) -> list[str]:
    """The cells of a row for people: rounded; a dash for unknown values.

    A mean of counts has more decimal places than the counts.
    """
    more = table.statistic_digits if statistic else 0
    return [
        _rounded(cell, column.digits, more)
        for cell, column in zip(cells, table.columns, strict=True)
    ]


def _rounded(cell: Cell, digits: int, more: int) -> str:
    if cell is None:
        return "-"
    if isinstance(cell, str):
        return cell
    if more and digits == 0 and not float(cell).is_integer():
        digits = more
    return f"{cell:.{digits}f}"


def _full(cell: Cell) -> str:
    if cell is None:
        return ""
    if isinstance(cell, float) and cell.is_integer():
        return str(int(cell))
    return str(cell)


def _names(table: Table) -> list[str]:
    """The names of the columns in CSV and JSON, that of the names first; no two are equal.

    The last of those that are alike keeps its name: a user ``total`` stands before the totals.
    """
    names: list[str] = []
    for name in (*(column.key for column in reversed(table.columns)), table.first.lower()):
        count, unique = 1, name
        while unique in names:
            count += 1
            unique = f"{name} {count}"
        names.append(unique)
    return names[::-1]


def _finite(cell: Cell) -> Cell:
    return None if isinstance(cell, float) and not math.isfinite(cell) else cell


def _latex_groups(table: Table) -> list[str]:
    """The line of the groups' names, each with a rule below; empty without groups."""
    if not any(column.group for column in table.columns):
        return []
    cells, rules, place = [""], [], 2
    for group, members in groupby(table.columns, key=lambda column: column.group):
        width = len(list(members))
        cells.append(rf"\multicolumn{{{width}}}{{c}}{{{latex(group)}}}")
        if group:
            rules.append(rf"\cmidrule(lr){{{place}-{place + width - 1}}}")
        place += width
    return [f"{' & '.join(cells)} \\\\", "".join(rules)]


def _stacked(heading: str) -> str:
    """A heading of several words, one below the other, so that ten columns fit on a page."""
    words = [latex(word) for word in heading.split()]
    return words[0] if len(words) == 1 else r"\shortstack[r]{" + r"\\".join(words) + "}"


def _latex_row(cells: Sequence[str]) -> str:
    return f"{' & '.join(map(latex, cells))} \\\\"
