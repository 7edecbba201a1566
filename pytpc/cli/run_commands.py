"""The command that runs a Python node with reports: ``run``."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from pytpc.base.errors import InputError
from pytpc.cli.arguments import PATH
from pytpc.ros.node_start import command_of


@click.command("run", context_settings={"allow_interspersed_args": False})
@click.option(
    "--static",
    type=PATH,
    multiple=True,
    metavar="PATH",
    help="Static information, or a folder that contains it; may be repeated. [default: TPC_STATIC,"
    " or else that of the workspace of NODE or of this folder]",
)
@click.option(
    "--verbose",
    is_flag=True,
    help="Print which comparisons report, and the static information used.",
)
@click.argument("node", type=PATH)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[ARGUMENT]...")
def run_command(
    *, static: tuple[Path, ...], verbose: bool, node: Path, arguments: tuple[str, ...]
) -> None:
    """Run the Python script NODE so that the comparisons found by `analyse` report.

    It runs under its own interpreter and replaces this process. Anything that is not a Python
    script runs unchanged, so launch-prefix="pytpc run" can be used in a whole launch file.
    """
    command = command_of(node, arguments, static, verbose=verbose)
    sys.stdout.flush()
    sys.stderr.flush()
    try:
        os.execv(command[0], command)
    except OSError as error:
        raise InputError(f"cannot be run: {error.strerror or error}", command[0]) from error


COMMANDS: list[click.Command] = [run_command]
