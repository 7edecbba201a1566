"""The rows of a survey's tables: the columns of the thesis's tables C.1 and C.2, and statistics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pytpc.source_lines import CPP, HEADER, PYTHON
from pytpc.survey import Build, TreeResult

STATISTICS = ("mean", "median", "std", "min", "max", "sum")
NOT_ANALYSED = "not analysed"

Cell = float | int | str | None


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table: its heading, decimal places, and its value for a tree.

    ``total`` gives the value of the row ``sum`` where that is no sum.
    """

    heading: str
    digits: int
    of: Callable[[TreeResult], Cell]
    total: Callable[[Sequence[TreeResult]], Cell] | None = None


@dataclass(frozen=True, slots=True)
class Table:
    """A table ready to be written: ``label`` names it in files; the first column is the name."""

    label: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, tuple[Cell, ...]], ...]
    summary: tuple[tuple[str, tuple[Cell, ...]], ...]


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


def tables(results: Sequence[TreeResult]) -> list[Table]:
    """The thesis's tables C.1 and C.2, and the times in full."""
    return [
        _table("comparisons", "Comparisons with parameters", _COMPARISONS, results),
        _table("lines", "Files and lines of code", _LINES, results),
        _table("times", "Build times in seconds, without and with TPC", _TIMES, results),
    ]


def _table(
    label: str, title: str, columns: tuple[Column, ...], results: Sequence[TreeResult]
) -> Table:
    rows = tuple(
        (result.name, tuple(column.of(result) for column in columns)) for result in results
    )
    figures = [statistics([cells[number] for _, cells in rows]) for number in range(len(columns))]
    summary = []
    for name in STATISTICS:
        cells: list[Cell] = [figure[name] for figure in figures]
        if name == "sum":
            for number, column in enumerate(columns):
                if column.total is not None:
                    cells[number] = column.total(results)
        summary.append((name, tuple(cells)))
    return Table(label, title, columns, rows, tuple(summary))


def _factor_of_sums(which: str) -> Callable[[Sequence[TreeResult]], Cell]:
    """The factor of the summed times, over the trees that have one."""

    def total(results: Sequence[TreeResult]) -> Cell:
        pairs = [
            (getattr(result.tpc, which), getattr(result.plain, which))
            for result in results
            if result.plain is not None and result.factor(which) is not None
        ]
        without = sum(pair[1] for pair in pairs)
        return sum(pair[0] for pair in pairs) / without if without > 0 else None

    return total


def _time(build: str, which: str) -> Callable[[TreeResult], Cell]:
    def value(result: TreeResult) -> Cell:
        measured: Build | None = getattr(result, build)
        return None if measured is None else float(getattr(measured, which))

    return value


def _factor(heading: str, which: str) -> Column:
    return Column(heading, 2, lambda result: result.factor(which), _factor_of_sums(which))


def _of_language(what: str, *languages: str) -> Callable[[TreeResult], Cell]:
    return lambda result: sum(getattr(result.lines.of(name), what) for name in languages)


def _others(what: str) -> Callable[[TreeResult], Cell]:
    return lambda result: sum(
        getattr(count, what)
        for name, count in result.lines.languages.items()
        if name not in (CPP, HEADER, PYTHON)
    )


def _python(result: TreeResult) -> Cell:
    return NOT_ANALYSED if result.python is None else result.python


def _all_comparisons(result: TreeResult) -> Cell:
    return NOT_ANALYSED if result.python is None else result.found.comparisons + result.python


_COMPARISONS = (
    Column("Time", 1, _time("plain", "processor")),
    _factor("Time Factor", "processor"),
    Column("TPCs", 0, _all_comparisons),
    Column("C++", 0, lambda result: result.found.comparisons),
    Column("Python", 0, _python),
    Column("Unique", 0, lambda result: result.found.parameters),
    Column("Files", 0, lambda result: result.found.files),
    Column("Packages", 0, lambda result: result.packages),
    Column("Not built", 0, lambda result: len(result.tpc.not_built)),
)
_LINES = (
    Column("C++ Files", 0, _of_language("files", CPP)),
    Column("C++ Lines", 0, _of_language("code", CPP)),
    Column("Header Files", 0, _of_language("files", HEADER)),
    Column("Header Lines", 0, _of_language("code", HEADER)),
    Column("Python Files", 0, _of_language("files", PYTHON)),
    Column("Python Lines", 0, _of_language("code", PYTHON)),
    Column("Total Files", 0, _of_language("files", CPP, HEADER, PYTHON)),
    Column("Total Lines", 0, _of_language("code", CPP, HEADER, PYTHON)),
    Column("Other Files", 0, _others("files")),
    Column("Other Lines", 0, _others("code")),
)
_TIMES = (
    Column("Processor", 1, _time("plain", "processor")),
    Column("with TPC", 1, _time("tpc", "processor")),
    _factor("Factor", "processor"),
    Column("Compile", 1, _time("plain", "compile")),
    Column("with TPC", 1, _time("tpc", "compile")),
    _factor("Factor", "compile"),
    Column("Wall", 1, _time("plain", "wall")),
    Column("with TPC", 1, _time("tpc", "wall")),
    _factor("Factor", "wall"),
    Column("First", 0, lambda result: result.first),
)
