"""What several commands print alike: tables, progress, warnings."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress
from rich.table import Table
from rich.text import Text

from pytpc.base.wording import many, plain
from pytpc.build.reconcile import remark
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo

Advance = Callable[[int, int], None]

# Piped output has no width of its own; at the usual 80 columns a table would be folded to shreds.
_PIPED_WIDTH = 160
_SILENT_S = 2.0


def console() -> Console:
    """Where tables are printed."""
    return Console(width=None if sys.stdout.isatty() else _PIPED_WIDTH)


def warn(text: str) -> None:
    """One line on standard error."""
    click.echo(f"pytpc: warning: {' '.join(text.split())}", err=True)


@contextmanager
def progress(what: str) -> Iterator[Advance]:
    """Show how far something is once it has taken two seconds: a bar, or lines where piped."""
    console = Console(stderr=True)
    bar = Progress(console=console, transient=True)
    task = bar.add_task(escape(plain(what)), total=None)
    told = time.monotonic()

    def advance(done: int, total: int) -> None:
        nonlocal told
        bar.update(task, completed=done, total=total)
        if time.monotonic() - told < _SILENT_S:
            return
        if console.is_terminal:
            bar.start()
        else:
            click.echo(f"{plain(what)}: {done:,} of {total:,}", err=True)
            told = time.monotonic()

    try:
        yield advance
    finally:
        if bar.live.is_started:
            bar.stop()


def show_units(static: StaticInfo) -> None:
    """Print a table with a row for each link unit, and warn of those that failed."""
    if static.units:
        console().print(_units_table(static), highlight=False)
    warn_of_failed(static)
    tell_left_out(static)


def tell_left_out(static: StaticInfo) -> None:
    """A line for each link unit that was not analysed."""
    for left_out in static.left_out:
        text = f"{left_out.package}/{left_out.link_unit} reports nothing: {left_out.reason}"
        click.echo(plain(text), err=True)


def warn_of_failed(static: StaticInfo) -> None:
    """A line for each link unit that was not instrumented."""
    for unit in static.failed:
        warn(
            f"{unit.link_unit} of package {unit.package} is not instrumented and reports nothing:"
            f" {unit.failure}"
        )


def found_text(static: StaticInfo) -> str:
    """How many comparisons with parameters there are, in words; one place is one comparison."""
    count = sum(1 for tpc in static.tpcs if tpc.type != "constant")
    keys = len(static.thresholds)
    with_keys = f" ({many(keys, 'key')})" if keys != count else ""
    return f"{many(count, 'comparison')}{with_keys} in {many(len(static.units), 'link unit')}"


def _units_table(static: StaticInfo) -> Table:
    table = Table()
    for heading in ("Package", "Link unit"):
        table.add_column(heading, overflow="fold")
    for heading in ("Comparisons", "Parameter reads", "Exposing statements"):
        table.add_column(heading, justify="right")
    table.add_column("Status")
    for unit in static.units:
        table.add_row(Text(unit.package), Text(unit.link_unit), *_numbers(unit), remark(unit))
    return table


def _numbers(unit: LinkUnit) -> list[str]:
    counts = unit.counts
    return [
        str(number)
        for number in (counts.comparisons, counts.parameter_reads, counts.exposing_statements)
    ]
