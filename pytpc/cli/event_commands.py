"""The command about what was recorded: ``convert``."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import click

from pytpc.base.wording import many, plain
from pytpc.cli.console import progress, warn
from pytpc.cli.options import PATH
from pytpc.diagnosis.ranking.complaints import complaints
from pytpc.ingest import Recording
from pytpc.ingest.duplicates import TOLERANCE_NS
from pytpc.ingest.outcome import Merged
from pytpc.ingest.reading import opened
from pytpc.recording.marks import MARK_TYPES


@click.command("convert")
@click.argument("inputs", type=PATH, nargs=-1, required=True, metavar="INPUT...")
@click.option(
    "-o",
    "--output",
    type=PATH,
    required=True,
    metavar="OUT",
    help="Folder to write, or a file: .parquet (the events) or .csv (the thesis's form).",
)
@click.option(
    "--tolerance",
    "tolerance_s",
    type=click.FloatRange(min=0.0, max=60.0),
    default=TOLERANCE_NS / 1e9,
    show_default=True,
    metavar="SECONDS",
    help="Take reports in two inputs for the same one if they are at most this far apart.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the summary as JSON.")
def convert_command(
    inputs: tuple[Path, ...], output: Path, tolerance_s: float, as_json: bool
) -> None:
    """Convert the recordings of one mission to a folder of Parquet files, with each report once.

    An INPUT is a bag (ROS 1, .mcap, .db3), a binary file (.tpc), a log, console output, CSV, a
    folder of such files, or a folder that this command wrote. Its kind is recognised by its
    content. Memory use stays small however long the mission is; the disk of OUT needs 35 bytes of
    temporary space per report.
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
    for complaint in complaints(recording):
        warn(f"{plain(recording.name)}: {plain(complaint)}")
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


COMMANDS: list[click.Command] = [convert_command]


def _standing(path: Path) -> Path:
    """The nearest folder above ``path`` that is there."""
    return next((folder for folder in path.absolute().parents if folder.is_dir()), Path("/"))


def _summary_of(recording: Recording, outcome: Merged, output: Path) -> dict[str, object]:
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
