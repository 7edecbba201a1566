"""The answers of `pytpc.api`, to look at in a terminal or a notebook."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TypeVar, overload

from rich.cells import cell_len

from pytpc.base.wording import exact, percent, plain, show, shown_value
from pytpc.diagnosis.results.advice import Advice
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.differences import RunDifferences
from pytpc.diagnosis.results.suspects import MarkRanking

_GAP = 2
_DIFFERENCES = 8
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
        return self.items[index]

    def __str__(self) -> str:
        return str(self.table())

    def _repr_html_(self) -> str:
        """The table for a notebook, escaped."""
        return self.table()._repr_html_()


@dataclass(frozen=True, slots=True)
class Advices(TableSequence[Advice]):
    """What to do with the suspects at one mark, in their order.

    A sequence of `pytpc.diagnosis.results.advice.Advice`: suspect, value to try, smallest
    change, and what they would have changed.
    """

    advices: tuple[Advice, ...]
    ranking: MarkRanking

    @property
    def items(self) -> tuple[Advice, ...]:
        """The advice for each suspect."""
        return self.advices

    def table(self) -> NotebookTable:
        """A row for each suspect."""
        rows = []
        for advice in self.advices:
            least, told = advice.suggestion, advice.told
            then = advice.what_if if told is least else advice.tried
            what = f"{told.direction} to {exact(told.value)}"
            rows.append(
                (
                    f"{advice.suspect.position}{'=' if advice.suspect.tied else ''}",
                    advice.suspect.parameter,
                    show(told.current),
                    what if told.direction else f"none: {told.reason}",
                    then.text if then else "",
                    f"{least.direction} to {exact(least.value)}" if least.direction else "none",
                )
            )
        headings = ("#", "parameter", "value", "to try", "in the recorded run", "smallest change")
        return NotebookTable(headings, tuple(rows), frozenset({0, 2}))


@dataclass(frozen=True)
class Diagnosed(Diagnosis):
    """The answer about a mission, to look at in a terminal or a notebook."""

    @classmethod
    def of(cls, found: Diagnosis) -> Diagnosed:
        """The same answer."""
        return cls(found.blame, found.advice, found.differences)

    def rows(self) -> list[dict[str, object]]:
        """All suspects, flat; ``pandas.DataFrame(diagnosed.rows())``.

        Each has ``position``, ``parameter``, ``probability``, ``type``, ``place`` (``file:line``)
        and ``key``. Of one that no comparison reports, type and key are None, and its place is what
        is known of it in words.
        """
        return [
            {
                "position": one.position,
                "parameter": one.parameter,
                "probability": one.probability,
                "type": one.type,
                "place": one.place,
                "key": one.key,
            }
            for one in self.blame.suspects
        ]

    def table(self) -> NotebookTable:
        """A row for each likely suspect that has an advice."""
        rows = []
        for one in self.shown:
            accused, tried = one.accused, one.remedy
            what = f"{tried.direction} to {exact(tried.value)}"
            rows.append(
                (
                    f"{accused.position}{'=' if accused.tied else ''}",
                    accused.parameter,
                    percent(accused.probability),
                    accused.type or "",
                    one.current,
                    what if tried.direction else f"none: {tried.reason}",
                    accused.place,
                )
            )
        headings = ("#", "parameter", "probability", "type", "value", "to try", "compared at")
        return NotebookTable(headings, tuple(rows), frozenset({0, 2, 4}))

    def _parts(self) -> tuple[list[str], list[NotebookTable], list[str]]:
        """Lines, tables and lines, in this order."""
        tables, before, after = [], [], []
        if self.differences is not None:
            found = self.differences
            if found.found:
                tables.append(differences_table(found, _DIFFERENCES))
            else:
                before.append(found.title)
            if len(found.found) > _DIFFERENCES:
                after.append(f"and {len(found.found) - _DIFFERENCES:,} more parameters that differ")
            before += found.notes
        if self.shown:
            tables.append(self.table())
        before += [self.blame.title, self.headline, *self.blame.notes]
        after += [one.sentence for one in self.groups]
        return before, tables, [*after, *([self.folded_text] if self.folded_text else [])]

    def __str__(self) -> str:
        """The verdict and the tables as text."""
        before, tables, after = self._parts()
        return "\n".join([*map(plain, before), *map(str, tables), *map(plain, after)])

    def _repr_html_(self) -> str:
        """The same for a notebook, escaped."""
        before, tables, after = self._parts()
        shown = "".join(one._repr_html_() for one in tables)
        return f"<p>{_lines(before)}</p>{shown}{f'<p>{_lines(after)}</p>' if after else ''}"


def _lines(texts: Sequence[str]) -> str:
    return "<br>".join(_html(text) for text in texts)


def differences_table(found: RunDifferences, most: int | None = None) -> NotebookTable:
    """A row for each parameter that differs from the good runs, or for the first ``most``."""
    rows = [
        (
            one.name,
            shown_value(one.good.value),
            shown_value(one.bad.value),
            one.bad.place,
            one.effect,
        )
        for one in found.found[:most]
    ]
    headings = ("parameter", "good run", "this run", "set at", "effect")
    return NotebookTable(headings, tuple(rows), frozenset({1, 2}), found.title)
