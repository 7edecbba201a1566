"""The command ``report``: a page with the answer and the evidence for it."""

from __future__ import annotations

import json
import webbrowser
from dataclasses import replace
from pathlib import Path

import click

from pytpc.api.report import CARDS, MissionReport, write_report
from pytpc.base.errors import TpcError
from pytpc.base.wording import many, plain
from pytpc.cli.console import progress, warn
from pytpc.cli.options import (
    JSON,
    PATH,
    STATIC,
    TYPES,
    WINDOW,
    check_reports,
    recording_of,
    warn_about,
)
from pytpc.cli.sources import static_of
from pytpc.diagnosis.question import Question, Types
from pytpc.diagnosis.ranking.clocks import two_clocks
from pytpc.diagnosis.ranking.ranking import rank_marks
from pytpc.recording.known_change import read_known_change
from pytpc.static.static_info import StaticInfo
from pytpc.values.declared_files import declared_in
from pytpc.values.origins import read_origins


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
    help="The page, one file that needs no other.",
)
@TYPES
@WINDOW
@click.option(
    "--top",
    type=click.IntRange(1, 20),
    default=CARDS,
    show_default=True,
    metavar="N",
    help="How many suspects of a mark are shown with their evidence.",
)
@click.option("--open", "open_it", is_flag=True, help="Show the page in the browser.")
@JSON
def report_command(
    *,
    recordings: tuple[Path, ...],
    static_source: Path,
    output: Path,
    types: Types,
    window_s: float,
    top: int,
    open_it: bool,
    as_json: bool,
) -> None:
    """Write a page with the suspects at each mark of each RECORDING, and the evidence.

    A RECORDING is any INPUT of `convert`. Where the folder of a mission also has origins.json or
    treatment.json, the page says where values came from, and what was done to the robot.
    """
    static = static_of([static_source])
    question = Question(types, window_s, top)
    missions = [_mission(source, static, question) for source in recordings]
    with progress("drawing") as advance:
        write_report(output, missions, on_progress=advance)
    if as_json:
        click.echo(json.dumps(_json_of(output, missions), indent=1, ensure_ascii=False))
    else:
        marks = sum(len(mission.rankings) for mission in missions)
        click.echo(f"{many(len(missions), 'mission')} with {many(marks, 'mark')}: {output}")
    if open_it and not webbrowser.open(output.absolute().as_uri()):
        raise TpcError("no browser was found to show it in", output)


COMMANDS: list[click.Command] = [report_command]


def _mission(source: Path, static: StaticInfo, question: Question) -> MissionReport:
    recording = recording_of(source)
    check_reports(recording, static, source)
    warn_about(recording, static)
    for clock in two_clocks(recording):
        warn(f"{plain(recording.name)}: {plain(clock)}")
    done = read_known_change(source)
    return MissionReport(
        # The bags of all missions have the same name, their folders have not.
        source.absolute().name if source.is_dir() else recording.name,
        recording,
        static,
        rank_marks(recording, static, question),
        treatment=done.effect,
        changed_parameter=done.parameter,
        origins=read_origins(source),
        question=replace(
            question, declared=declared_in(static, [source], lambda line: warn(plain(line)))
        ),
    )


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
