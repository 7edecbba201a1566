"""The commands of ``study fleet``: fleets of the example robots, with a wrong parameter or none."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click
from rich.table import Table
from rich.text import Text

from pytpc.base.errors import InputError, RunError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH
from pytpc.cli.console import console, print_json, progress
from pytpc.cli.lines import say
from pytpc_evaluation.commands.study_options import CHOSEN, RANK_AGAIN, RANK_JOBS, half_option
from pytpc_evaluation.commands.study_progress import StudyProgress
from pytpc_evaluation.demo.demo_examples import EXAMPLES
from pytpc_evaluation.study.fleet_causes import causes_questions, judge_causes
from pytpc_evaluation.study.fleet_flying import (
    FLIGHTS_FILE,
    load_rows,
    opened_fleets,
    row_of,
    rows_of_all,
)
from pytpc_evaluation.study.fleet_judge import (
    RESULTS_FILE,
    alone_in_questions,
    judge_alone,
    judge_fleets,
)
from pytpc_evaluation.study.fleet_plan import all_fleet_flights
from pytpc_evaluation.study.fleet_questions import (
    ASKED,
    BAD,
    DRAWS,
    GOOD,
    SHAPES,
    FleetQuestion,
    Shape,
    questions,
)
from pytpc_evaluation.study.plan import FlightSelection, check_treatments
from pytpc_evaluation.study.report.fleets import causes_table, fleet_tables
from pytpc_evaluation.study.resume import alone_with_results
from pytpc_evaluation.tables import as_markdown

_OUT = click.option(
    "--out",
    type=PATH,
    default=Path("out/fleet"),
    show_default=True,
    metavar="DIR",
    help="The folder of the fleets.",
)
_SYSTEMS = click.option(
    "--system", "systems", multiple=True, help="Only this robot; may be repeated."
)
_TREATMENTS = click.option(
    "--treatment",
    "treatments",
    multiple=True,
    help="Only the bad missions of this treatment, beside all good ones; may be repeated.",
)
_BAD = click.option(
    "--bad",
    type=click.IntRange(1, 16),
    default=BAD,
    show_default=True,
    help="How many bad missions a question has of a treatment; with less than 80 % it is left out.",
)
_GOOD = click.option(
    "--good",
    type=click.IntRange(1, 60),
    default=GOOD,
    show_default=True,
    help="How many good missions a question has.",
)


@click.group("fleet")
def fleet_group() -> None:
    """Fly fleets: three robots of each system, each with its own settings, in many missions.

    docs/reference/study-data.md describes what is flown, and the folder.
    """


@fleet_group.command("plan")
@_SYSTEMS
@_TREATMENTS
@JSON
def plan_command(*, systems: tuple[str, ...], treatments: tuple[str, ...], as_json: bool) -> None:
    """List the missions in the order in which they are flown, with what is set in each.

    For each system 60 good missions, then for each treatment ten bad ones on its three robots and
    six more on one of them.
    """
    examples = FlightSelection(systems, treatments).examples(EXAMPLES)
    check_treatments(FlightSelection(systems, treatments), examples)
    flights = all_fleet_flights(examples, treatments)
    if as_json:
        print_json([{**row_of(one, None), "settings": one.settings()} for one in flights])
        return
    table = _table("Mission", "Treatment", "Half", "Extra")
    for one in flights:
        extra = "yes" if one.is_extra else ""
        table.add_row(plain(one.name), plain(one.treatment.name), one.half or "", extra)
    console().print(table, highlight=False)


@fleet_group.command("fly")
@_SYSTEMS
@_TREATMENTS
@_OUT
@click.option(
    "--jobs",
    type=click.IntRange(1, 16),
    default=1,
    show_default=True,
    help="How many missions fly at once.",
)
@click.option(
    "--rate",
    type=click.FloatRange(min=0.1, max=1000.0),
    metavar="R",
    help="Simulated seconds in a second.  [default: that of each system]",
)
@JSON
def fly_command(
    *,
    systems: tuple[str, ...],
    treatments: tuple[str, ...],
    out: Path,
    jobs: int,
    rate: float | None,
    as_json: bool,
) -> None:
    """Build the robots and fly their missions, with people who watch them.

    What was flown with the same inputs is not flown again, so an interrupted run continues where it
    stopped. Wherever it stops, the flown missions are good ones of all robots and whole treatments.
    """
    with (
        StudyProgress("fleet") as progress,
        opened_fleets(out, systems, treatments, rate=rate, on_build=progress.building) as fleets,
    ):
        results = fleets.fly(fleets.flights, progress, jobs)
    errors = [result.error for result in results if result.error]
    _show(list(fleets.rows.values()), out, as_json=as_json)
    if errors:
        raise RunError(f"{many(len(errors), 'mission')} failed, the first: {errors[0]}")


@fleet_group.command("show")
@_OUT
@JSON
def show_command(*, out: Path, as_json: bool) -> None:
    """Show how far the flights are: by system and treatment, how many are flown and were marked."""
    _show(list(rows_of_all(out).values()), out, as_json=as_json)


@fleet_group.command("judge")
@_OUT
@half_option("both", "Ask about treatments of this half.")
@click.option(
    "--shape",
    "shapes",
    type=click.Choice(list(SHAPES)),
    multiple=True,
    help="Ask only these: bad missions of all robots, of one, or by the marks alone; may be"
    " repeated.  [default: mixed, one-robot]",
)
@click.option(
    "--draws",
    type=click.IntRange(1, 100),
    default=DRAWS,
    show_default=True,
    help="How many questions, with other missions, about each treatment.",
)
@_BAD
@_GOOD
@click.option("--alone/--no-alone", default=True, help="Also rank each bad mission by itself.")
@RANK_AGAIN
@RANK_JOBS
@JSON
def judge_command(
    *,
    out: Path,
    half: str,
    shapes: tuple[Shape, ...],
    draws: int,
    bad: int,
    good: int,
    alone: bool,
    again: bool,
    jobs: int,
    as_json: bool,
) -> None:
    """Ask the fleet's ranking about the flown missions, and show how often it is right.

    Each question has bad missions of one treatment, each marked by one observer, and good ones.
    What was ranked is kept, and ranked again only if a mission or the ranking has changed.
    """
    # Dask takes a second to import, which other commands need not wait for.
    from pytpc.api.dask_engine import engine  # noqa: PLC0415
    from pytpc_evaluation.study.fleet_product import FleetRanker, add_flown  # noqa: PLC0415

    rows = load_rows(out)
    every = questions(rows, draws, shapes or ASKED, bad, good)
    asked = [one for one in every if one.half in CHOSEN[half]]
    _check_flown(asked, out)
    with alone_with_results(out), engine(None, jobs) as workers:
        with progress("adding missions") as advance:
            said, marked = (
                add_flown(out, _rows_of(rows, asked, by_marks), workers, advance, by_marks=by_marks)
                for by_marks in (False, True)
            )
        with progress("ranking fleets") as advance:
            ranker = FleetRanker(workers, said, marked)
            verdicts = judge_fleets(out, asked, ranker, advance, again=again)
        if alone:
            with progress("ranking single missions") as advance:
                single = judge_alone(out, asked, advance, jobs=jobs)
            verdicts += alone_in_questions(asked, single)
    if as_json:
        print_json([asdict(one) for one in verdicts])
        return
    for table in fleet_tables(verdicts):
        click.echo(f"**{table.title}:**\n\n{as_markdown(table)}")
    say(f"{many(len(asked), 'question')}: {out / RESULTS_FILE}")


@fleet_group.command("causes")
@_OUT
@click.option(
    "--causes",
    type=click.IntRange(1, 8),
    default=3,
    show_default=True,
    help="How many parameters are wrong in a question, each in other missions.",
)
@click.option(
    "--draws",
    type=click.IntRange(1, 100),
    default=10,
    show_default=True,
    help="How many questions about each system.",
)
@_BAD
@_GOOD
@RANK_JOBS
@JSON
def causes_command(
    *, out: Path, causes: int, draws: int, bad: int, good: int, jobs: int, as_json: bool
) -> None:
    """Ask the fleet's ranking about fleets with several causes, and show which ones it names."""
    # Dask takes a second to import, which other commands need not wait for.
    from pytpc.api.dask_engine import engine  # noqa: PLC0415
    from pytpc_evaluation.study.fleet_product import add_flown, ranking_of  # noqa: PLC0415

    rows = load_rows(out)
    asked = list(causes_questions(rows, draws, causes, bad, good))
    _check_flown(asked, out)
    folders = {folder for one in asked for folder in one.missions}
    with alone_with_results(out), engine(None, jobs) as workers:
        with progress("adding missions") as advance:
            own = [row for row in rows if row["folder"] in folders]
            places = add_flown(out, own, workers, advance)

        def causes_of(system: str, missions: Sequence[str]) -> list[str]:
            ranking = ranking_of(out, system, [places[one] for one in missions], workers)
            return [one.parameter for one in ranking.causes]

        verdicts = []
        with progress("ranking fleets") as advance:
            for number, question in enumerate(asked, start=1):
                verdicts.append(judge_causes(question, causes_of))
                advance(number, len(asked))
    if as_json:
        print_json([asdict(one) for one in verdicts])
        return
    table = causes_table(verdicts)
    click.echo(f"**{table.title}:**\n\n{as_markdown(table)}")


