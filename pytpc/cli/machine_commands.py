"""Commands before a build: ``toolchain`` and ``doctor``."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table
from rich.text import Text

from pytpc.base.checked_json import check_rules
from pytpc.base.paths import cmake_file, prefix
from pytpc.base.wording import many, plain
from pytpc.workspace.doctor.finding import Finding, Severity, by_severity
from pytpc.workspace.doctor.machine import check_machine, look_at_machine
from pytpc.workspace.doctor.workspace import (
    check_workspace,
    look_at_known,
    look_at_workspace,
)
from pytpc.workspace.toolchain import Choices, Step, Way, shown, steps

_STYLES = {Severity.ERROR: "bold red", Severity.WARNING: "yellow", Severity.NOTE: "dim"}
# Piped output has no width of its own.
_PIPED_WIDTH = 160


@click.command("toolchain")
@click.argument("tool", type=click.Choice([way.value for way in Way]), required=False)
@click.option(
    "--rules",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="JSON file with your own rules: more functions that read a parameter or expose.",
)
@click.option("--profile", type=click.Choice(["default", "thesis"]), help="Rules to analyse with.")
@click.option("--constants", is_flag=True, help="Report comparisons with constants, too.")
@click.option("--json", "as_json", is_flag=True, help="Print a JSON list.")
def toolchain_command(
    *, tool: str | None, rules: Path | None, profile: str | None, constants: bool, as_json: bool
) -> None:
    """Print the commands that build with TPC by TOOL, or by each supported tool.

    Nothing is run and no file is changed; paste the commands into a shell.
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


@click.command("doctor")
@click.argument("workspace", type=click.Path(path_type=Path), required=False)
@click.option("--json", "as_json", is_flag=True, help="Print a JSON list.")
@click.pass_context
def doctor_command(ctx: click.Context, *, workspace: Path | None, as_json: bool) -> None:
    """Check this machine and WORKSPACE, and print the command that fixes each problem.

    The exit status is 1 if a problem keeps a build from working. Nothing is changed.
    """
    with Console(stderr=True).status("checking"):
        seen = None if workspace is None else look_at_workspace(workspace)
        findings = check_machine(look_at_machine(workspace or Path()))
        if workspace is not None and seen is not None:
            findings += check_workspace(seen, look_at_known(workspace))
    findings = by_severity(findings)
    if as_json:
        data = [found.to_json() for found in findings]
        click.echo(json.dumps(data, indent=1, ensure_ascii=False))
    else:
        _show_findings(findings)
    if any(found.severity is Severity.ERROR for found in findings):
        ctx.exit(1)


def _show_findings(findings: list[Finding]) -> None:
    if not findings:
        click.echo("no problems found")
        return
    table = Table()
    for heading in ("", "Problem", "Where", "Fix it with"):
        table.add_column(heading, overflow="fold")
    for found in findings:
        cells = (found.what, found.where or "", found.mend or "")
        style = _STYLES[found.severity]
        table.add_row(Text(found.severity.value, style), *(Text(plain(cell)) for cell in cells))
    Console(width=None if sys.stdout.isatty() else _PIPED_WIDTH).print(table, highlight=False)
    numbers = [
        many(count, severity.value)
        for severity in Severity
        if (count := sum(found.severity is severity for found in findings))
    ]
    click.echo(", ".join(numbers))


def _step(step: Step) -> dict[str, object]:
    return {"command": list(step.command), "purpose": step.purpose, "once": step.once}


COMMANDS: list[click.Command] = [toolchain_command, doctor_command]
