"""Tables, progress and warnings, as all commands print them."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from threading import Timer
from typing import TYPE_CHECKING, TextIO, cast

import click
from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from pytpc.base.wording import many, plain, plain_json
from pytpc.build.reconcile import remark
from pytpc.cli.lines import progress_console, say
from pytpc.cli.selecting import place_of
from pytpc.static.loops import inner_loops
from pytpc.static.static_info import StaticInfo

if TYPE_CHECKING:
    from rich.progress import Progress
    from rich.status import Status

Advance = Callable[[int, int], None]

# Piped output has no width: a row of a table is a line, however long.
_PIPED_WIDTH = 1_000_000
# Without the first part, a long gap between columns takes the square of its length.
_FILLING = re.compile(r"(?<! ) +$", re.MULTILINE)
_SILENT_S = 2.0
_MOST_IN_LOOPS = 5


class _Trimmed:
    """Standard output without the spaces that fill the lines of a table."""

    def write(self, text: str) -> int:
        """Write what a console prints, which are whole lines."""
        return sys.stdout.write(_FILLING.sub("", text))

    def __getattr__(self, name: str) -> object:
        return getattr(sys.stdout, name)


def console() -> Console:
    """The console for tables."""
    if sys.stdout.isatty():
        return Console()
    return Console(width=_PIPED_WIDTH, file=cast(TextIO, _Trimmed()))


def waiting(console: Console, what: str) -> Status:
    """A moving sign before what is being done; of ASCII where the terminal takes no more."""
    spinner = "dots" if console.encoding.startswith("utf") else "line"
    return console.status(escape(plain(what)), spinner=spinner)


@contextmanager
def telling(what: str) -> Iterator[None]:
    """Say what is being done if it takes more than two seconds: a moving sign, or a line."""
    shown: list[Status] = []

    def show() -> None:
        console = progress_console()
        if not console.is_terminal:
            say(f"pytpc: {plain(what)}")
            return
        shown.append(waiting(console, what))
        shown[0].start()

    timer = Timer(_SILENT_S, show)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        for status in shown:
            status.stop()


def print_json(document: object, *, indent: int | None = 1) -> None:
    """Print a document as JSON on standard output; each command's ``--json`` goes through here.

    All but printable ASCII is escaped: names and notes of a robot can hold control characters,
    characters that reverse the direction of text, and halves of surrogate pairs.
    """
    click.echo(plain_json(document, indent=indent))


def table_of(
    headings: Sequence[str], rows: Iterable[Sequence[str | Text]], right: Collection[str] = ()
) -> Table:
    """A table of texts from anywhere; the columns ``right`` hold numbers, the others are folded."""
    table = Table()
    for heading in headings:
        if heading in right:
            table.add_column(heading, justify="right")
        else:
            table.add_column(heading, overflow="fold")
    for row in rows:
        table.add_row(*(cell if isinstance(cell, Text) else Text(plain(cell)) for cell in row))
    return table


def warn(text: str) -> None:
    """One line on standard error."""
    say(plain(f"pytpc: warning: {' '.join(text.split())}"))


def tell_next(command: str) -> None:
    """Say what to type next, to a person: programs that read the output get no such line."""
    if sys.stdout.isatty():
        click.echo(plain(f"next: {command}"))


def tell_person(text: str) -> None:
    """A line on standard error that a program which reads the output has no use for."""
    if sys.stdout.isatty():
        say(plain(f"pytpc: {text}"))


@contextmanager
def progress(what: str) -> Iterator[Advance]:
    """Show progress after two seconds: a bar, or lines if the output is piped."""
    console = progress_console()
    bar: Progress | None = None
    told = time.monotonic()

    def advance(done: int, total: int) -> None:
        nonlocal told, bar
        if time.monotonic() - told < _SILENT_S:
            return
        if not console.is_terminal:
            say(f"{plain(what)}: {done:,} of {total:,}")
            told = time.monotonic()
            return
        if bar is None:
            # Most commands never show one, and its module is a tenth of their start.
            from rich.progress import Progress  # noqa: PLC0415

            bar = Progress(console=console, transient=True)
            bar.add_task(escape(plain(what)), total=None)
            bar.start()
        bar.update(bar.task_ids[0], completed=done, total=total)

    try:
        yield advance
    finally:
        if bar is not None:
            bar.stop()


def show_units(static: StaticInfo) -> None:
    """Print a table with a row for each link unit, and warn of those that failed."""
    if static.units:
        console().print(_units_table(static), highlight=False)
    warn_of_failed(static)
    tell_left_out(static)


def tell_left_out(static: StaticInfo) -> None:
    """A line for each link unit that was not analysed, and for each source that does not report."""
    for left_out in static.left_out:
        text = f"{left_out.package}/{left_out.link_unit} reports nothing: {left_out.reason}"
        say(plain(text))
    for doubled in static.doubled:
        text = (
            f"{doubled.package}/{doubled.link_unit}: {many(doubled.comparisons, 'comparison')} in"
            f" {doubled.file} may not report: {doubled.runs} has the file, too, and a process that"
            " loads that first runs its functions"
        )
        say(plain(text))


def warn_of_failed(static: StaticInfo) -> None:
    """A line for each link unit that was not analysed, or not to the end."""
    for text in static.troubles:
        warn(text)


def found_text(static: StaticInfo) -> str:
    """How many comparisons with parameters there are; each place counts once."""
    count = sum(1 for tpc in static.tpcs if tpc.type != "constant")
    keys = len(static.thresholds)
    with_keys = f" ({many(keys, 'key')})" if keys != count else ""
    return f"{many(count, 'comparison')}{with_keys} in {many(len(static.units), 'link unit')}"


def tell_inner_loops(static: StaticInfo) -> None:
    """Name the deepest comparisons in inner loops, and say what reports of them cost."""
    found = inner_loops(static)
    if not found:
        return
    are = "is in an inner loop" if len(found) == 1 else "are in inner loops"
    click.echo(f"{many(len(found), 'comparison')} {are}:")
    for each in found[:_MOST_IN_LOOPS]:
        place = place_of(each.tpc)
        click.echo(plain(f"  {place}  {many(each.depth, 'loop')}  {each.tpc.parameter}"))
    if len(found) > _MOST_IN_LOOPS:
        more = len(found) - _MOST_IN_LOOPS
        click.echo(f"  and {more:,} more: `loop_depth` in `pytpc list --json`")
    click.echo(
        "With the default policy `light`, a comparison sends a summary and at most 10 changes a"
        " second (50 per process).\nTPC_POLICY=every reports each evaluation, as 32 bytes of a file"
        " or a message on /rosout: a million a second are 1.9 GB a minute."
    )


def _units_table(static: StaticInfo) -> Table:
    numbers = ("Comparisons", "Parameter reads", "Exposing statements")
    return table_of(
        ("Package", "Link unit", *numbers, "Status"),
        (
            (
                unit.package,
                unit.link_unit,
                str(unit.counts.comparisons),
                str(unit.counts.parameter_reads),
                str(unit.counts.exposing_statements),
                remark(unit),
            )
            for unit in static.units
        ),
        right=numbers,
    )
