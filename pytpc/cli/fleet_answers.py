"""What a fleet answers: ``rank``, ``drift``, ``outliers``, ``find`` and ``learn``."""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Generic, TypeVar

import click
import pyarrow as pa
import yaml
from rich.console import Console

from pytpc.api import fleet_asking as asking
from pytpc.api.dask_engine import Engine
from pytpc.api.fleet_missions import Selection, missions
from pytpc.base.columns import write_table
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, progress, tell_person
from pytpc.cli.fleet_options import (
    PARQUET,
    SelectingArguments,
    end_with_unread,
    selecting,
    store_options,
)
from pytpc.fleet.data_set import Fleet
from pytpc.fleet.store import shown_url
from pytpc.present.fleet_columns import drifts_table, found_table, outliers_table, ranking_table
from pytpc.present.fleet_json import drifts_json, found_json, outliers_json, ranking_json
from pytpc.present.fleet_page import (
    drifts_page,
    found_page,
    outliers_page,
    ranking_page,
    write_page,
)
from pytpc.present.fleet_tables import print_drifts, print_found, print_outliers, print_ranking

Answer = TypeVar("Answer")
Command = TypeVar("Command", bound=Callable[..., object])

PAGE = click.option("--page", type=PATH, metavar="FILE", help="Write a page (HTML) to this file.")
TOP = click.option(
    "--top",
    type=click.IntRange(min=1),
    default=10,
    show_default=True,
    metavar="N",
    help="Show this many rows.",
)


def answering(command: Command) -> Command:
    """The options of all questions."""
    for option in (JSON, PAGE, PARQUET, TOP):
        command = option(command)
    return selecting(store_options(command))


@dataclass(frozen=True)
class _Asked(SelectingArguments):
    top: int
    parquet: Path | None
    page: Path | None


_Ask = Callable[[Fleet, Engine, Selection, Callable[[int, int], None]], asking.Answered[Answer]]


@dataclass(frozen=True)
class _Shown(Generic[Answer]):
    """How an answer is shown: as plain data, as columns, as a page, and to a person."""

    document: Callable[[Answer], object]
    table: Callable[[Answer], pa.Table]
    page: Callable[[Answer, str], str]
    write: Callable[[Console, Answer, int], None]

    def answer(self, given: _Asked, doing: str, ask: _Ask[Answer]) -> None:
        """Ask, show the answer as it is asked for, and end with 1 if something was not read."""
        with given.engine() as own, progress(doing) as advance:
            found = ask(given.store, own, given.selection(), advance)
        if given.parquet is not None:
            write_table(self.table(found.answer), given.parquet)
        if given.page is not None:
            write_page(given.page, self.page(found.answer, shown_url(given.fleet)))
            tell_person(f"written: {given.page}")
        if given.as_json:
            print_json(self.document(found.answer))
        elif given.parquet is None and given.page is None:
            self.write(console(), found.answer, given.top)
        end_with_unread(found.unread)


RANKING = _Shown(ranking_json, ranking_table, ranking_page, print_ranking)
DRIFTS = _Shown(drifts_json, drifts_table, drifts_page, print_drifts)
OUTLIERS = _Shown(outliers_json, outliers_table, outliers_page, print_outliers)
FOUND = _Shown(found_json, found_table, found_page, print_found)


@click.command("rank")
@answering
@as_object(_Asked)
def rank_command(given: _Asked) -> None:
    """Rank the parameters by how likely each makes the bad missions go wrong, and on which robots.

    Bad missions are judged by their marks, beside good ones of their robot and of its sisters;
    values that only bad missions have, and comparisons that behave otherwise in them, count, too.
    """
    RANKING.answer(given, "judging missions", asking.rank)


@click.command("drift")
@answering
@as_object(_Asked)
def drift_command(given: _Asked) -> None:
    """Show which margins shrink from day to day, and the day on which each comparison will turn."""
    DRIFTS.answer(given, "reading missions", asking.drift)


@click.command("outliers")
@answering
@as_object(_Asked)
def outliers_command(given: _Asked) -> None:
    """Show which robots are set, or decide, otherwise than their sisters."""
    OUTLIERS.answer(given, "reading missions", asking.outliers)


@dataclass(frozen=True)
class _FindArguments(_Asked):
    where: str
    margin: float | None
    low: float
    high: float
    had: tuple[tuple[str, object], ...]


def _values(
    _context: click.Context, _option: click.Parameter, given: tuple[str, ...]
) -> tuple[tuple[str, object], ...]:
    found = []
    for text in given:
        name, equals, value = text.partition("=")
        if not equals or not name:
            raise click.BadParameter(f"{text!r} is no NAME=VALUE")
        try:
            found.append((name, yaml.safe_load(value)))
        except yaml.YAMLError as error:
            raise click.BadParameter(f"{value!r} is no value") from error
    return tuple(found)


@click.command("find")
@answering
@click.argument("where", metavar="WHERE")
@click.option("--margin", type=float, metavar="M", help="Only turns with at most this margin.")
@click.option(
    "--low",
    type=float,
    default=-math.inf,
    metavar="V",
    help="Only where this or more was compared.",
)
@click.option(
    "--high",
    type=float,
    default=math.inf,
    metavar="V",
    help="Only where this or less was compared.",
)
@click.option(
    "--had",
    multiple=True,
    callback=_values,
    metavar="NAME=VALUE",
    help="Only while this parameter had this value; may be repeated.",
)
@as_object(_FindArguments)
def find_command(given: _FindArguments) -> None:
    """Find the missions and times in which a comparison turned.

    WHERE is a parameter, a place (FILE or FILE:LINE) or a key.
    """
    query = asking.turn_query(
        given.where, within=given.margin, low=given.low, high=given.high, had=given.had
    )
    FOUND.answer(given, "looking at missions", partial(asking.find, query))


@dataclass(frozen=True)
class _LearnArguments(SelectingArguments):
    profile: Path
    most: int


@click.command("learn")
@store_options
@selecting
@click.option(
    "-o",
    "--output",
    "profile",
    type=PATH,
    default=Path("good"),
    show_default=True,
    metavar="PROFILE",
    help="Folder of the profile.",
)
@click.option(
    "--most",
    type=click.IntRange(min=1),
    default=24,
    show_default=True,
    metavar="N",
    help="Take at most so many missions.",
)
@JSON
@as_object(_LearnArguments)
def learn_command(given: _LearnArguments) -> None:
    """Put good missions of each robot into a profile, for --reference of other commands."""
    fleet = given.store
    with given.engine() as own, progress("learning missions") as advance:
        known = missions(fleet, own, given.selection("good"))
        learned = asking.learn_good(fleet, known.found, given.profile, given.most, advance)
    if given.as_json:
        print_json([one.folder for one in learned])
    else:
        click.echo(f"learned {many(len(learned), 'good mission')} into {plain(str(given.profile))}")
        where = shlex.quote(plain(str(given.profile)))
        tell_person(f"compare a mission with them: pytpc rank MISSION --reference {where}")
    end_with_unread(known.unread)


COMMANDS: list[click.Command] = [
    rank_command, drift_command, outliers_command, find_command, learn_command,
]  # fmt: skip
