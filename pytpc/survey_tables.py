"""The tables of a survey as CSV, Markdown and LaTeX (booktabs and longtable)."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence

from pytpc.survey import TreeResult
from pytpc.survey_rows import Cell, Table, tables
from pytpc.words import many, plain

FORMATS = ("csv", "markdown", "latex")
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
_STATISTIC_DIGITS = 1


def documents(results: Sequence[TreeResult], formats: Sequence[str]) -> dict[str, str]:
    """The files of a survey, text by file name.

    ``csv`` gives a file for each table and ``faults.csv``, the others one file with everything.
    """
    every = tables(results)
    found: dict[str, str] = {}
    if "csv" in formats:
        found |= {f"{table.label}.csv": as_csv(table) for table in every}
        found["faults.csv"] = _csv([("tree", "what", "name", "reason"), *faults(results)])
    if "markdown" in formats:
        found["survey.md"] = _markdown_page(every, results)
    if "latex" in formats:
        found["survey.tex"] = "\n".join(as_latex(table) for table in every)
    return found


def faults(results: Sequence[TreeResult]) -> list[tuple[str, str, str, str]]:
    """What is missing from the tables: tree, kind, name, reason; faults of TPC's first."""
    rows: list[tuple[str, str, str, str]] = []
    for result in results:
        rows += [
            (result.name, "not built with TPC", fault.package, fault.reason)
            for fault in result.broken
        ]
    for result in results:
        with_tpc = {fault.package for fault in result.tpc.not_built}
        for fault in (result.plain or result.tpc).not_built:
            lacks = f" (missing: {', '.join(fault.missing)})" if fault.missing else ""
            what = "not built" if fault.package in with_tpc else "built only with TPC"
            rows.append((result.name, what, fault.package, f"{fault.reason}{lacks}"))
        rows += [
            (result.name, "not analysed", *_named(unit.partition(": ")))
            for unit in result.found.failed
        ]
        rows += [
            (result.name, "not analysed", unit, "linked without the analysis")
            for unit in result.found.without
        ]
        if len(result.tpc.not_built) >= result.packages:
            rows.append((result.name, "no factor", "", "no package was built"))
        elif result.plain is None:
            rows.append((result.name, "no factor", "", "no plain build was asked for"))
        elif not result.comparable:
            rows.append(
                (result.name, "no factor", "", "the two builds did not build the same packages")
            )
        elif result.partial:
            built = result.packages - len(result.tpc.not_built)
            rows.append(
                (result.name, "partial", "", f"figures of {built} of {result.packages} packages")
            )
    return rows


def as_csv(table: Table) -> str:
    """A table as CSV: heading, a row a tree, and the statistics; numbers in full."""
    heading = ("name", *_distinct([column.heading for column in table.columns]))
    body = [(name, *map(_full, cells)) for name, cells in (*table.rows, *table.summary)]
    return _csv([heading, *body])


def as_markdown(table: Table) -> str:
    """A table in Markdown; the statistics are in italics."""
    headings = ["Name", *(column.heading for column in table.columns)]
    lines = [_markdown_row(headings), _markdown_row(["---", *("--:" for _ in table.columns)])]
    for name, cells in table.rows:
        lines.append(_markdown_row([_escaped(name), *map(_escaped, shown(table, cells))]))
    for name, cells in table.summary:
        texts = shown(table, cells, statistic=True)
        lines.append(_markdown_row([f"*{name}*", *map(_escaped, texts)]))
    return "\n".join(lines) + "\n"


def as_latex(table: Table) -> str:
    """A table for a LaTeX document that uses the packages booktabs and longtable."""
    heading = (
        f"{' & '.join(['Name', *(_stacked(column.heading) for column in table.columns)])} \\\\"
    )
    width = len(table.columns) + 1
    lines = [
        r"{\footnotesize\setlength{\tabcolsep}{4pt}",
        rf"\begin{{longtable}}{{l{'r' * len(table.columns)}}}",
        rf"\caption{{{latex(table.title)}}}\label{{tab:{table.label}}}\\",
        r"\toprule",
        heading,
        r"\midrule",
        r"\endfirsthead",
        r"\toprule",
        heading,
        r"\midrule",
        r"\endhead",
        rf"\midrule\multicolumn{{{width}}}{{r}}{{Continued on next page}}\\",
        r"\endfoot",
        r"\bottomrule",
        r"\endlastfoot",
    ]
    lines += [_latex_row([name, *shown(table, cells)]) for name, cells in table.rows]
    lines.append(r"\midrule")
    lines += [
        _latex_row([name, *shown(table, cells, statistic=True)]) for name, cells in table.summary
    ]
    return "\n".join([*lines, r"\end{longtable}", "}", ""])


def latex(text: str) -> str:
    """``text`` with LaTeX's own characters written so that they are printed."""
    return "".join(_LATEX.get(character, character) for character in plain(text))


def shown(table: Table, cells: Sequence[Cell], *, statistic: bool = False) -> list[str]:
    """The cells of a row as a person reads them: rounded; a dash for what is not known.

    A mean of counts has one more decimal place than the counts.
    """
    return [
        _rounded(cell, column.digits, statistic)
        for cell, column in zip(cells, table.columns, strict=True)
    ]


def _rounded(cell: Cell, digits: int, statistic: bool) -> str:
    if cell is None:
        return "-"
    if isinstance(cell, str):
        return cell
    if statistic and digits == 0 and not float(cell).is_integer():
        digits = _STATISTIC_DIGITS
    return f"{cell:.{digits}f}"


def _full(cell: Cell) -> str:
    if cell is None:
        return ""
    if isinstance(cell, float) and cell.is_integer():
        return str(int(cell))
    return str(cell)


def _distinct(headings: Sequence[str]) -> list[str]:
    """Headings that no two columns share: ``with TPC`` belongs to the column before it."""
    names: list[str] = []
    group = ""
    for heading in headings:
        if heading in ("with TPC", "Factor"):
            names.append(f"{group} {heading}".lower())
        else:
            group = heading
            names.append(heading.lower())
    return names


def _csv(rows: Sequence[Sequence[str]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def _named(parts: tuple[str, str, str]) -> tuple[str, str]:
    return parts[0], parts[2]


def _markdown_row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _escaped(text: str) -> str:
    return _MARKDOWN.sub(r"\\\1", plain(text))


def _stacked(heading: str) -> str:
    """A heading of several words, one below the other: ten columns have to stand on a page."""
    words = [latex(word) for word in heading.split()]
    return words[0] if len(words) == 1 else r"\shortstack[r]{" + r"\\".join(words) + "}"


def _latex_row(cells: Sequence[str]) -> str:
    return f"{' & '.join(map(latex, cells))} \\\\"


def _markdown_page(every: Sequence[Table], results: Sequence[TreeResult]) -> str:
    parts = [f"# Survey of {many(len(results), 'source tree')}\n"]
    parts += [f"## {table.title}\n\n{as_markdown(table)}" for table in every]
    rows = faults(results)
    if rows:
        lines = [_markdown_row(["Tree", "What", "Name", "Reason"]), _markdown_row(["---"] * 4)]
        lines += [_markdown_row([_escaped(cell) for cell in row]) for row in rows]
        parts.append("## What is missing\n\n" + "\n".join(lines) + "\n")
    return "\n".join(parts)
