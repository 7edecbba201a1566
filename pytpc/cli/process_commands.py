"""The command ``processes``: which code of a workspace runs in one process."""

from __future__ import annotations

import shlex
from pathlib import Path

import click
from rich.padding import Padding
from rich.text import Text

from pytpc.api.building import Processes, processes, write_corrections
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH
from pytpc.cli.console import console, print_json, progress, tell_next, warn
from pytpc.present.process_list import processes_as_json, processes_as_yaml, words_of


@click.command("processes")
@click.argument("workspace", type=PATH, default=Path())
@click.option("--base", type=PATH, help="Where it was built. [default: WORKSPACE/.tpc]")
@click.option(
    "--corrections",
    type=PATH,
    help="File of corrections. [default: WORKSPACE/tpc-processes.yaml, if it is there]",
)
@click.option(
    "--write", is_flag=True, help="Write what is found to WORKSPACE/tpc-processes.yaml, to edit it."
)
@JSON
def processes_command(
    workspace: Path, base: Path | None, corrections: Path | None, write: bool, as_json: bool
) -> None:
    """Show which code of WORKSPACE runs in one process: programs, their libraries and plugins.

    The plugins of a program are those that launch files and parameters name; else the defaults in
    its code; else all that it could load. A program that is started with several sets of plugins is
    several processes. To correct what is shown, use --write, and edit the file.
    """
    if write and as_json:
        raise click.UsageError("--write and --json cannot be combined")
    with progress("reading launch files") as advance:
        found = processes(workspace, base, corrections, on_progress=advance)
    for fault in found.faults:
        warn(fault)
    if as_json:
        print_json(processes_as_json(found))
    elif write:
        click.echo(f"written: {write_corrections(workspace, processes_as_yaml(found))}")
    else:
        _show(found, workspace)


COMMANDS: list[click.Command] = [processes_command]


def _show(found: Processes, workspace: Path) -> None:
    joined = [one for one in found.found if one.is_joined]
    alone = [one.name for one in found.found if not one.is_joined]
    out = console()
    for process in joined:
        units = many(len(process.units), "link unit")
        functions = many(process.functions, "function")
        out.print(Text.assemble((plain(process.name), "bold"), f": {units}, {functions}"))
        for label, words in words_of(process):
            line = Text(plain(f"{label:<8}{words}"))
            out.print(Padding(line, (0, 0, 0, 2), expand=False))
    if alone:
        words = many(len(alone), "program")
        click.echo(f"{words} without code of several analysed link units: {', '.join(alone)}")
    if not found.found:
        click.echo(f"no program was built; pytpc build {shlex.quote(str(workspace))} says more")
    for path, why in list(found.unread.items())[:1]:
        others = f" (and {len(found.unread) - 1} more)" if len(found.unread) > 1 else ""
        warn(f"{path} cannot be read{others}, so it was only searched for names: {why}")
    if joined:
        place = shlex.quote(str(workspace))
        tell_next(f"pytpc processes {place} --write, if something is wrong or missing")
