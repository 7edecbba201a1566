"""The command about Python's sources: ``analyse``."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import click

from pytpc.cli.console import found_text, progress, show_units, warn
from pytpc.cli.options import PATH
from pytpc.errors import InputError
from pytpc.link_unit import LinkUnit
from pytpc.pynodes.analysis import analyse_entry
from pytpc.pynodes.packages import Entry, entries
from pytpc.pynodes.rules_file import load_rules
from pytpc.static_info import StaticInfo


@click.command("analyse")
@click.argument("sources", type=PATH, nargs=-1, required=True, metavar="SOURCE...")
@click.option("-o", "--output", type=PATH, default=Path("static.json"), show_default=True)
@click.option(
    "--rules", "own", type=PATH, metavar="FILE", help="Your own rules, beside the built-in ones."
)
@click.option(
    "--profile",
    type=click.Choice(["default", "thesis"]),
    default="default",
    show_default=True,
    help="What counts as exposing; thesis: publish and service calls alone.",
)
@click.option("--constants", is_flag=True, help="Comparisons with constants, too.")
@click.option("--json", "as_json", is_flag=True, help="Print what is written, too.")
def analyse_command(
    *,
    sources: tuple[Path, ...],
    output: Path,
    own: Path | None,
    profile: str,
    constants: bool,
    as_json: bool,
) -> None:
    """Find the comparisons of Python nodes; no ROS is needed, and nothing is run.

    SOURCE is a script, a package or a workspace. Each script is a link unit, with the modules of
    its package that it imports. A script that cannot be parsed is left out, with a warning.
    """
    rules = replace(load_rules(profile, own), constants=constants)
    found: dict[Path, Entry] = {}
    for source in sources:
        found.update({entry.script: entry for entry in entries(source, warn_of)})
    if not found:
        raise InputError("no Python node here: a script with a shebang, or a __main__", sources[0])
    units: list[LinkUnit] = []
    with progress("analysing Python") as advance:
        for number, entry in enumerate(found.values(), start=1):
            try:
                units.append(analyse_entry(entry, rules))
            except InputError as error:
                if len(found) == 1:
                    raise
                warn_of(error)
            advance(number, len(found))
    static = StaticInfo.of(_apart(units))
    static.save(output)
    if as_json:
        click.echo(json.dumps(static.to_json(), ensure_ascii=False))
        return
    show_units(static)
    click.echo(f"{found_text(static)}: {output}")


def warn_of(error: InputError) -> None:
    """A script that is left out."""
    warn(f"{error}; it is left out")


def _apart(units: list[LinkUnit]) -> list[LinkUnit]:
    """Units of scripts that are analysed together and have one name get a number."""
    count: Counter[tuple[str, str]] = Counter()
    named = []
    for unit in units:
        count[unit.package, unit.link_unit] += 1
        number = count[unit.package, unit.link_unit]
        name = unit.link_unit if number == 1 else f"{unit.link_unit}_{number}"
        named.append(replace(unit, link_unit=name))
    return named


COMMANDS: list[click.Command] = [analyse_command]
