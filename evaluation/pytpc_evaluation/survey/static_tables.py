"""The rows of a survey's tables: the columns of the thesis's tables C.1 and C.2, and statistics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pytpc_evaluation.survey.source_lines import CPP, HEADER, PYTHON
from pytpc_evaluation.survey.trees import Build, TreeResult
from pytpc_evaluation.tables import STATISTICS, Cell, Column, Table, statistics


@dataclass(frozen=True, slots=True)
class Measure:
    """A column of a table: its heading, decimal places, and its value for a tree.

    ``total`` gives the value of the row ``sum`` where that is no sum.
    """

    heading: str
    digits: int
    of: Callable[[TreeResult], Cell]
    total: Callable[[Sequence[TreeResult]], Cell] | None = None


def tables(results: Sequence[TreeResult]) -> list[Table]:
    """The thesis's tables C.1 and C.2, and the times in full."""
    return [
        _table("comparisons", "Comparisons with parameters", _COMPARISONS, results),
        _table("lines", "Files and lines of code", _LINES, results),
        _table("times", "Build times in seconds, without and with TPC", _TIMES, results),
    ]


def _table(
    label: str, title: str, columns: tuple[Measure, ...], results: Sequence[TreeResult]
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
    return Table(label, title, _columns(columns), rows, tuple(summary))


def _columns(measures: Sequence[Measure]) -> tuple[Column, ...]:
    """Columns of which no two have one name: ``with TPC`` belongs to the column before it."""
    made: list[Column] = []
    group = ""
    for measure in measures:
        heading = measure.heading
        if heading not in ("with TPC", "Factor"):
            group = name = heading
        else:
            name = f"{group} {heading}"
        made.append(Column(heading, measure.digits, name=name.lower()))
    return tuple(made)


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


def _factor(heading: str, which: str) -> Measure:
    return Measure(heading, 2, lambda result: result.factor(which), _factor_of_sums(which))


def _of_language(what: str, *languages: str) -> Callable[[TreeResult], Cell]:
    return lambda result: sum(getattr(result.lines.of(name), what) for name in languages)


def _others(what: str) -> Callable[[TreeResult], Cell]:
    return lambda result: sum(
        getattr(count, what)
        for name, count in result.lines.languages.items()
        if name not in (CPP, HEADER, PYTHON)
    )


_COMPARISONS = (
    Measure("Time", 1, _time("plain", "processor")),
    _factor("Time Factor", "processor"),
    Measure("TPCs", 0, lambda result: result.found.comparisons + result.found.python),
    Measure("C++", 0, lambda result: result.found.comparisons),
    Measure("Python", 0, lambda result: result.found.python),
    Measure("Unique", 0, lambda result: result.found.parameters),
    Measure("Files", 0, lambda result: result.found.files),
    Measure("Packages", 0, lambda result: result.packages),
    Measure("Not built", 0, lambda result: len(result.tpc.not_built)),
)
_LINES = (
    Measure("C++ Files", 0, _of_language("files", CPP)),
    Measure("C++ Lines", 0, _of_language("code", CPP)),
    Measure("Header Files", 0, _of_language("files", HEADER)),
    Measure("Header Lines", 0, _of_language("code", HEADER)),
    Measure("Python Files", 0, _of_language("files", PYTHON)),
    Measure("Python Lines", 0, _of_language("code", PYTHON)),
    Measure("Total Files", 0, _of_language("files", CPP, HEADER, PYTHON)),
    Measure("Total Lines", 0, _of_language("code", CPP, HEADER, PYTHON)),
    Measure("Other Files", 0, _others("files")),
    Measure("Other Lines", 0, _others("code")),
)
_TIMES = (
    Measure("Processor", 1, _time("plain", "processor")),
    Measure("with TPC", 1, _time("tpc", "processor")),
    _factor("Factor", "processor"),
    Measure("Compile", 1, _time("plain", "compile")),
    Measure("with TPC", 1, _time("tpc", "compile")),
    _factor("Factor", "compile"),
    Measure("Wall", 1, _time("plain", "wall")),
    Measure("with TPC", 1, _time("tpc", "wall")),
    _factor("Factor", "wall"),
    Measure("First", 0, lambda result: result.first),
)
