"""Commands about what was recorded: ``ingest``, ``rank`` and ``report``."""

from __future__ import annotations

import json
from pathlib import Path

import click

from pytpc.cli.console import console, progress, warn
from pytpc.cli.sources import static_of
from pytpc.complaints import complaints
from pytpc.errors import InputError
from pytpc.ingest import Recording, load_recording, read_bag, save_recording
from pytpc.marks import MARK_TYPES
from pytpc.ranking import MarkRanking, rank_marks, unknown_keys
from pytpc.report.html import MissionReport, write_report
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


@click.command("ingest")
@click.argument("bag", type=_PATH)
@click.option("-o", "--output", type=_PATH, required=True, help="Folder for the two files.")
def ingest_command(bag: Path, output: Path) -> None:
    """Read a ROS 1 bag into events.parquet and marks.json."""
    with progress(f"reading {bag.name}") as advance:
        recording = read_bag(bag, advance)
    save_recording(recording, output)
    _warn_about(recording, None)
    kinds = [mark.type for mark in recording.marks]
    marks = ", ".join(f"{kinds.count(kind)} of type {kind}" for kind in MARK_TYPES)
    click.echo(
        f"{many(len(recording.events), 'report')} of"
        f" {many(len(recording.events.keys), 'comparison')}, {many(len(kinds), 'mark')} ({marks})"
        f" in {recording.seconds:.1f} s: {output}"
    )


@click.command("rank")
@click.argument("bag", type=_PATH)
@_STATIC
@click.option("--top", type=click.IntRange(min=1), default=5, show_default=True, metavar="N")
@click.option("--json", "as_json", is_flag=True, help="Print a JSON list with one item a mark.")
@_UNTYPED
def rank_command(bag: Path, static_source: Path, top: int, as_json: bool, untyped: bool) -> None:
    """Name the suspected parameters at each mark in BAG (a bag, or a folder from `ingest`)."""
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


COMMANDS: list[click.Command] = [ingest_command, rank_command, report_command]


def _recording(source: Path) -> Recording:
    if source.is_dir():
        return load_recording(source)
    with progress(f"reading {source.name}") as advance:
        return read_bag(source, advance)


def _check_reports(recording: Recording, static: StaticInfo, source: Path) -> None:
    """A mission without a report that we know would be ranked as if nothing were suspicious."""
    if not len(recording.events):
        raise InputError(
            "no threshold reports: was /rosout recorded, and the workspace built with TPC?", source
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
