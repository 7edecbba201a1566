"""The command ``report``: a page with the answer and the evidence for it."""

from __future__ import annotations

import webbrowser
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.diagnosing import Rankings
from pytpc.api.missions import find_declared
from pytpc.api.report import CARDS, MissionReport, report_of, write_missions
from pytpc.base.errors import TpcError
from pytpc.base.wording import many
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import print_json, progress
from pytpc.cli.options import (
    STATIC,
    TYPES,
    WINDOW,
    AskArguments,
    checked_recording,
    warn_plainly,
)
from pytpc.cli.sources import static_of
from pytpc.diagnosis.question import Question
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True)
class _ReportArguments(AskArguments):
    recordings: tuple[Path, ...]
    output: Path
    open_it: bool


@click.command("report")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@STATIC
@click.option(
    "-o",
    "--output",
    type=PATH,
    default=Path("report.html"),
    show_default=True,
    metavar="FILE",
    help="Write the page to this file; it needs no other file.",
)
@TYPES
@WINDOW
@click.option(
    "--top",
    type=click.IntRange(1, 20),
    default=CARDS,
    show_default=True,
    metavar="N",
    help="Show the evidence for this many suspects per mark.",
)
@click.option("--open", "open_it", is_flag=True, help="Open the page in the browser.")
@JSON
@as_object(_ReportArguments)
def report_command(given: _ReportArguments) -> None:
    """Write a page with the suspects at each mark of each RECORDING, and the evidence.

    A RECORDING is any INPUT of `convert`. If the folder of a mission contains origins.json or
    treatment.json, the page also says where values came from, and what was done to the robot.
    """
    static = static_of([given.static_source])
    missions = [_mission(source, static, given) for source in given.recordings]
    output = given.output
    with progress("drawing") as advance:
        write_missions(output, missions, on_progress=advance)
    if given.as_json:
        print_json(_json_of(output, missions))
    else:
        marks = sum(len(mission.rankings) for mission in missions)
        click.echo(f"{many(len(missions), 'mission')} with {many(marks, 'mark')}: {output}")
    if given.open_it and not webbrowser.open(output.absolute().as_uri()):
        raise TpcError("no browser was found to open it", output)


COMMANDS: list[click.Command] = [report_command]


def _mission(source: Path, static: StaticInfo, given: _ReportArguments) -> MissionReport:
    recording = checked_recording(source, static)
    declared = find_declared(static, source, warn_plainly)
    question = Question(given.types, given.window_s, declared=declared)
    return report_of(Rankings.of(recording, static, question, source), top=given.top)


def _json_of(output: Path, missions: list[MissionReport]) -> dict[str, object]:
    return {
        "output": str(output),
        "bytes": output.stat().st_size,
        "missions": [
            {
                "name": mission.name,
                "marks": [
                    {
                        "seconds": (ranking.mark.time_ns - mission.recording.start_ns) / 1e9,
                        "type": ranking.mark.type,
                        "first": ranking.suspects[0].parameter if ranking.suspects else None,
                        "enough": ranking.enough,
                        "reason": ranking.reason,
                    }
                    for ranking in mission.rankings
                ],
            }
            for mission in missions
        ],
    }
