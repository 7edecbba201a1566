"""Commands about what was recorded: ``convert`` (``ingest``), ``rank`` and ``report``."""

from __future__ import annotations

import json
from copy import copy
from dataclasses import asdict
from pathlib import Path

import click

from pytpc.cli.console import console, progress, warn
from pytpc.cli.sources import static_of
from pytpc.complaints import complaints
from pytpc.errors import InputError
from pytpc.ingest import Recording, read
from pytpc.ingest.duplicates import TOLERANCE_NS
from pytpc.ingest.outcome import Outcome
from pytpc.ingest.reading import opened
from pytpc.marks import MARK_TYPES
from pytpc.report.html import MissionReport, write_report
from pytpc.scoring.ranking import MarkRanking, rank_marks, unknown_keys
from pytpc.static_info import StaticInfo
from pytpc.terminal import Row, print_rankings, rows_of
from pytpc.words import many, plain

_PATH = click.Path(path_type=Path)
_STATIC = click.option(
    "--static",
    "static_source",
    type=_PATH,
    required=True,
    metavar="FILE_OR_FOLDER",
    help="static.json, a build base or a built workspace.",
)
_UNTYPED = click.option(
    "--untyped", is_flag=True, help="Do not believe the marks' types: rank by both."
)


@click.command("convert")
@click.argument("inputs", type=_PATH, nargs=-1, required=True, metavar="INPUT...")
@click.option(
    "-o",
    "--output",
    type=_PATH,
    required=True,
    metavar="OUT",
    help="A folder, or a file: .parquet (the events), .csv (the events in the thesis's form).",
)
@click.option(
    "--tolerance",
    "tolerance_s",
    type=click.FloatRange(min=0.0, max=60.0),
    default=TOLERANCE_NS / 1e9,
    show_default=True,
    metavar="SECONDS",
    help="How far apart in time one report may be in two inputs.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the summary as JSON.")
def convert_command(
    inputs: tuple[Path, ...], output: Path, tolerance_s: float, as_json: bool
) -> None:
    """Read recordings of one mission into a folder of Parquet, each report once.

    An INPUT is a bag (ROS 1, .mcap, .db3), a binary file (.tpc), a log, console output, CSV, a
    folder of such files, or a folder that this command wrote; what it is, its content tells. Memory
    stays small however long the mission is; the folder above OUT needs room for 35 bytes a report.
    """
    suffix = output.suffix if not output.is_dir() else ""
    with progress(f"reading {inputs[0].name}") as advance:
        exits = opened(inputs, _standing(output), advance, tolerance_ns=round(tolerance_s * 1e9))
        with exits as outcome, progress(f"writing {output.name}") as written:
            if suffix == ".parquet":
                recording = outcome.save_parquet(output, written)
            elif suffix == ".csv":
                recording = outcome.save_csv(output, written)
            else:
                recording = outcome.save(output, written)
    _warn_about(recording, None)
    kinds = [mark.type for mark in recording.marks]
    if as_json:
        click.echo(json.dumps(_summary_of(recording, outcome, output), ensure_ascii=False))
        return
    marks = ", ".join(f"{kinds.count(kind)} of type {kind}" for kind in MARK_TYPES)
    if None in kinds:
        marks += f", {kinds.count(None)} without a type"
    summaries = f", {outcome.summaries:,} summaries" if outcome.summaries else ""
    click.echo(
        f"{many(outcome.events, 'report')} of {many(outcome.comparisons, 'comparison')}{summaries},"
        f" {many(len(kinds), 'mark')} ({marks}) in {recording.seconds:.1f} s: {output}"
    )


# Its name from when it read bags of ROS 1 alone.
ingest_command = copy(convert_command)
ingest_command.name = "ingest"


@click.command("rank")
@click.argument("bag", type=_PATH)
@_STATIC
@click.option("--top", type=click.IntRange(min=1), default=5, show_default=True, metavar="N")
@click.option("--json", "as_json", is_flag=True, help="Print a JSON list with one item a mark.")
@_UNTYPED
def rank_command(bag: Path, static_source: Path, top: int, as_json: bool, untyped: bool) -> None:
    """Name the suspected parameters at each mark in BAG (any INPUT of `convert`)."""
    static = static_of([static_source])
    recording = _recording(bag)
    if not recording.marks:
        raise InputError("no marks: nobody said on /mark_action or /mark_no_action what", bag)
    _check_reports(recording, static, bag)
    rankings = rank_marks(recording, static, untyped=untyped)
    _warn_about(recording, static)
    if as_json:
        items = [
            _json_of(ranking, recording, rows_of(ranking, recording, static, top))
            for ranking in rankings
        ]
        click.echo(json.dumps(items, indent=1, ensure_ascii=False))
        return
    print_rankings(console(), recording, static, rankings, top)


