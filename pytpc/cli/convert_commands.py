"""The command ``convert``: recordings of any format to Parquet or CSV."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from pytpc.api.missions import TOLERANCE_S, Converted, convert
from pytpc.base.wording import many
from pytpc.cli.arguments import JSON, PATH
from pytpc.cli.console import print_json, progress, tell_person
from pytpc.cli.options import warn_about
from pytpc.recording.marks import MARK_TYPES
from pytpc.recording.marks_home import is_same_mission


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
    default=TOLERANCE_S,
    show_default=True,
    metavar="SECONDS",
    help="Take reports in two inputs for the same one if they are at most this far apart.",
)
@JSON
def convert_command(
    inputs: tuple[Path, ...], output: Path, tolerance_s: float, as_json: bool
) -> None:
    """Convert the recordings of one mission to a folder of Parquet files, with each report once.

    An INPUT is a bag (ROS 1, .mcap, .db3), a binary file (.tpc), a log, console output, CSV, a
    folder of such files, or a folder that this command wrote. Its kind is recognised by its
    content. Memory use stays small however long the mission is; the disk of OUT needs 36 bytes of
    temporary space per report.
    """
    with (
        progress(f"reading {inputs[0].name}") as advance,
        progress(f"writing {output.name}") as written,
    ):
        outcome = convert(
            inputs,
            output,
            tolerance_ns=round(tolerance_s * 1e9),
            on_read=advance,
            on_written=written,
        )
    recording = outcome.recording
    warn_about(recording)
    kinds = [mark.type for mark in recording.marks]
    if as_json:
        print_json(_summary_of(outcome, output), indent=None)
        return
    marks = ", ".join(f"{kinds.count(kind)} of type {kind}" for kind in MARK_TYPES)
    if None in kinds:
        marks += f", {kinds.count(None)} without a type"
    summaries = f", {outcome.summaries:,} summaries" if outcome.summaries else ""
    click.echo(
        f"{many(outcome.events, 'report')} of {many(outcome.comparisons, 'comparison')}{summaries},"
        f" {many(len(kinds), 'mark')} ({marks}) in {recording.seconds:.1f} s: {output}"
    )
    if not any(is_same_mission(one, output) for one in inputs):
        tell_person(
            f"{output} has marks of its own from now on: what is marked in {inputs[0]} later is not"
            " in it"
        )


def _summary_of(outcome: Converted, output: Path) -> dict[str, object]:
    recording = outcome.recording
    return {
        "output": str(output),
        "mission": recording.name,
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


COMMANDS: list[click.Command] = [convert_command]
