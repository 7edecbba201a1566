"""The command ``list``. It imports little: with 10,000 comparisons it answers within a second."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click

from pytpc.base.collector import without_collector
from pytpc.cli.arguments import JSON
from pytpc.cli.console import console, found_text, print_json, warn_of_failed
from pytpc.cli.long_table import print_table
from pytpc.cli.selecting import SELECTING, place_of
from pytpc.cli.sources import SOURCES, static_of
from pytpc.static.across import processes_of, units_of
from pytpc.static.places import Tpc
from pytpc.static.selection import ORDERS, Selection, select
from pytpc.static.static_info import StaticInfo


@click.command("list")
@SOURCES
@JSON
@SELECTING
@click.option(
    "--sort",
    "order",
    type=click.Choice(list(ORDERS)),
    default="place",
    show_default=True,
    help="Sort the rows by this.",
)
def list_command(
    sources: tuple[Path, ...], *, as_json: bool, order: str, wanted: Selection
) -> None:
    """List the comparisons in SOURCE: a static.json, a build base or a workspace.

    Each place in the source is one row, however many link units contain it. Without SOURCE,
    static.json in this folder is read, or else what `pytpc build` left below it.
    """
    with without_collector():
        _list(sources, replace(wanted, order=order), as_json=as_json)


def _list(sources: tuple[Path, ...], wanted: Selection, *, as_json: bool) -> None:
    static = static_of(sources)
    found = select(static, wanted)
    if as_json:
        listed = [_listed(static, tpc) for tpc in found]
        print_json(listed)
        return
    _print_table(static, found)
    warn_of_failed(static)
    constants = sum(1 for tpc in found if tpc.type == "constant")
    shown, there = len(found) - constants, len(select(static, Selection()))
    some = f"{shown:,} shown of " if shown != there else ""
    more = f"; and {constants:,} with constants" if constants else ""
    click.echo(some + found_text(static) + more)


COMMANDS: list[click.Command] = [list_command]


def _listed(static: StaticInfo, tpc: Tpc) -> dict[str, object]:
    """A place in the source: its comparison nearest to an exposing statement, and all its keys."""
    unit = static.unit_of(tpc.key)
    return {
        "package": unit.package,
        "link_unit": unit.link_unit,
        **static.comparisons[tpc.key].to_json(),
        "absolute_file": tpc.file,
        "keys": tpc.to_json()["keys"],
        "processes": processes_of(static, tpc),
        "units": units_of(static.comparisons[tpc.key].path),
    }


def _print_table(static: StaticInfo, tpcs: Sequence[Tpc]) -> None:
    several = any(len(tpc.keys) > 1 for tpc in tpcs)
    of_process = [processes_of(static, tpc) for tpc in tpcs]
    across = [units_of(static.comparisons[tpc.key].path) for tpc in tpcs]
    in_processes, over_units = any(of_process), any(len(units) > 1 for units in across)
    rows = []
    for tpc, processes, units in zip(tpcs, of_process, across, strict=True):
        found = static.comparisons[tpc.key]
        line = found.source_code or f"{found.relation} {found.name or found.source}"
        cells = [tpc.parameter or "", tpc.type, place_of(tpc), str(tpc.distance)]
        if several:
            cells.append(str(len(tpc.link_units)) if len(tpc.keys) > 1 else "")
        if in_processes:
            cells.append(_first(processes))
        if over_units:
            cells.append(f"{len(units)} units" if len(units) > 1 else "")
        rows.append([*cells, found.topic or "?", line])
    some = {"Units": several, "Process": in_processes, "Across": over_units}
    optional = [heading for heading, is_shown in some.items() if is_shown]
    headings = ("Parameter", "Type", "Place", "Distance", *optional, "Exposed as", "Source line")
    print_table(console(), headings, rows, right=("Distance", "Units"))


def _first(names: Sequence[str]) -> str:
    others = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return f"{names[0]}{others}" if names else ""
