"""From a study's folder to its page: reads, works out, draws and writes."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, TypeVar

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import InputError, TpcError
from pytpc_evaluation.study.data import LABELS
from pytpc_evaluation.study.judge import POSITIONS_FILE
from pytpc_evaluation.study.plan import HALVES, Half
from pytpc_evaluation.study.report import original as thesis_tables
from pytpc_evaluation.study.report.changed import Changed, changed_in, changes_table
from pytpc_evaluation.study.report.confidence import (
    SURE_METHODS,
    accusation_counts,
    accusations_table,
    calibration,
    reliability_table,
)
from pytpc_evaluation.study.report.conversations import conversations_table
from pytpc_evaluation.study.report.drawings import Advance, Drawing, draw_results, draw_systems
from pytpc_evaluation.study.report.folder import FlownMission, FlownStudy, load_study, told
from pytpc_evaluation.study.report.headline import Headline, headlines
from pytpc_evaluation.study.report.judged import (
    HELD_BACK,
    JUDGED_FILE,
    Judging,
    load_judgings,
    told_judgings,
)
from pytpc_evaluation.study.report.judging import by_own_marks
from pytpc_evaluation.study.report.observer import observer_table
from pytpc_evaluation.study.report.original import Original
from pytpc_evaluation.study.report.other_people import marks_table, others_table, parts_with_others
from pytpc_evaluation.study.report.page import BESIDE, IMAGES, Contents, page, tables_page
from pytpc_evaluation.study.report.parts import Part, parts_of
from pytpc_evaluation.study.report.positions import Position, read_positions
from pytpc_evaluation.study.report.ranked import (
    against_table,
    grouped_table,
    groups_of,
    main_table,
    positions_table,
    result_table,
    users_table,
)
from pytpc_evaluation.study.report.repairs import (
    Repair,
    chains_in,
    read_repairs,
    repairs_summary,
    repairs_table,
    tries_table,
)
from pytpc_evaluation.study.report.sensitivity import SENSITIVITY_FILE, by_others
from pytpc_evaluation.study.report.systems import rounds_of, systems_table, treatments_table
from pytpc_evaluation.study.suggestion_chains import CHAINS_FILE, Chain, load_chains
from pytpc_evaluation.study.suggestions import HEADLINE_FILE
from pytpc_evaluation.tables import Table, as_csv, as_json

RESULTS_FILE = "results.json"
FIGURES_FILE = "figures.json"
"""What the repository keeps of ``RESULTS_FILE``."""
_TABLES_PAGE = "tables.md"
_SCHEMA = 1

Row = TypeVar("Row", Position, Repair, Chain)


@dataclass(frozen=True, eq=False)
class WrittenReport:
    """What was written: the page, the other files, and the numbers as an object for JSON."""

    page: Path
    files: tuple[Path, ...]
    numbers: dict[str, Any]
    troubles: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ReportOptions:
    """What is reported, and how.

    ``halves`` are those whose results are shown; others are not even ranked. ``rank`` lets the
    methods rank the missions that are not ranked yet, or all of ``halves`` again, in ``jobs``
    processes. ``draw``: draw the figures, which takes most of the time.
    """

    halves: Sequence[Half] = HALVES
    rank: Literal["missing", "again"] | None = None
    jobs: int = 1
    draw: bool = True


def make_report(
    folder: Path,
    target: Path,
    options: ReportOptions | None = None,
    on_progress: Callable[[str], Advance] | None = None,
) -> WrittenReport:
    """Write the page, with its figures and tables beside it.

    Args:
        folder: the study's.
        target: the page. Its figures go to ``images/study`` beside it, its tables and the numbers
            to ``study``.
        options: what is reported, and how.
        on_progress: called with what begins, gives what is called with (done, all).

    Raises:
        InputError: the folder is none of a study.
        TpcError: a file cannot be written.
    """
    asked = options or ReportOptions()
    halves = asked.halves
    progress = on_progress or (lambda _: lambda _done, _total: None)
    study = load_study(folder, progress("reading missions"))
    troubles = list(study.troubles)
    if asked.rank is not None:
        try:
            again = asked.rank == "again"
            advance = progress("ranking")
            by_own_marks().complete(folder, halves, advance, again=again, jobs=asked.jobs)
        except InputError as error:
            troubles.append(f"Not all missions are ranked: {told(error, folder)}.")
    results = _read_results(folder, study, halves, troubles)
    advance = progress("working out tables")
    originals = []
    for number, system in enumerate(study.systems, start=1):
        originals.append(Original.of(system, halves))
        advance(number, len(study.systems))
    images = target.parent / IMAGES
    drawn: list[Drawing] = []
    if asked.draw:
        drawn, undrawn = draw_systems(originals, study.systems, images, halves, progress("drawing"))
        drawn = [*draw_results(results.positions, images, results.parts), *drawn]
        # The page does not say where the folder happens to be.
        troubles += [trouble.replace(f"{folder}/", "") for trouble in undrawn]
    changed = changed_in(study.systems, progress("replaying what was changed"))
    tables, full = _tables(study, originals, results, changed)
    contents = Contents(
        changed=changed,
        rounds=rounds_of(study.systems),
        systems=[system.name for system in study.systems],
        missions=sum(len(system.flights) for system in study.systems),
        halves=halves,
        parts=results.parts,
        others=parts_with_others(results.others, results.parts),
        tables=tables,
        drawings=drawn,
        headlines=_headlines(results),
        troubles=troubles,
        remarks=[remark for system in study.systems for remark in system.remarks],
        judged=told_judgings(results.judged),
    )
    return _write(contents, full, results.judged, target)


def _write(
    contents: Contents, full: Mapping[str, Table], judged: Sequence[Judging], target: Path
) -> WrittenReport:
    """Write the page and what stands beside it, but its figures, which are drawn already."""
    figures = [one.to_json() for one in contents.headlines]
    numbers = {
        "schema": _SCHEMA,
        "figures": figures,
        "tables": {label: as_json(table) for label, table in contents.tables.items()},
        "missing": list(contents.troubles),
    }
    beside = target.parent / BESIDE
    written = [target.parent / IMAGES / drawing.file for drawing in contents.drawings]
    for name, table in full.items():
        written.append(beside / f"{name}.csv")
        write_atomic(written[-1], as_csv(table).encode())
    for name, text in (
        (RESULTS_FILE, json_text(numbers)),
        (FIGURES_FILE, _listed(figures)),
        (JUDGED_FILE.name, _listed([asdict(one) for one in judged])),
        (_TABLES_PAGE, tables_page(contents)),
    ):
        written.append(beside / name)
        write_atomic(written[-1], text.encode())
    write_atomic(target, page(contents).encode())
    return WrittenReport(target, tuple(written), numbers, tuple(contents.troubles))


@dataclass(frozen=True, eq=False)
class _Results:
    """What is shown of the results: that of ``parts``, with the missions ``flights``.

    ``judged`` is when the half that is held back was judged; empty if it is not shown.
    ``others`` are verdicts by other people's marks, of all halves; there may be none.
    """

    flights: Sequence[FlownMission]
    parts: Sequence[Part]
    positions: Sequence[Position]
    others: Sequence[Position]
    repairs: Sequence[Repair]
    chains: Sequence[Chain]
    judged: Sequence[Judging]


def _read_results(
    folder: Path, study: FlownStudy, halves: Sequence[Half], troubles: list[str]
) -> _Results:
    """What there is in the study's folder; a sentence among ``troubles`` for what is not."""
    ranked = _results(folder / POSITIONS_FILE, read_positions, troubles, "ranked")
    flights = [f for system in study.systems for f in system.flights if f.half in halves]
    repairs = _results(
        folder / HEADLINE_FILE,
        lambda path: read_repairs(path, flights),
        troubles,
        "flown again as suggested",
    )
    return _Results(
        flights=flights,
        parts=parts_of(halves, ((one.half, one.treatment.round) for one in flights)),
        positions=[row for row in ranked if row.half in halves],
        others=_others(folder, halves, troubles),
        repairs=repairs,
        chains=_results(folder / CHAINS_FILE, load_chains, troubles, "asked for suggestions"),
        judged=_judged(folder, troubles) if HELD_BACK in halves else (),
    )


