"""Commands before a build: ``toolchain`` and ``doctor``."""

from __future__ import annotations

import os
from dataclasses import asdict
from pathlib import Path

import click
from rich.text import Text

from pytpc.base.checked_json import check_rules
from pytpc.base.paths import cmake_file, prefix
from pytpc.base.wording import many
from pytpc.cli.arguments import CONSTANTS, JSON, PATH, RULES
from pytpc.cli.console import console, print_json, table_of, waiting
from pytpc.cli.lines import progress_console
from pytpc.ros.node_start import files_folder
from pytpc.ros.ros2.graph_check import check_ros2_graph
from pytpc.workspace.doctor.finding import Finding, Severity, by_severity
from pytpc.workspace.doctor.machine import check_machine, look_at_machine
from pytpc.workspace.doctor.workspace import (
    check_workspace,
    look_at_known,
    look_at_workspace,
)
from pytpc.workspace.toolchain import Choices, Way, shown, steps

_STYLES = {Severity.ERROR: "bold red", Severity.WARNING: "yellow", Severity.NOTE: "dim"}


@click.command("toolchain")
@click.argument("tool", type=click.Choice([way.value for way in Way]), required=False)
@RULES
@click.option("--profile", type=click.Choice(["default", "thesis"]), help="Rules to analyse with.")
@CONSTANTS
@JSON
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
        data = [{"tool": way.value, "steps": [asdict(step) for step in found[way]]} for way in ways]
        print_json(data)
        return
    click.echo("\n".join(shown(way, found[way]) for way in ways), nl=False)


@click.command("doctor")
@click.argument("workspace", type=PATH, required=False)
@JSON
@click.pass_context
def doctor_command(ctx: click.Context, *, workspace: Path | None, as_json: bool) -> None:
    """Check this machine and WORKSPACE, and print the command that fixes each problem.

    In a shell that names ROS 2, it also says whether its graph is reached. Nodes that keep their
    last minutes on the disk are listed. The exit status is 1 if
    a problem keeps a build from working. Nothing is changed.
    """
    # What reads files takes longer to import than the rest of this module.
    from pytpc.ros.ring_check import check_rings  # noqa: PLC0415

    with waiting(progress_console(), "checking"):
        seen = None if workspace is None else look_at_workspace(workspace)
        for_ros1 = seen is None or not seen.is_for_ros2_alone
        findings = check_machine(look_at_machine(workspace or Path()), for_ros1=for_ros1)
        findings += check_ros2_graph(os.environ)
        findings += check_rings(files_folder(os.environ))
        if workspace is not None and seen is not None:
            findings += check_workspace(seen, look_at_known(workspace))
    findings = by_severity(findings)
    if as_json:
        data = [found.to_json() for found in findings]
        print_json(data)
    else:
        _show_findings(findings)
    if any(found.severity is Severity.ERROR for found in findings):
        ctx.exit(1)


def _show_findings(findings: list[Finding]) -> None:
    if not findings:
        click.echo("no problems found")
        return
    rows = [
        (
            Text(found.severity.value, _STYLES[found.severity]),
            found.what,
            found.where or "",
            found.mend or "",
        )
        for found in findings
    ]
    console().print(table_of(("", "Problem", "Where", "Fix it with"), rows), highlight=False)
    numbers = [
        many(count, severity.value)
        for severity in Severity
        if (count := sum(found.severity is severity for found in findings))
    ]
    click.echo(", ".join(numbers))


COMMANDS: list[click.Command] = [toolchain_command, doctor_command]