def _check_flown(asked: Sequence[object], out: Path) -> None:
    """InputError where the flown missions allow no question."""
    if not asked:
        raise InputError("too few missions are flown; fly on with `pytpc study fleet fly`", out)


def _rows_of(
    rows: Sequence[dict[str, Any]], asked: Sequence[FleetQuestion], by_marks: bool
) -> list[dict[str, Any]]:
    """The rows of the missions that questions of a shape ``by-marks``, or of others, are about."""
    own = [one for one in asked if (one.shape == "by-marks") == by_marks]
    folders = {folder for one in own for folder in (*one.bad, *one.good)}
    return [row for row in rows if row["folder"] in folders]


def _show(rows: Sequence[dict[str, Any]], out: Path, *, as_json: bool) -> None:
    if as_json:
        print_json(list(rows))
        return
    table = _table("System", "Treatment", "Half", "Flown", "With errors", "Marked", "Failed")
    groups: dict[tuple[str, str, str], list[dict[str, Any]]] = {}
    for row in rows:
        group = (row["system"], row["treatment"], row["half"] or "")
        groups.setdefault(group, []).append(row)
    for (system, treatment, half), some in groups.items():
        done = [row for row in some if row["state"] == "done"]
        counts = (
            f"{len(done)} of {len(some)}",
            sum(bool(row["errors"]) for row in done),
            sum(bool(row["marks"]) for row in done),
            sum(row["state"] == "failed" for row in some),
        )
        words = (system, treatment, half, *map(str, counts))
        table.add_row(*(Text(plain(word)) for word in words))
    console().print(table, highlight=False)
    states = Counter(row["state"] for row in rows)
    click.echo(
        f"{many(len(rows), 'mission')}: {states['done']} flown, {states['failed']} failed,"
        f" {states['planned']} to fly: {out / FLIGHTS_FILE}"
    )


def _table(*headings: str) -> Table:
    table = Table()
    for heading in headings:
        table.add_column(heading, overflow="fold")
    return table
