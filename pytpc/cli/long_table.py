"""Prints tables of thousands of rows: the same text as rich's, in a fiftieth of the time."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import zip_longest

from rich.cells import cell_len
from rich.console import Console
from rich.text import Text

from pytpc.base.wording import plain
from pytpc.cli.console import table_of

LONG = 300
"""Shorter tables are left to rich."""

_BOTTOM, _JOINT, _BORDER = "└", "┴", "│"


def print_table(
    out: Console,
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    right: Collection[str] = (),
) -> None:
    """Print a table of texts; the columns ``right`` hold numbers, the others are folded."""
    if len(rows) < LONG:
        out.print(table_of(headings, rows, right), highlight=False)
        return
    cells = [[plain(cell) for cell in row] for row in rows]
    # The widths of rich's columns depend on their widest cells and words alone.
    frame = _printed(out, headings, _widest(cells), right)
    bottom = frame[-1]
    head = next((n for n, line in enumerate(frame) if "╇" in line or "┡" in line), None)
    if head is None or not bottom.startswith(_BOTTOM):
        # Another form of box, for an output that has no such characters.
        out.print(table_of(headings, rows, right), highlight=False)
        return
    widths = [len(part) - 2 for part in bottom.strip("└┘").split(_JOINT)]
    numbers = [heading in right for heading in headings]
    lines = [*frame[: head + 1]]
    for row in cells:
        lines += _lines(row, widths, numbers)
    out.file.write("\n".join([*lines, bottom]) + "\n")


def _printed(
    out: Console, headings: Sequence[str], rows: Sequence[Sequence[str]], right: Collection[str]
) -> list[str]:
    with out.capture() as captured:
        out.print(table_of(headings, rows, right), highlight=False)
    return captured.get().splitlines()


def _widest(rows: Sequence[Sequence[str]]) -> list[list[str]]:
    """Two rows: of each column its widest cell, and its widest word."""
    columns = [set(column) for column in zip(*rows, strict=True)]
    words = [{word for cell in column for word in cell.split()} or {""} for column in columns]
    return [[max(column, key=_width) for column in kind] for kind in (columns, words)]


def _width(text: str) -> int:
    return len(text) if text.isascii() else cell_len(text)


def _lines(row: Sequence[str], widths: Sequence[int], numbers: Sequence[bool]) -> list[str]:
    """The lines of a row, in which no cell is wider than its column."""
    folded = [_folded(cell, width) for cell, width in zip(row, widths, strict=True)]
    return [
        f"{_BORDER} {f' {_BORDER} '.join(map(_padded, parts, widths, numbers))} {_BORDER}"
        for parts in zip_longest(*folded, fillvalue="")
    ]


def _padded(text: str, width: int, is_number: bool) -> str:
    space = " " * (width - _width(text))
    return space + text if is_number else text + space


def _folded(text: str, width: int) -> list[str]:
    if _width(text) <= width:
        return [text]
    if not text.isascii():
        return [line.plain for line in Text(text).wrap(_MEASURE, width, overflow="fold")]
    return _fold(text, width)


_MEASURE = Console()


def _fold(text: str, width: int) -> list[str]:
    """Lines of whole words; a word that is too long for a line is cut where the line ends."""
    lines, line = [], ""
    for word in _words(text):
        bare = word.rstrip()
        if len(line) + len(bare) <= width:
            line += word
            continue
        if len(bare) <= width:
            if line:
                lines.append(line)
            line = word
            continue
        if line:
            lines.append(line)
        pieces = [word[at : at + width] for at in range(0, len(word), width)]
        lines += pieces[:-1]
        line = pieces[-1]
    return [one.rstrip() for one in [*lines, line]]


def _words(text: str) -> list[str]:
    """The words with the spaces behind them; those before the first belong to it."""
    parts = text.split(" ")
    words: list[str] = []
    lead = ""
    for place, part in enumerate(parts):
        space = " " if place < len(parts) - 1 else ""
        if part:
            words.append(lead + part + space)
            lead = ""
        elif words:
            words[-1] += space
        else:
            lead += space
    return words
