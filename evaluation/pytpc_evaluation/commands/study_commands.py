"""The commands ``study run``, ``study halves``, ``study suggested``; the group of ``study``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from pytpc.base.errors import RunError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, Command
from pytpc.cli.console import console, print_json
from pytpc_evaluation.commands.study_fleet import fleet_group
from pytpc_evaluation.commands.study_fleet_world import fleet_world_command
from pytpc_evaluation.commands.study_options import STUDY, seed_option
from pytpc_evaluation.commands.study_progress import StudyProgress
from pytpc_evaluation.commands.study_report import report_command
from pytpc_evaluation.commands.study_sensitivity import sensitivity_command
from pytpc_evaluation.commands.study_suggestions import suggestions_command
from pytpc_evaluation.demo.demo_examples import EXAMPLES
from pytpc_evaluation.study.flying import opened
from pytpc_evaluation.study.plan import Flight, FlightSelection, flights_of
from pytpc_evaluation.study.run import Result
from pytpc_evaluation.study.suggested import (
    TRIED_FILE,
    WANTED_FILE,
    load_wanted,
    not_to_be_set,
    save_tried,
    suggested_flight,
)


def _flown(command: Command) -> Command:
    jobs = click.option(
        "--jobs",
        type=click.IntRange(1, 16),
        default=1,
        show_default=True,
        help="How many missions fly at once.",
    )
    rate = click.option(
        "--rate",
        type=click.FloatRange(min=0.1, max=1000.0),
        metavar="R",
        help="Simulated seconds in a second.  [default: that of each system]",
    )
    return STUDY(jobs(rate(JSON(command))))


@click.group("study")
def study_group() -> None:
    """Fly the study: missions of the example robots with known errors, and people who watch them.

    docs/reference/study-data.md describes its folder, and how an interrupted study continues.
    """


@study_group.command("run")
@click.option("--system", "systems", multiple=True, help="Fly only this robot; may be repeated.")
@click.option(
    "--treatment", "treatments", multiple=True, help="Fly only this treatment; may be repeated."
)
@seed_option("Fly only")
@click.option("--quick", is_flag=True, help="One robot, one error of each type, one seed.")
@_flown
def run_command(
    *,
    systems: tuple[str, ...],
    treatments: tuple[str, ...],
    seeds: tuple[str, ...],
    quick: bool,
    out: Path,
    rate: float | None,
    jobs: int,
    as_json: bool,
) -> None:
    """Build the robots, fly their missions, and have people set marks.

    What was flown with the same inputs is not flown again, so an interrupted run continues where it
    stopped. A mission that fails is tried once more; if it fails again, the others go on, and the
    exit status is 1.
    """
    seed_numbers = [int(seed) for seed in seeds]
    selection = FlightSelection(systems, treatments, seed_numbers, quick=quick)
    with (
        StudyProgress("study") as progress,
        opened(out, selection, rate=rate, on_build=progress.building) as study,
    ):
        results = study.fly(study.all(), progress, jobs)
    if as_json:
        print_json([_run_json(result) for result in results])
    else:
        _show(results, out)
    _fail_where_any([result.error for result in results if result.error])


@study_group.command("suggested")
@click.argument("wanted", type=PATH, required=False)
@_flown
def suggested_command(
    *, wanted: Path | None, out: Path, rate: float | None, jobs: int, as_json: bool
) -> None:
    """Fly missions again, each with one parameter set to a suggested value; show what changed.

    WANTED is a JSON list of objects with system, treatment, seed, parameter, node and value. The
    default is results/suggestions-wanted.json in the study's folder.
    """
    suggestions = load_wanted(wanted or out / WANTED_FILE)
    selection = FlightSelection(sorted({one.system for one in suggestions}))
    if not suggestions:
        raise click.UsageError("the list is empty: there is nothing to fly")
    with (
        StudyProgress("suggestions") as progress,
        opened(out, selection, rate=rate, on_build=progress.building) as study,
    ):
        flights = [suggested_flight(one, study.flights[one.system], out) for one in suggestions]
        failures = not_to_be_set(flights)
        results = study.fly([one for one in flights if one.label not in failures], progress, jobs)
        failures |= {result.flight.label: result.error for result in results if result.error}
        rows = save_tried(flights, failures, out)
    if as_json:
        print_json(rows)
    else:
        _show_tried(rows, out)
    _fail_where_any(list(failures.values()))


@study_group.command("halves")
@JSON
def halves_command(*, as_json: bool) -> None:
    """List the missions with the half of the study that each is in: tuning or held-back.

    Within each type of treatment the names are sorted by the SHA-256 of SYSTEM/NAME and go into the
    two halves by turns. Of the clean missions the first seed is for tuning.
    """
    flights = [one for example in EXAMPLES for one in flights_of(example) if one.half]
    if as_json:
        rows = [{**_of(flight), "half": flight.half} for flight in flights]
        print_json(rows)
        return
    table = _table("System", "Treatment", "Type", "Seed", "Half")
    for flight in flights:
        table.add_row(*(plain(str(value)) for value in _of(flight).values()), flight.half)
    console().print(table, highlight=False)


study_group.add_command(report_command)
study_group.add_command(suggestions_command)
study_group.add_command(sensitivity_command)
study_group.add_command(fleet_world_command)
study_group.add_command(fleet_group)

COMMANDS: list[click.Command] = [study_group]


def _of(flight: Flight) -> dict[str, object]:
    return {
        "system": flight.example.name,
        "treatment": flight.treatment.name,
        "type": flight.treatment.type,
        "seed": flight.seed,
    }


def _run_json(result: Result) -> dict[str, object]:
    done = result.done
    return {
        "folder": result.flight.label,
        **_of(result.flight),
        "half": result.flight.half,
        "state": "failed" if done is None else "done",
        "kept": result.kept,
        "seconds": result.seconds,
        "reports": None if done is None else done.reports,
        "errors": None if done is None else done.causes,
        "marks": None if done is None else done.marks,
        "remarks": [] if done is None else list(done.remarks),
        "failure": result.error,
    }


def _show(results: Sequence[Result], out: Path) -> None:
    told = [one for one in results if one.error or (one.done is not None and one.done.remarks)]
    if told:
        table = _table("Mission", "How it went against what its treatment demands")
        for one in told:
            remarks = "" if one.done is None else "; ".join(one.done.remarks)
            table.add_row(plain(one.flight.label), Text(plain(one.error or remarks)))
        console().print(table, highlight=False)
    kept, failed = sum(one.kept for one in results), sum(bool(one.error) for one in results)
    click.echo(
        f"{many(len(results), 'mission')}: {len(results) - kept - failed} flown,"
        f" {kept} of an earlier run, {failed} failed;"
        f" {len(told) - failed} did not go as demanded: {out}"
    )


def _show_tried(rows: Sequence[dict[str, object]], out: Path) -> None:
    table = _table("Mission", "Parameter", "Value", "The error is gone", "Another one appeared")
    words = {True: "yes", False: "no", None: "-"}
    for row in rows:
        mission = f"{row['system']}/{row['treatment']}/seed-{row['seed']}"
        gone, new = (words[value] for value in (row["gone"], row["new"]))  # type: ignore[index]
        value = f"{row['value']:g}"
        cells = (mission, f"{row['node']} {row['parameter']}", value, gone, new)
        table.add_row(*(Text(plain(cell)) for cell in cells))
    console().print(table, highlight=False)
    click.echo(f"{many(len(rows), 'suggestion')}: {out / TRIED_FILE}")


def _table(*headings: str) -> Table:
    table = Table()
    for heading in headings:
        table.add_column(heading, overflow="fold")
    return table


def _fail_where_any(failures: Sequence[str]) -> None:
    if failures:
        raise RunError(f"{many(len(failures), 'mission')} failed, the first: {failures[0]}")
