"""The command about Python's sources: ``analyse``."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import click

from pytpc.base.errors import InputError
from pytpc.base.wording import many
from pytpc.build.python_units import analyse_scripts, joined, named_beside, scripts_at
from pytpc.cli.console import found_text, progress, show_units, tell_left_out
from pytpc.cli.options import PATH
from pytpc.python_analysis.budget import SECONDS
from pytpc.python_analysis.rules_file import load_rules
from pytpc.static.static_info import StaticInfo


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
    the SOURCEs that it imports. A script that cannot be parsed is left out, with a warning.
    """
    rules = replace(load_rules(profile, own), constants=constants)
    scripts = joined(scripts_at(source, rules, sources) for source in sources)
    if not scripts.entries and not scripts.left_out:
        raise InputError("no Python node here: a script with a shebang, or a __main__", sources[0])
    with progress("analysing Python") as advance:
        analysed = analyse_scripts(scripts, rules, advance, max_seconds)
    if not analysed.units:
        others = len(analysed.left_out) - 1
        also = f" (and {many(others, 'other script')} that cannot be analysed)" if others else ""
        raise InputError(f"{analysed.left_out[0].reason}{also}")
    static = StaticInfo.of(named_beside(analysed.units, ()), left_out=analysed.left_out)
    static.save(output)
    if as_json:
        click.echo(json.dumps(static.to_json(), ensure_ascii=False))
        tell_left_out(static)
        return
    show_units(static)
    click.echo(f"{found_text(static)}: {output}")


COMMANDS: list[click.Command] = [analyse_command]
