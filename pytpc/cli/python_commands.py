"""The command about Python's sources: ``analyse``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import click

from pytpc.api.building import analyse
from pytpc.cli.arguments import CONSTANTS, JSON, PATH, STATIC_OUTPUT, as_object
from pytpc.cli.console import found_text, print_json, progress, show_units, tell_left_out
from pytpc.python_analysis.budget import SECONDS
from pytpc.python_analysis.rules_file import load_rules


@dataclass(frozen=True)
class _AnalyseArguments:
    sources: tuple[Path, ...]
    output: Path
    own: Path | None
    profile: str
    constants: bool
    max_seconds: float
    as_json: bool


@click.command("analyse")
@click.argument("sources", type=PATH, nargs=-1, required=True, metavar="SOURCE...")
@STATIC_OUTPUT
@click.option(
    "--rules",
    "own",
    type=PATH,
    metavar="FILE",
    help="JSON file with your own rules, used in addition to the built-in ones.",
)
@click.option(
    "--profile",
    type=click.Choice(["default", "thesis"]),
    default="default",
    show_default=True,
    help="What counts as exposing; thesis: only publishing and service calls.",
)
@CONSTANTS
@click.option(
    "--max-seconds",
    type=click.FloatRange(min=0),
    default=SECONDS,
    show_default=True,
    help="Stop analysing a script after this time; 0: no limit.",
)
@JSON
@as_object(_AnalyseArguments)
def analyse_command(given: _AnalyseArguments) -> None:
    """Find the comparisons of Python nodes, without ROS and without running them.

    SOURCE is a script, a package or a workspace. Each script becomes a link unit, together with the
    modules that it imports from any SOURCE. A script that cannot be parsed is left out with a
    warning.
    """
    rules = replace(load_rules(given.profile, given.own), constants=given.constants)
    with progress("analysing Python") as advance:
        static = analyse(given.sources, rules, max_seconds=given.max_seconds, on_progress=advance)
    static.save(given.output)
    if given.as_json:
        print_json(static.to_json(), indent=None)
        tell_left_out(static)
        return
    show_units(static)
    click.echo(f"{found_text(static)}: {given.output}")


COMMANDS: list[click.Command] = [analyse_command]
