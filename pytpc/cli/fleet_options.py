"""Options that the commands of ``fleet`` share."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from datetime import date
from typing import TypeVar

import click

from pytpc.api.dask_engine import Engine, engine
from pytpc.api.fleet_missions import Selection, Unread
from pytpc.cli.arguments import PATH
from pytpc.cli.console import warn
from pytpc.fleet.data_set import Fleet
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


@dataclass(frozen=True)
class StoreArguments:
    """What ``store_options`` give, and ``--json``."""

    fleet: str
    cluster: str | None
    workers: int | None
    patience_s: float
    as_json: bool

    @property
    def store(self) -> Fleet:
        """The data set."""
        return Fleet(self.fleet, self.patience_s)

    def engine(self) -> AbstractContextManager[Engine]:
        """Where the work is done."""
        return engine(self.cluster, self.workers)


@dataclass(frozen=True)
class SelectingArguments(StoreArguments):
    """The same with what ``selecting`` gives."""

    robots: tuple[str, ...]
    since: str | None
    until: str | None
    build: str | None

    def selection(self, verdict: str | None = None) -> Selection:
        """Which missions are meant; with a verdict, only those that went so."""
        return Selection(self.robots, self.since, self.until, verdict, self.build)


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


def end_with_unread(unread: Sequence[Unread]) -> None:
    """Name the missions that cannot be read, and end with 1 if there are some."""
    for one in unread[:_SAID]:
        warn(f"{'/'.join(one.place)} is left out: {one.why}")
    if len(unread) > _SAID:
        warn(f"{len(unread) - _SAID:,} more missions are left out")
    if unread:
        sys.exit(1)
