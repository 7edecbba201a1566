"""Options that the commands of ``fleet`` share."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from datetime import date
from typing import TypeVar

import click

from pytpc.api.fleet_missions import Unread
from pytpc.cli.arguments import PATH
from pytpc.cli.console import warn
from pytpc.fleet.store import PATIENCE_S

Command = TypeVar("Command", bound=Callable[..., object])
_DAY = re.compile(r"\d{4}-\d\d-\d\d")
_SAID = 5


def day_given(_context: click.Context, _option: click.Parameter, value: str | None) -> str | None:
    """A day as ``2026-11-30``, or nothing; raises click.BadParameter for anything else."""
    if value is None:
        return None
    try:
        is_day = _DAY.fullmatch(value) is not None and date.fromisoformat(value) is not None
    except ValueError:
        is_day = False
    if not is_day:
        raise click.BadParameter(f"{value!r} is no day; give it as 2026-11-30")
    return value


FLEET = click.argument("fleet", metavar="FLEET")
ROBOTS = click.option("--robot", "robots", multiple=True, help="Only this robot; may be repeated.")
SINCE = click.option("--since", callback=day_given, metavar="DAY", help="Only from this day on.")
UNTIL = click.option("--until", callback=day_given, metavar="DAY", help="Only up to this day.")
BUILD = click.option("--build", metavar="HASH", help="Only of this build; its first characters.")
PARQUET = click.option("--parquet", type=PATH, metavar="FILE", help="Write the table to this file.")
CLUSTER = click.option(
    "--cluster",
    metavar="local|ADDRESS",
    help="Work in processes of this machine, or on the scheduler of Dask at this address, such as"
    " tcp://10.0.0.5:8786. [default: threads of this process]",
)
WORKERS = click.option(
    "--workers",
    type=click.IntRange(1, 1024),
    metavar="N",
    help="How many threads or processes. [default: one for each core]",
)
PATIENCE = click.option(
    "--patience",
    "patience_s",
    type=click.FloatRange(min=0.1),
    default=PATIENCE_S,
    show_default=True,
    metavar="SECONDS",
    help="How long one request to a store at a URL may take.",
)


def store_options(command: Command) -> Command:
    """The data set, and where the work on it is done."""
    for option in (PATIENCE, WORKERS, CLUSTER, FLEET):
        command = option(command)
    return command


def selecting(command: Command) -> Command:
    """Which missions are meant."""
    for option in (BUILD, UNTIL, SINCE, ROBOTS):
        command = option(command)
    return command


def tell_unread(unread: Sequence[Unread]) -> int:
    """Name the missions that cannot be read; the exit status."""
    for one in unread[:_SAID]:
        warn(f"{'/'.join(one.place)} is left out: {one.why}")
    if len(unread) > _SAID:
        warn(f"{len(unread) - _SAID:,} more missions are left out")
    return 1 if unread else 0