@click.command("report")
@click.argument("bags", type=_PATH, nargs=-1, required=True, metavar="BAG...")
@_STATIC
@click.option("-o", "--output", type=_PATH, default=Path("report.html"), show_default=True)
@_UNTYPED
def report_command(
    bags: tuple[Path, ...], static_source: Path, output: Path, untyped: bool
) -> None:
    """Write a page with the suspects at each mark of each BAG, and the evidence."""
    static = static_of([static_source])
    missions = []
    for bag in bags:
        recording = _recording(bag)
        _check_reports(recording, static, bag)
        _warn_about(recording, static)
        rankings = rank_marks(recording, static, untyped=untyped)
        missions.append(MissionReport(recording.name, recording, static, rankings))
    with progress("drawing") as advance:
        write_report(output, missions, on_progress=advance)
    marks = sum(len(mission.rankings) for mission in missions)
    click.echo(f"{many(len(missions), 'mission')} with {many(marks, 'mark')}: {output}")


COMMANDS: list[click.Command] = [convert_command, ingest_command, rank_command, report_command]


def _recording(source: Path) -> Recording:
    with progress(f"reading {source.name}") as advance:
        return read(source, advance)


def _standing(path: Path) -> Path:
    """The nearest folder above ``path`` that is there."""
    return next((folder for folder in path.absolute().parents if folder.is_dir()), Path("/"))


def _summary_of(recording: Recording, outcome: Outcome, output: Path) -> dict[str, object]:
    return {
        "output": str(output),
        "name": recording.name,
        "reports": outcome.events,
        "comparisons": outcome.comparisons,
        "summaries": outcome.summaries,
        "marks": len(recording.marks),
        "start_ns": recording.start_ns,
        "end_ns": recording.end_ns,
        "malformed": recording.malformed,
        "lost": recording.lost,
        "dropped": [asdict(dropped) for dropped in recording.dropped],
        "notes": list(recording.notes),
    }


def _check_reports(recording: Recording, static: StaticInfo, source: Path) -> None:
    """A mission without a report that we know would be ranked as if nothing were suspicious."""
    if not len(recording.events):
        raise InputError(
            "no threshold reports: was /rosout recorded, and the workspace built with TPC? "
            " Files of the sink `file` have to be in the same folder, or in its tpc",
            source,
        )
    if len(unknown_keys(recording.events, static)) == len(recording.events.keys):
        raise InputError(
            "none of its reports is known to the static information: it is of another build",
            source,
        )


def _warn_about(recording: Recording, static: StaticInfo | None) -> None:
    for complaint in complaints(recording, static):
        warn(f"{plain(recording.name)}: {plain(complaint)}")


def _json_of(ranking: MarkRanking, recording: Recording, rows: list[Row]) -> dict[str, object]:
    mark = ranking.mark
    return {
        "mission": recording.name,
        "time_ns": mark.time_ns,
        "seconds": (mark.time_ns - recording.start_ns) / 1e9,
        "type": mark.type,
        "observer": mark.observer,
        "parameters": ranking.parameters,
        "suspects": [
            {
                "position": row.suspect.position,
                "parameter": row.suspect.parameter,
                "key": row.suspect.key,
                "score": row.suspect.score,
                "rank": row.suspect.rank,
                "score_type": row.suspect.type,
                "current": _finite(row.advice.current),
                "direction": row.advice.direction,
                "value": _finite(row.advice.value),
                "boundary": _finite(row.advice.boundary),
                "inclusive": row.advice.inclusive,
                "suggestion": row.advice.text,
                "file": row.suspect.comparison.file,
                "lineno": row.suspect.comparison.lineno,
                "source_code": row.suspect.comparison.source_code,
                "topic": row.suspect.comparison.topic,
                "node": row.suspect.last.node,
            }
            for row in rows
        ],
    }


def _finite(value: float | None) -> float | None:
    """JSON has neither NaN nor infinity."""
    return value if value is None or abs(value) < float("inf") else None
