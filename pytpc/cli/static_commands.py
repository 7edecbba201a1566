"""Commands about static information: ``collect``, ``show`` and ``export``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import click
from click.core import ParameterSource
from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from pytpc.api.building import collect
from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import dump_json
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import (
    JSON,
    NO_PYTHON,
    PATH,
    PYTHON_RULES,
    STATIC_OUTPUT,
    as_object,
)
from pytpc.cli.console import (
    console,
    found_text,
    print_json,
    progress,
    show_units,
    tell_inner_loops,
    warn_of_failed,
)
from pytpc.cli.explain_commands import print_why_not
from pytpc.cli.selecting import SELECTING, place_of
from pytpc.cli.sources import (
    SOURCES,
    SOURCES_AND_QUESTION,
    static_of,
    tell_dropped,
    warn_of_changed,
)
from pytpc.cli.viewer_options import VIEWERS, Viewers
from pytpc.conditions.cpp_conditions import lines_of
from pytpc.conditions.lookup import look_up_conditions
from pytpc.conditions.sarif import sarif_log
from pytpc.conditions.tpc_details import Details, details
from pytpc.present.page.catalogue import write_catalogue
from pytpc.python_analysis.rules_file import load_rules
from pytpc.static.explanations import Explanation, look_up, why_no_comparison
from pytpc.static.places import Tpc
from pytpc.static.selection import ORDERS, Selection, select
from pytpc.static.static_info import StaticInfo


@click.command("collect")
@click.argument("sources", type=PATH, nargs=-1, required=True, metavar="SOURCE...")
@STATIC_OUTPUT
@NO_PYTHON
@PYTHON_RULES
@click.option(
    "--constants", is_flag=True, help="Report comparisons with constants in Python nodes, too."
)
def collect_command(
    sources: tuple[Path, ...],
    *,
    output: Path,
    no_python: bool,
    python_rules: Path | None,
    constants: bool,
) -> None:
    """Merge the static information of all link units below each SOURCE into one file.

    SOURCE is a workspace, a build base, a build folder or a file of static information. Link units
    that are no longer built are left out. The Python nodes of workspaces are analysed.
    """
    rules = replace(load_rules(own=python_rules), constants=constants)
    with (
        progress("analysing Python scripts") as told,
        progress("reading static information") as read,
    ):
        collected = collect(
            sources, None if no_python else rules, on_scripts=told, on_progress=read
        )
    collected.static.save(output)
    show_units(collected.static)
    tell_dropped(collected.dropped)
    click.echo(f"{found_text(collected.static)}: {output}")
    tell_inner_loops(collected.static)


@click.command("show")
@SOURCES_AND_QUESTION
@JSON
def show_command(sources: tuple[Path, ...], question: str, as_json: bool) -> None:
    """Show everything known about a comparison, found by KEY, PARAMETER or FILE:LINE.

    The beginning of a KEY is enough. SOURCE is as for `list`. The whole condition is read from the
    source as it is compiled, which takes some seconds per file the first time.
    """
    static = static_of(sources)
    warn_of_changed(static)
    explanation = look_up(static, question)
    keys = {each.comparison.key for each in explanation.comparisons}
    tpcs = [tpc for tpc in static.tpcs if not keys.isdisjoint(each.key for each in tpc.keys)]
    found = _details(static, sorted(tpcs, key=ORDERS["distance"]))
    if as_json:
        answer = {
            "question": question,
            "comparisons": [each.to_json() for each in found],
            "why_no_comparison": why_no_comparison(explanation),
        }
        print_json(answer)
        return
    _print_all(console(), found, explanation)


@dataclass(frozen=True)
class _ExportArguments:
    sources: tuple[Path, ...]
    sarif: Path | None
    html: Path | None
    title: str
    srcroot: Path | None
    wanted: Selection
    viewers: Viewers


@click.command("export")
@SOURCES
@click.option(
    "--sarif", type=PATH, metavar="FILE", help="Write SARIF 2.1.0, for code review tools."
)
@click.option("--html", type=PATH, metavar="FILE", help="Write an HTML page, which opens offline.")
@click.option(
    "--title", default="Threshold comparisons", show_default=True, help="Title of the page."
)
@click.option(
    "--srcroot",
    type=click.Path(path_type=Path, exists=True, file_okay=False),
    help="Folder that SARIF's paths are relative to. [default: what all packages share]",
)
@SELECTING
@VIEWERS
@as_object(_ExportArguments)
def export_command(
    given: _ExportArguments,
) -> None:
    """Write the comparisons in SOURCE as SARIF or HTML, or a recording for other viewers.

    SOURCE is as for `list`, or one recording: a folder of `record`, a bag, or whatever else
    `convert` takes. Several outputs may be written at once.
    """
    is_of_static = given.sarif is not None or given.html is not None
    outputs = given.viewers.outputs
    if not is_of_static and not outputs:
        raise click.UsageError(
            "give --sarif FILE, --html FILE or both; for a recording --mcap, --foxglove,"
            " --plotjuggler, --rerun, --csv or --parquet"
        )
    if is_of_static and outputs:
        raise click.UsageError(
            f"--sarif and --html are for static information, {next(iter(outputs))} is for a"
            " recording: give them one after the other"
        )
    # It reads and judges missions, which takes longer to import than this module.
    from pytpc.cli.export_mission import export_mission, is_recording  # noqa: PLC0415

    _refuse_given(_OF_STATIC if outputs else _OF_RECORDINGS, is_of_static=is_of_static)
    if outputs:
        export_mission(given.sources, given.viewers)
        return
    for source in filter(is_recording, given.sources):
        raise click.UsageError(
            f"{source} is a recording, for --mcap, --foxglove, --plotjuggler, --rerun, --csv and"
            " --parquet; --sarif and --html need static information, such as its static.json"
        )
    static = static_of(given.sources)
    found = _details(static, select(static, given.wanted))
    if given.sarif is not None:
        write_atomic(given.sarif, dump_json(sarif_log(static, found, given.srcroot)))
        click.echo(f"{many(len(found), 'comparison')}: {given.sarif}")
    if given.html is not None:
        write_catalogue(given.html, static, found, given.title)
        click.echo(f"{many(len(found), 'comparison')}: {given.html}")
    warn_of_failed(static)


_OF_STATIC = {
    "title": "--title",
    "srcroot": "--srcroot",
    "packages": "--package",
    "parameters": "--parameter",
    "types": "--type",
    "files": "--file",
    "constants": "--constants",
    "processes": "--process",
}
_OF_RECORDINGS = {
    "static_source": "--static",
    "marks_files": "--marks",
    "references": "--reference",
    "period_s": "--period",
    "as_json": "--json",
}


def _refuse_given(options: Mapping[str, str], *, is_of_static: bool) -> None:
    """Refuse options that the other kind of SOURCE has.

    Raises:
        UsageError: one of them is given.
    """
    context = click.get_current_context()
    for name, option in options.items():
        if context.get_parameter_source(name) is ParameterSource.COMMANDLINE:
            ours, theirs = "static information", "recordings"
            if not is_of_static:
                ours, theirs = theirs, ours
            raise click.UsageError(f"{option} is for {theirs}; this export is of {ours}")


COMMANDS: list[click.Command] = [collect_command, show_command, export_command]


def _details(static: StaticInfo, tpcs: Sequence[Tpc]) -> list[Details]:
    with progress("parsing sources") as advance:
        answers = look_up_conditions(static, tpcs, advance)
    return [details(static, tpc, answers[tpc.key]) for tpc in tpcs]


def _print_all(out: Console, found: Sequence[Details], explanation: Explanation) -> None:
    for each in found:
        out.print(_card(each), highlight=False)
    if not found:
        print_why_not(out, explanation)


def _card(each: Details) -> RenderableType:
    heading = Text(plain(each.title), style="bold")
    heading.append(f"  {plain(place_of(each.tpc))}:{each.tpc.column}", style="default not bold")
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column(no_wrap=True, style="dim")
    table.add_column(overflow="fold")
    for name, cell in _facts(each):
        table.add_row(Text(name), cell)
    code = Text("\n".join(map(plain, _code(each))))
    return Group(
        heading,
        Padding(code, (0, 0, 0, 4), expand=False),
        Padding(table, (0, 0, 1, 2), expand=False),
    )


def _code(each: Details) -> list[str]:
    return list(lines_of(each.condition)) if each.condition is not None else [each.source_text]


def _facts(each: Details) -> list[tuple[str, Text]]:
    tpc = each.tpc
    facts = [
        ("Condition", _origin(each)),
        ("Compared", f"{tpc.relation} {each.nearest.name or each.title}, {each.meaning}"),
        ("Type", tpc.type),
        ("Default", ", ".join(each.shown_defaults)),
        ("Read at", ", ".join(each.reads) or "nowhere: it is a constant"),
        (
            "Exposed at",
            ", ".join(f"{at.place} ({at.topic or 'unknown topic'})" for at in each.exposed),
        ),
        ("Function", each.nearest.function),
        ("Distance", str(tpc.distance)),
    ]
    if each.across:
        facts.append(("Across", each.across))
    if each.processes:
        facts.append(("Found in", ", ".join(each.processes)))
    if each.loop_depth:
        facts.append(("Inner loops", str(each.loop_depth)))
    if each.nearest.other_thresholds:
        others = many(each.nearest.other_thresholds, "other comparison")
        facts.append(("Beside it", f"{others} with parameters in this condition"))
    lines = [(name, Text(plain(text))) for name, text in facts]
    keys = [f"{k.key}  {k.package}/{k.link_unit}, distance {k.distance}" for k in tpc.keys]
    lines.append((many(len(keys), "key"), Text("\n".join(map(plain, keys)))))
    return lines


def _origin(each: Details) -> str:
    """What kind of condition the text comes from, and where it is."""
    found = each.condition
    if found is None:
        return f"the line alone: {each.note}"
    lines = f"line {found.lineno}"
    if found.end_lineno != found.lineno:
        lines = f"lines {found.lineno} to {found.end_lineno}"
    text = f"of {found.kind}, {lines}" if found.kind != "expression" else f"an expression, {lines}"
    if found.macro is not None:
        macro = found.macro
        text += f", expanded from macro {macro.name} ({macro.file}:{macro.lineno})"
        text += f": {' '.join(macro.text.replace(chr(92), ' ').split())}"
    return f"{text}; {each.note}" if each.note else text
