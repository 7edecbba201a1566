"""The command ``lint``: what is wrong with a robot's parameters before it runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.linting import KINDS, SEVERITIES, Kind, Linted, Question, Severity, lint
from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import dump_json
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import print_json, progress, warn
from pytpc.cli.lines import say
from pytpc.present.findings import (
    finding_lines,
    findings_as_json,
    findings_as_sarif,
    summary_line,
    unjudged_line,
)

_KIND = click.Choice(list(KINDS))


@dataclass(frozen=True)
class _LintArguments:
    workspace: Path
    words: tuple[str, ...]
    missions: tuple[Path, ...]
    kinds: tuple[Kind, ...]
    ignored: tuple[Kind, ...]
    fail_on: Severity | None
    sarif: Path | None
    as_json: bool


@click.command("lint")
@click.argument("workspace", type=PATH)
@click.argument("words", nargs=-1, metavar="[LAUNCH|PARAMS|NODE=YAML]... [NAME:=VALUE]...")
@click.option(
    "--mission",
    "missions",
    type=PATH,
    multiple=True,
    metavar="RECORDING",
    help="A recording of this robot: find changes without effect, and thresholds that were never"
    " crossed. May be repeated.",
)
@click.option(
    "--kind", "kinds", type=_KIND, multiple=True, help="Show only this kind; may be repeated."
)
@click.option(
    "--ignore", "ignored", type=_KIND, multiple=True, help="Leave this kind out; may be repeated."
)
@click.option(
    "--fail-on",
    type=click.Choice(list(SEVERITIES)),
    help="End with status 1 if there is a finding of this severity or a worse one.",
)
@click.option(
    "--sarif", type=PATH, metavar="FILE", help="Write SARIF 2.1.0, for code review tools."
)
@JSON
@as_object(_LintArguments)
def lint_command(given: _LintArguments) -> None:
    """Show what is wrong with the parameters of a robot, before it runs.

    WORKSPACE was built by `pytpc build`. LAUNCH is a launch file, or its name in the workspace,
    read with NAME:=VALUE as roslaunch or `ros2 launch` would read it; PARAMS a params file of
    ROS 2; NODE=YAML a file that is loaded in the namespace of a node of ROS 1. Without any, all
    launch files of the workspace are checked. Nothing is started.

    A comment `tpc-lint: ignore KIND` in the line of a finding takes it back.

    \b
    pytpc lint ~/ws robot.launch
    pytpc lint ~/ws /move_base=config/planner.yaml
    pytpc lint ~/ws robot.launch --mission out/monday --mission out/tuesday
    """
    launches = [word for word in given.words if ":=" not in word]
    pairs = [word.partition(":=") for word in given.words if ":=" in word]
    kinds = frozenset(given.kinds or KINDS) - frozenset(given.ignored)
    question = Question(
        given.workspace,
        tuple(launches),
        {name: value for name, _, value in pairs},
        given.missions,
        kinds,
    )
    with progress("reading launch files") as advance:
        linted = lint(question, advance)
    if given.sarif is not None:
        write_atomic(given.sarif, dump_json(findings_as_sarif(linted.checked, given.workspace)))
    if given.as_json:
        files = {
            "files": [str(path) for path in linted.files],
            "unread": {str(path): why for path, why in sorted(linted.unread.items())},
        }
        print_json({**files, **findings_as_json(linted.checked)})
    else:
        _show(linted)
    if _fails(linted, given.fail_on):
        click.get_current_context().exit(1)


COMMANDS: list[click.Command] = [lint_command]


def _show(linted: Linted) -> None:
    here = Path.cwd()
    for one in linted.checked.findings:
        for line in finding_lines(one, here):
            click.echo(line)
    if linted.is_all:
        say(plain(f"pytpc: checked {many(len(linted.files), 'launch file')} of the workspace"))
    for path, why in list(linted.unread.items())[:1]:
        others = f" (and {len(linted.unread) - 1} more)" if len(linted.unread) > 1 else ""
        warn(f"{path} cannot be read{others}, and was not checked: {why}")
    click.echo(summary_line(linted.checked))
    if line := unjudged_line(linted.checked.unjudged):
        click.echo(line)


def _fails(linted: Linted, worst: Severity | None) -> bool:
    if worst is None:
        return False
    bad: Sequence[str] = SEVERITIES[: SEVERITIES.index(worst) + 1]
    return any(one.severity in bad for one in linted.checked.findings)
