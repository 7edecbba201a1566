"""Lines for the person at the terminal, beside what a command prints."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

# `pytpc run` starts each node of a launch file: rich is imported where something is shown.
if TYPE_CHECKING:
    from rich.console import Console

_shown: list[Console] = []
"""The console of the progress, or nothing before the first one."""


def progress_console() -> Console:
    """The console on standard error, on which a progress is shown; `say` prints above that."""
    if not _shown:
        from rich.console import Console  # noqa: PLC0415

        _shown.append(Console(stderr=True))
    return _shown[0]


def say(text: str) -> None:
    """Print a line on standard error, above a progress that is shown there.

    rich has replaced ``sys.stderr`` meanwhile; ``click.echo(err=True)`` does not see that, and
    would write into the line of the progress. It is the terminal that wraps a long line, and not
    rich, so that a command in it can be copied.
    """
    if _shown and hasattr(sys.stderr, "rich_proxied_file"):
        _shown[0].print(text, soft_wrap=True, markup=False, highlight=False, emoji=False)
    else:
        click.echo(text, file=sys.stderr)
