"""The command that runs a Python node with reports: ``run``."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from pytpc.base.errors import InputError
from pytpc.cli.options import PATH
from pytpc.ros.node_program import command_of


@click.command("run", context_settings={"allow_interspersed_args": False})
@click.option(
    "--static",
    type=PATH,
    multiple=True,
    metavar="PATH",
    help="Static information, or a folder that has some. [default: TPC_STATIC, else that of the"
    " workspace that NODE, or this folder, lies in]",
)
@click.option("--verbose", is_flag=True, help="Say what reports, and by which static information.")
@click.argument("node", type=PATH)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[ARGUMENT]...")
def run_command(
    *, static: tuple[Path, ...], verbose: bool, node: Path, arguments: tuple[str, ...]
) -> None:
    """Run the Python script NODE; the comparisons that analyse found report.

    It runs under its own interpreter, in the place of this process. What is no Python script is run
    as it is, so that a whole launch file may have launch-prefix="pytpc run".
    """
    command = command_of(node, arguments, static, verbose=verbose)
    sys.stdout.flush()
    sys.stderr.flush()
    try:
        os.execv(command[0], command)
    except OSError as error:
        raise InputError(f"cannot be run: {error.strerror or error}", command[0]) from error


COMMANDS: list[click.Command] = [run_command]
