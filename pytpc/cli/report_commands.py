"""The command ``report``: a page with the answer and the evidence for it."""

from __future__ import annotations

import os
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.comparing import RecordedRun
from pytpc.api.missions import find_declared
from pytpc.api.report import CARDS, MissionReport, report_of, write_missions
from pytpc.base.errors import TpcError
from pytpc.base.wording import many
from pytpc.cli.arguments import JSON, PATH, REFERENCE, as_object
from pytpc.cli.console import print_json, progress
from pytpc.cli.options import (
    MARKS,
    STATIC,
    TYPES,
    WINDOW,
    AskArguments,
    asked_mission,
    good_runs,
    marks_of_one,
    offer_good_run,
    recording_of,
    warn_plainly,
)
from pytpc.cli.sources import static_for
from pytpc.diagnosis.question import PLAIN, Question
from pytpc.present.as_json import diagnosis_json, mark_json

_PAGE = "report.html"


@dataclass(frozen=True)
class _ReportArguments(AskArguments):
    recordings: tuple[Path, ...]
    references: tuple[Path, ...]
    marks_files: tuple[Path, ...]
    output: Path | None
    with_treatment: bool
    open_it: bool


@click.command("report")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@STATIC
@MARKS
@click.option(
    "-o",
    "--output",
    type=PATH,
    metavar="FILE",
    help="Write the page to this file; it needs no other file. [default: report.html, in the folder"
    " of the RECORDING if it is the only one and can be written, else here]",
)
@REFERENCE
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
@click.option(
    "--with-treatment",
    is_flag=True,
    help="For studies: show what treatment.json says was done to the robot.",
)
@click.option("--open", "open_it", is_flag=True, help="Open the page in the browser.")
@JSON
@as_object(_ReportArguments)
def report_command(given: _ReportArguments) -> None:
    """Write a page with the verdict on each RECORDING, and the evidence.

    A RECORDING is any INPUT of `convert`. If the folder of a mission contains origins.json, the
    page also says where values were set, with a command that changes them.
    """
    missions = [_mission(source, given) for source in given.recordings]
    for source in () if given.references else given.recordings:
        offer_good_run(source)
    output = given.output or page_of(given.recordings)
    draw(output, missions)
    if given.as_json:
        print_json(_json_of(output, missions))
    else:
        tell_page(output, missions)
    if given.open_it and not webbrowser.open(output.absolute().as_uri()):
        raise TpcError("no browser was found to open it", output)


COMMANDS: list[click.Command] = [report_command]


def page_of(recordings: Sequence[Path]) -> Path:
    """Where the page of these recordings goes if nothing else is asked for."""
    only = recordings[0] if len(recordings) == 1 else None
    has_room = only is not None and only.is_dir() and os.access(only, os.W_OK)
    return only / _PAGE if only is not None and has_room else Path(_PAGE)


def draw(output: Path, missions: Sequence[MissionReport]) -> None:
    """Write the page, and show the progress.

    Raises:
        TpcError: it cannot be written.
    """
    with progress("drawing") as advance:
        write_missions(output, missions, on_progress=advance)


def tell_page(output: Path, missions: Sequence[MissionReport]) -> None:
    """Say where the page is, and what is on it."""
    marks = sum(len(mission.rankings) for mission in missions)
    click.echo(f"{many(len(missions), 'mission')} with {many(marks, 'mark')}: {output}")


def _mission(source: Path, given: _ReportArguments) -> MissionReport:
    recording = recording_of(source, marks_of_one(given.marks_files, given.recordings))
    static = static_for(given.static_source, source, recording)
    declared = find_declared(static, source, warn_plainly)
    # The page lists as many suspects of all marks as `rank` does.
    top = max(given.top, PLAIN.top)
    question = Question(given.types, given.window_s, top, declared=declared)
    run, good = RecordedRun(recording, source), good_runs(given.references, static)
    asked = asked_mission(run, static, question, good)
    return report_of(
        asked.rankings,
        top=given.top,
        with_treatment=given.with_treatment,
        diagnosed=asked.diagnosis,
    )


def _diagnosis(mission: MissionReport) -> dict[str, object] | None:
    return None if mission.diagnosis is None else diagnosis_json(mission.diagnosis)


def _json_of(output: Path, missions: list[MissionReport]) -> dict[str, object]:
    return {
        "output": str(output),
        "bytes": output.stat().st_size,
        "missions": [
            {
                "mission": mission.name,
                "name": mission.name,
                "diagnosis": _diagnosis(mission),
                "marks": [
                    {
                        **mark_json(ranking.mark, mission.recording.start_ns),
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
