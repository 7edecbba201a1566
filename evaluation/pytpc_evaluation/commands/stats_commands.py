"""The command ``stats``: the tables and figures of the thesis's study from recorded missions."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import click
from rich.console import Console
from rich.text import Text

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import InputError
from pytpc.base.wording import many, plain, plain_json
from pytpc.cli.arguments import JSON, PATH
from pytpc.cli.console import console, progress, warn
from pytpc.cli.lines import say
from pytpc.cli.options import STATIC, WINDOW, recording_of
from pytpc.cli.sources import static_for
from pytpc.static.parameters import base_key
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.stats.figure_choice import Figures
from pytpc_evaluation.stats.missions import StudyMission, load_missions
from pytpc_evaluation.stats.thesis_tables import NUMBERS, study_complaints, thesis_tables
from pytpc_evaluation.tables import Table, as_csv, as_json, as_latex, as_markdown, as_rich

_SUFFIXES = {"text": ".txt", "csv": ".csv", "markdown": ".md", "latex": ".tex", "json": ".json"}
_FIGURE_FORMATS = ("png", "svg", "pdf")
_WIDTH = 200
_BY_NUMBER = {number: name for name, number in NUMBERS.items()}


@click.command("stats")
@click.argument("paths", type=PATH, nargs=-1, required=True, metavar="MISSION...")
@STATIC
@click.option(
    "--treatments",
    type=PATH,
    metavar="DIR",
    help="Folder of treatments, for missions without a treatment.json of their own.",
)
@click.option(
    "--table",
    "names",
    type=click.Choice(["all", *NUMBERS, *NUMBERS.values()]),
    multiple=True,
    default=("all",),
    show_default=True,
    help="Write only this table, by name or number; may be repeated.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(list(_SUFFIXES)),
    default="text",
    show_default=True,
    help="Format of the tables; csv and json do not round.",
)
@JSON
@click.option(
    "-o",
    "--output",
    type=PATH,
    metavar="OUT",
    help="Write to this file; into a folder, or of several tables as CSV, a file for each table.",
)
@click.option("--figures", type=PATH, metavar="DIR", help="Draw the figures into this folder.")
@click.option(
    "--figure-format",
    "figure_formats",
    type=click.Choice(_FIGURE_FORMATS),
    multiple=True,
    default=("png",),
    show_default=True,
    help="Format of the figures; may be repeated.",
)
@click.option(
    "--state",
    "states",
    multiple=True,
    metavar="TOPIC.FIELD",
    help="Draw this field above the ranks, as /odom.pose.pose.position.x; may be repeated. By"
    " default a pose and a state are looked for.",
)
@WINDOW
def stats_command(  # noqa: PLR0917
    paths: tuple[Path, ...],
    static_source: Path | None,
    treatments: Path | None,
    names: tuple[str, ...],
    form: str,
    as_json: bool,
    output: Path | None,
    figures: Path | None,
    figure_formats: tuple[str, ...],
    states: tuple[str, ...],
    window_s: float,
) -> None:
    """Write the tables of the study (6.12 to 6.16) from recorded missions, and its figures.

    A MISSION is a folder of `pytpc record`, or any INPUT of `pytpc convert`; a folder of missions
    stands for all of them. Each mission's treatment.json says what was changed in it.
    """
    form = "json" if as_json else form
    chosen = _chosen(names)
    several = form == "csv" and len(chosen) > 1
    if several and output is None:
        raise click.UsageError("several tables as CSV: choose one by --table, or give -o FOLDER")
    folder = several or (output is not None and output.is_dir())
    missions = load_missions(paths, treatments, recording_of)
    first = missions[0]
    static = static_for(static_source, first.source, first.recording)
    _check(missions, static)
    with progress("working out tables") as advance:
        tables = thesis_tables(missions, static, chosen, advance, window_s=window_s)
    if output is None:
        _print(tables, form)
    else:
        _write(tables, form, output, folder=folder)
    if figures is not None:
        _draw(missions, static, Figures(figures, figure_formats, states, window_s))


COMMANDS: list[click.Command] = [stats_command]


def _chosen(names: Sequence[str]) -> list[str]:
    if "all" in names:
        return list(NUMBERS)
    return list(dict.fromkeys(_BY_NUMBER.get(name, name) for name in names))


def _check(missions: Sequence[StudyMission], static: StaticInfo) -> None:
    for mission in missions:
        for complaint in study_complaints(mission, static):
            warn(f"{plain(mission.name)}: {plain(complaint)}")
    known = set(static.comparisons)
    seen = {
        key for m in missions for key in (*m.recording.events.keys, *m.recording.summaries.keys)
    }
    seen |= {base_key(key) for key in seen}
    if seen and not seen & known:
        raise InputError("the static information knows none of the reports: it is of another build")


def _print(tables: Sequence[Table], form: str) -> None:
    if form == "text":
        out = console()
        for table in tables:
            _show(out, table)
    else:
        click.echo(_text_of(tables, form), nl=False)


def _write(tables: Sequence[Table], form: str, output: Path, *, folder: bool) -> None:
    if not folder:
        write_atomic(output, _text_of(tables, form).encode("utf-8", "backslashreplace"))
        say(f"{many(len(tables), 'table')}: {output}")
        return
    for table in tables:
        target = output / f"{table.label}{_SUFFIXES[form]}"
        write_atomic(target, _text_of([table], form).encode("utf-8", "backslashreplace"))
    say(f"{many(len(tables), 'table')}: {output}")


def _text_of(tables: Sequence[Table], form: str) -> str:
    if form == "json":
        items = [{**as_json(table), "thesis": NUMBERS[table.label]} for table in tables]
        return plain_json(items) + "\n"
    if form == "csv":
        return "\n".join(as_csv(table) for table in tables)
    if form == "latex":
        return "\n".join(as_latex(table) for table in tables)
    if form == "markdown":
        return "\n".join(f"## {table.title}\n\n{as_markdown(table)}" for table in tables)
    stream = io.StringIO()
    out = Console(file=stream, width=_WIDTH, color_system=None)
    for table in tables:
        _show(out, table)
    return stream.getvalue()


def _show(out: Console, table: Table) -> None:
    out.print(Text(f"{table.title} (as table {NUMBERS[table.label]})", style="bold"))
    if table.rows:
        for part in as_rich(table, out.width):
            out.print(part, highlight=False)
    else:
        out.print(Text("No mission has anything for it."))
    for note in table.notes:
        out.print(Text(plain(note)), highlight=False)
    out.print()


def _draw(missions: Sequence[StudyMission], static: StaticInfo, wanted: Figures) -> None:
    # matplotlib takes half a second to import, which tables alone need not wait for.
    from pytpc_evaluation.stats.figures import draw_study  # noqa: PLC0415

    with progress("drawing") as advance:
        drawn = draw_study(
            missions,
            static,
            wanted,
            on_progress=advance,
            on_trouble=lambda text: warn(plain(text)),
        )
    say(f"{many(len(drawn), 'figure')}: {wanted.folder}")