def _judged(folder: Path, troubles: list[str]) -> Sequence[Judging]:
    try:
        return load_judgings(folder)
    except InputError as error:
        troubles.append(f"{JUDGED_FILE.name} is left out: {error.message}.")
        return ()


def _headlines(results: _Results) -> list[Headline]:
    return [
        one
        for part in results.parts
        for one in headlines(
            results.positions,
            results.repairs,
            chains_in(results.chains, part, results.flights),
            part,
        )
    ]


def _listed(rows: Sequence[object]) -> str:
    """A list as JSON, one object a line: what changes shows in a diff."""
    return "[\n" + ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows) + "\n]\n"


def json_text(numbers: object) -> str:
    """As it stands in ``results.json``."""
    return json.dumps(numbers, indent=1, ensure_ascii=False) + "\n"


def _tables(
    study: FlownStudy, originals: Sequence[Original], results: _Results, changed: Changed
) -> tuple[dict[str, Table], dict[str, Table]]:
    """The tables of the page by label, and those that are too long for it by their file's name."""
    systems, parts, positions = study.systems, results.parts, results.positions
    halves = [part.half for part in parts if part.round is None]
    found = [
        systems_table(systems),
        treatments_table(systems),
        thesis_tables.runtime_compared(originals),
        thesis_tables.thesis_runtime(),
        thesis_tables.confusion_compared(originals),
        thesis_tables.delays_compared(originals),
        thesis_tables.marks_compared(originals),
        thesis_tables.thesis_found(),
        *(result_table(positions, part) for part in parts),
        *(main_table(positions, part) for part in parts),
        *(against_table(positions, part) for part in parts),
        *(users_table(positions, part) for part in parts),
        *(observer_table(positions, part) for part in parts),
        *(
            made(results.others, part)
            for part in parts_with_others(results.others, parts)
            for made in (others_table, marks_table)
        ),
        *(positions_table(positions, labels) for labels in LABELS),
        *(
            reliability_table(calibration(positions, half, method), half, method)
            for half in halves
            for method in SURE_METHODS
        ),
        accusation_counts(positions, halves),
        accusations_table(positions),
        changes_table(changed, systems),
        repairs_summary(results.repairs, parts),
        tries_table(results.chains, parts, results.flights),
        conversations_table(results.chains, parts, results.flights),
        repairs_table(results.repairs),
    ]
    for heading, group in groups_of(systems).items():
        name = heading.lower().replace(" ", "-")
        found += [
            grouped_table(f"{name}-{part.name}", positions, part, heading, group) for part in parts
        ]
    tables = {table.label: table for table in found}
    full: dict[str, Table] = {}
    for one in originals:
        tables[f"{one.name}-runtime-short"] = thesis_tables.runtime_short(one.runtime)
        tables[f"{one.name}-found-compared"] = thesis_tables.found_compared(one)
        full.update({f"{one.name}-{table.label}": table for table in one.tables()})
    full.update({label: tables[label] for label in map("positions-{}".format, LABELS)})
    return tables, full


def _results(
    path: Path, read: Callable[[Path], list[Row]], troubles: list[str], what: str
) -> list[Row]:
    """The rows of a table of results; a sentence among ``troubles`` where there is none."""
    if not path.exists():
        troubles.append(f"Nothing has been {what} yet.")
        return []
    try:
        return read(path)
    except TpcError as error:
        troubles.append(f"{path.name} is left out: {error.message}.")
        return []


def _others(folder: Path, halves: Sequence[Half], troubles: list[str]) -> list[Position]:
    """By other people's marks; without them the page is whole."""
    if not (folder / SENSITIVITY_FILE).exists():
        return []
    rows = _results(folder / SENSITIVITY_FILE, read_positions, troubles, "ranked by others")
    own = {row.half for row in rows}
    try:
        current = by_others().is_complete(folder, [half for half in halves if half in own])
    except InputError:
        # What cannot be read is said already.
        return rows
    if not current:
        troubles.append("Rankings by other people's marks are out of date: `study sensitivity`.")
    return rows
