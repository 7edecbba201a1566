"""The options that select comparisons, and the place of one as it is printed."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps

import click

from pytpc.cli.completion_commands import offer_parameters
from pytpc.static.places import Tpc
from pytpc.static.selection import Selection

TYPES = ("parameter", "flag", "derived", "constant")


def SELECTING(command: Callable[..., None]) -> Callable[..., None]:
    """Add the options that say which comparisons are meant; the command gets a ``Selection``."""

    names = ("packages", "parameters", "types", "files", "constants", "processes")

    @wraps(command)
    def with_selection(**given: object) -> None:
        made: Callable[..., Selection] = Selection
        wanted = made(**{name: given.pop(name) for name in names})
        command(wanted=wanted, **given)

    options = (
        click.option(
            "--package",
            "packages",
            multiple=True,
            metavar="NAME",
            help="Show only this package; may be repeated.",
        ),
        click.option(
            "--parameter",
            "parameters",
            multiple=True,
            metavar="GLOB",
            shell_complete=offer_parameters,
            help="Show only parameters like this, as in 'max_*'; the namespace may be left out.",
        ),
        click.option(
            "--type",
            "types",
            multiple=True,
            type=click.Choice(TYPES),
            help="Show only comparisons of this type; may be repeated.",
        ),
        click.option(
            "--file",
            "files",
            multiple=True,
            metavar="FILE",
            help="Show only this source file, or files like this pattern.",
        ),
        click.option("--constants", is_flag=True, help="Show comparisons with constants, too."),
        click.option(
            "--process",
            "processes",
            multiple=True,
            metavar="NAME",
            help="Show only what was found in this process; may be repeated.",
        ),
    )
    for option in reversed(options):
        with_selection = option(with_selection)
    return with_selection


def place_of(tpc: Tpc) -> str:
    """``package/src/node.cpp:12``; the absolute file where it is in no package."""
    return f"{tpc.file if tpc.place == tpc.file else f'{tpc.package}/{tpc.place}'}:{tpc.lineno}"
