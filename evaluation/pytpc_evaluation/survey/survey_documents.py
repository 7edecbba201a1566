"""The tables of a survey as CSV, Markdown and LaTeX (booktabs and longtable)."""

from __future__ import annotations

from collections.abc import Sequence

from pytpc.base.wording import many
from pytpc_evaluation.survey.static_tables import tables
from pytpc_evaluation.survey.trees import TreeResult
from pytpc_evaluation.tables import (
    Table,
    as_csv,
    as_latex,
    as_markdown,
    csv_text,
    markdown,
    markdown_row,
)

FORMATS = ("csv", "markdown", "latex")


def documents(results: Sequence[TreeResult], formats: Sequence[str]) -> dict[str, str]:
    """The files of a survey, text by file name.

    ``csv`` gives a file for each table and ``faults.csv``, the others one file with everything.
    """
    every = tables(results)
    found: dict[str, str] = {}
    if "csv" in formats:
        found |= {f"{table.label}.csv": as_csv(table) for table in every}
        found["faults.csv"] = csv_text([("tree", "what", "name", "reason"), *faults(results)])
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


def _named(parts: tuple[str, str, str]) -> tuple[str, str]:
    return parts[0], parts[2]


def _markdown_page(every: Sequence[Table], results: Sequence[TreeResult]) -> str:
    parts = [f"# Survey of {many(len(results), 'source tree')}\n"]
    parts += [f"## {table.title}\n\n{as_markdown(table)}" for table in every]
    rows = faults(results)
    if rows:
        lines = [markdown_row(["Tree", "What", "Name", "Reason"]), markdown_row(["---"] * 4)]
        lines += [markdown_row([markdown(cell) for cell in row]) for row in rows]
        parts.append("## What is missing\n\n" + "\n".join(lines) + "\n")
    return "\n".join(parts)
