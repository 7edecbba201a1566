"""The answers of `pytpc.api`, to look at in a terminal or a notebook."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TypeVar, overload

from rich.cells import cell_len

from pytpc.base.wording import exact, percent, plain, show
from pytpc.diagnosis.results.advice import Advice, BlamedAdvice
from pytpc.diagnosis.results.suspects import Blame, MarkRanking

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


@dataclass(frozen=True, slots=True)
class Diagnosed:
    """What all marks of a mission say together, and what to do with the first suspects.

    ``blame`` has all suspects with their probabilities, and what keeps them from being surer;
    ``advice`` is the value to try of the first ones
    (`pytpc.diagnosis.results.advice.BlamedAdvice`).
    """

    blame: Blame
    advice: tuple[BlamedAdvice, ...]

    @property
    def accused(self) -> str | None:
        """The parameter to blame; None where it is not sure (a probability below one half)."""
        return self.blame.accused

    @property
    def confidence(self) -> float:
        """The probability of the first suspect."""
        return self.blame.confidence

    def rows(self) -> list[dict[str, object]]:
        """All suspects, flat; ``pandas.DataFrame(diagnosed.rows())``.

        Each has ``position``, ``parameter``, ``probability``, ``type``, ``place`` (``file:line``)
        and ``key``.
        """
        return [
            {
                "position": one.position,
                "parameter": one.parameter,
                "probability": one.probability,
                "type": one.type,
                "place": f"{one.comparison.file}:{one.comparison.lineno}",
                "key": one.key,
            }
            for one in self.blame.suspects
        ]

    def table(self) -> NotebookTable:
        """A row for each suspect that has an advice."""
        rows = []
        for one in self.advice:
            accused, tried = one.accused, one.remedy
            what = f"{tried.direction} to {exact(tried.value)}"
            rows.append(
                (
                    f"{accused.position}{'=' if accused.tied else ''}",
                    accused.parameter,
                    percent(accused.probability),
                    accused.type,
                    show(accused.last.thresh if tried.current is None else tried.current),
                    what if tried.direction else f"none: {tried.reason}",
                    f"{accused.comparison.file}:{accused.comparison.lineno}",
                )
            )
        headings = ("#", "parameter", "probability", "type", "value", "to try", "compared at")
        return NotebookTable(headings, tuple(rows), frozenset({0, 2, 4}))

    def _said(self) -> list[str]:
        return [self.blame.title, self.blame.text, *self.blame.notes]

    def __str__(self) -> str:
        """The verdict and the table as text."""
        said = [plain(line) for line in self._said()]
        return "\n".join([*said, str(self.table())] if self.advice else said)

    def _repr_html_(self) -> str:
        """The same for a notebook, escaped."""
        said = "<br>".join(escape(plain(line)) for line in self._said())
        return f"<p>{said}</p>{self.table()._repr_html_() if self.advice else ''}"
