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
from pytpc.pynodes.budget import SECONDS
from pytpc.pynodes.packages import Entry, NameFault, entries
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
@click.option(
    "--max-seconds",
    type=click.FloatRange(min=0),
    default=SECONDS,
    show_default=True,
    help="What the analysis of one script may take; 0: no limit.",
)
@click.option("--json", "as_json", is_flag=True, help="Print what is written, too.")
def analyse_command(
    *,
    sources: tuple[Path, ...],
    output: Path,
    own: Path | None,
    profile: str,
    constants: bool,
    max_seconds: float,
    as_json: bool,
) -> None:
    """Find the comparisons of Python nodes; no ROS is needed, and nothing is run.

    SOURCE is a script, a package or a workspace. Each script is a link unit, with the modules of
    its package that it imports. A script that cannot be parsed is left out, with a warning.
    """
    rules = replace(load_rules(profile, own), constants=constants)
    found: dict[tuple[Path, str], Entry] = {}
    told = _Once()
    for source in sources:
        for entry in entries(source, told, rules, sources):
            found[entry.script, entry.name] = entry
    if not found:
        raise InputError("no Python node here: a script with a shebang, or a __main__", sources[0])
    units: list[LinkUnit] = []
    with progress("analysing Python") as advance:
        for number, entry in enumerate(found.values(), start=1):
            try:
                units.append(analyse_entry(entry, rules, max_seconds, told))
            except InputError as error:
                if len(found) == 1:
                    raise
                told(error)
            advance(number, len(found))
    static = StaticInfo.of(_apart(units))
    static.save(output)
    if as_json:
        click.echo(json.dumps(static.to_json(), ensure_ascii=False))
        return
    show_units(static)
    click.echo(f"{found_text(static)}: {output}")


class _Once:
    """Says what is left out; the same fault once, however many scripts meet it."""

    def __init__(self) -> None:
        self._said: set[str] = set()

    def __call__(self, error: InputError) -> None:
        if str(error) not in self._said:
            self._said.add(str(error))
            warn_of(error)


def warn_of(error: InputError) -> None:
    """A script that is left out; or a package.xml that is."""
    warn(str(error) if isinstance(error, NameFault) else f"{error}; it is left out")


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
