"""Commands about the machine and before a build: ``toolchain``."""

from __future__ import annotations

import json
from pathlib import Path

import click

from pytpc.paths import cmake_file, prefix
from pytpc.rules import check_rules
from pytpc.toolchain import Choices, Step, Way, shown, steps


@click.command("toolchain")
@click.argument("tool", type=click.Choice([way.value for way in Way]), required=False)
@click.option(
    "--rules",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Your own rules (JSON): what else reads a parameter or exposes.",
)
@click.option("--profile", type=click.Choice(["default", "thesis"]), help="Profile of the rules.")
@click.option("--constants", is_flag=True, help="Report comparisons with constants, too.")
@click.option("--json", "as_json", is_flag=True, help="Print a JSON list.")
def toolchain_command(
    *, tool: str | None, rules: Path | None, profile: str | None, constants: bool, as_json: bool
) -> None:
    """Print what to type to build with TPC by TOOL, or by each of them.

    Nothing is run and no file is changed; the commands can be pasted into a shell.
    """
    cmake_file()
    if rules is not None:
        check_rules(rules)
    choices = Choices(rules, profile, constants)
    ways = list(Way) if tool is None else [Way(tool)]
    found = {way: steps(way, prefix(), choices) for way in ways}
    if as_json:
        data = [{"tool": way.value, "steps": [_step(step) for step in found[way]]} for way in ways]
        click.echo(json.dumps(data, indent=1, ensure_ascii=False))
        return
    click.echo("\n".join(shown(way, found[way]) for way in ways), nl=False)


def _step(step: Step) -> dict[str, object]:
    return {"command": list(step.command), "purpose": step.purpose, "once": step.once}


COMMANDS: list[click.Command] = [toolchain_command]
