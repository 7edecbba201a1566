"""The command ``fleet``: the data set of a fleet's missions, and what it answers."""

from __future__ import annotations

import shlex
import sys
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from pytpc.api.fleet_adding import KEEPS, VERDICTS, Added, AddOptions, Keep, Verdict, add
from pytpc.api.fleet_given import missions_at
from pytpc.api.fleet_missions import (
    EVERY,
    FleetMission,
    Missions,
    meant,
    missions,
    table_of,
    write_folder,
)
from pytpc.base.columns import write_table
from pytpc.base.errors import InputError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, progress, tell_next, warn
from pytpc.cli.console import table_of as text_table
from pytpc.cli.fleet_answers import COMMANDS as ANSWERS
from pytpc.cli.fleet_options import (
    PARQUET,
    SelectingArguments,
    StoreArguments,
    day_given,
    end_with_unread,
    selecting,
    store_options,
)
from pytpc.cli.lines import say
from pytpc.fleet.data_set import Fleet
from pytpc.fleet.store import shown_url

_UNITS = ("B", "kB", "MB", "GB", "TB")


@click.group("fleet")
def fleet_command() -> None:
    """Keep the missions of many robots, and ask all of them at once.

    FLEET is a folder, or a URL that fsspec knows, such as s3://bucket/fleet. Missions are Parquet
    tables in it, by robot, day and mission, that other tools read, too.
    """


@dataclass(frozen=True)
class _AddArguments(StoreArguments):
    paths: tuple[Path, ...]
    robot: str | None
    day: str | None
    static_source: Path | None
    keep: Keep
    verdict: Verdict | None
    again: bool


@fleet_command.command("add")
@store_options
@click.argument("paths", type=PATH, nargs=-1, required=True, metavar="PATH...")
@click.option(
    "--robot",
    metavar="NAME",
    help="The robot. [default: the first folder below PATH that has missions, else PATH's name]",
)
@click.option(
    "--day", callback=day_given, metavar="DAY", help="The day. [default: by their clocks]"
)
@click.option(
    "--static",
    "static_source",
    type=PATH,
    metavar="FILE_OR_FOLDER",
    help="Static information of their build. [default: that of each mission]",
)
@click.option(
    "--keep",
    type=click.Choice(KEEPS),
    default="edges",
    show_default=True,
    help="Keep first evaluations and turns, and summaries of the rest; or each report.",
)
@click.option(
    "--verdict",
    type=click.Choice(VERDICTS),
    help="Whether they went right. [default: those with marks went wrong]",
)
@click.option("--again", is_flag=True, help="Add also what is there already.")
@JSON
@as_object(_AddArguments)
def add_command(given: _AddArguments) -> None:
    """Add the missions at each PATH: bags, recordings, and folders with such at any depth.

    What is there is passed over, also while somebody else adds it. A mission that cannot be read is
    named and passed over; the exit status is then 1.
    """
    found = missions_at(given.paths, given.robot)
    options = AddOptions(given.static_source, given.keep, given.verdict, given.day, given.again)
    with given.engine() as own, progress("adding missions") as advance:
        made = add(given.store, found, options, own, advance)
    for one in made:
        for note in one.notes:
            warn(f"{one.path}: {note}")
    failed = [one for one in made if one.place is None]
    for why, paths in _by_reason(failed).items():
        more = f" (and {len(paths) - 1:,} more)" if len(paths) > 1 else ""
        say(plain(f"pytpc: error: {paths[0]}{more}: {why}"))
    if given.as_json:
        print_json([_added_json(one) for one in made])
    else:
        _tell_added(given.fleet, made)
    if failed:
        sys.exit(1)


def _by_reason(failed: Sequence[Added]) -> dict[str, list[Path]]:
    reasons: defaultdict[str, list[Path]] = defaultdict(list)
    for one in failed:
        reasons[one.why].append(one.path)
    return reasons


def _added_json(one: Added) -> dict[str, Any]:
    place = {} if one.place is None else one.place._asdict()
    return {
        "path": str(one.path),
        **{name: place.get(name) for name in ("robot", "day", "mission")},
        "new": one.is_new,
        "reports": one.reports,
        "bytes": one.size,
        "notes": list(one.notes),
        "error": one.why,
    }


def _tell_added(fleet: str, made: Sequence[Added]) -> None:
    there = [one for one in made if one.place is not None]
    new = [one for one in there if one.is_new]
    reports, size = sum(one.reports for one in new), sum(one.size for one in new)
    text = f"{many(len(new), 'mission')} added"
    if reports:
        text += f": {many(reports, 'report')} in {size_text(size)}, {size / reports:.2f} bytes each"
    if len(there) > len(new):
        text += f"; {len(there) - len(new):,} were there already"
    if len(there) < len(made):
        text += f"; {len(made) - len(there):,} could not be added"
    click.echo(text)
    tell_next(f"pytpc fleet rank {shlex.quote(plain(shown_url(fleet)))}")


def size_text(size: int) -> str:
    """Bytes for a person.

    >>> size_text(999), size_text(2_500_000)
    ('999 B', '2.5 MB')
    """
    value, unit = float(size), 0
    while value >= 1000 and unit < len(_UNITS) - 1:
        value, unit = value / 1000, unit + 1
    return f"{value:.1f} {_UNITS[unit]}" if unit else f"{size} B"


@dataclass(frozen=True)
class _ListArguments(SelectingArguments):
    verdict: Verdict | None
    parquet: Path | None


@fleet_command.command("list")
@store_options
@selecting
@click.option("--verdict", type=click.Choice(VERDICTS), help="Only those that went so.")
@PARQUET
@JSON
@as_object(_ListArguments)
def list_command(given: _ListArguments) -> None:
    """List the missions."""
    with given.engine() as own, progress("reading missions") as advance:
        found = missions(given.store, own, given.selection(given.verdict), advance)
    if given.parquet is not None:
        write_table(table_of(found.found), given.parquet)
    if given.as_json:
        print_json([one.to_json() for one in found.found])
    elif given.parquet is None:
        _show_list(found)
    end_with_unread(found.unread)


def _show_list(found: Missions) -> None:
    rows = [
        (
            *one.place,
            one.verdict,
            f"{one.seconds:.0f}",
            f"{one.reports:,}",
            str(one.marks),
            one.build[:8],
        )
        for one in found.found
    ]
    headings = ("Robot", "Day", "Mission", "Went", "Seconds", "Reports", "Marks", "Build")
    console().print(text_table(headings, rows, {"Seconds", "Reports", "Marks"}), highlight=False)


@dataclass(frozen=True)
class _ShowArguments(StoreArguments):
    mission: str | None
    output: Path | None


@fleet_command.command("show")
@store_options
@click.argument("mission", required=False)
@click.option(
    "-o",
    "--output",
    type=PATH,
    metavar="FOLDER",
    help="Write MISSION as a folder that all other commands take.",
)
@JSON
@as_object(_ShowArguments)
def show_command(given: _ShowArguments) -> None:
    """Show how large the data set is, or what is known of one MISSION."""
    fleet = given.store
    with given.engine() as own, progress("reading missions") as advance:
        found = missions(fleet, own, on_progress=advance)
    if given.mission is None:
        if given.output is not None:
            raise click.UsageError("-o needs a MISSION")
        _show_fleet(fleet, found, as_json=given.as_json)
    else:
        place = meant(fleet, given.mission)
        known = next((one for one in found.found if one.place == place), None)
        if known is None:
            why = next((one.why for one in found.unread if one.place == place), "is not there now")
            raise InputError(f"{'/'.join(place)}: {why}", shown_url(given.fleet))
        _show_mission(known, as_json=given.as_json)
        if given.output is not None:
            write_folder(fleet, place, given.output)
            tell_next(f"pytpc rank {shlex.quote(plain(str(given.output)))}")
        return
    end_with_unread(found.unread)


def _show_fleet(fleet: Fleet, found: Missions, *, as_json: bool) -> None:
    sizes, unfinished = fleet.bytes_of(), fleet.unfinished()
    every = found.found
    robots = Counter(one.place.robot for one in every)
    days = sorted({one.place.day for one in every})
    reports = sum(one.reports for one in every)
    document = {
        "missions": len(every),
        "bad": sum(one.is_bad for one in every),
        "robots": dict(sorted(robots.items())),
        "first_day": days[0] if days else None,
        "last_day": days[-1] if days else None,
        "builds": sorted({one.build for one in every}),
        "reports": reports,
        "bytes": sizes,
        "unfinished": ["/".join(place) for place in unfinished],
        "unread": [{"mission": "/".join(one.place), "why": one.why} for one in found.unread],
    }
    if as_json:
        print_json(document)
        return
    total = sum(sizes.values())
    rows = [
        ("missions", f"{len(every):,}, of which {document['bad']:,} went wrong"),
        ("robots", ", ".join(f"{name} ({count:,})" for name, count in sorted(robots.items()))),
        ("days", f"{days[0]} to {days[-1]}" if days else "none"),
        ("builds", ", ".join(document["builds"]) or "none"),  # type: ignore[arg-type]
        ("reports", f"{reports:,}"),
        ("size", f"{size_text(total)}, {total / max(1, reports):.2f} bytes a report"),
    ]
    for name, text in rows:
        click.echo(plain(f"{name:9} {text}"))
    if unfinished:
        what = many(len(unfinished), "mission")
        warn(f"{what} half written, by somebody who adds or was killed; add them again")


def _show_mission(one: FleetMission, *, as_json: bool) -> None:
    if as_json:
        print_json(one.to_json())
        return
    for name, value in one.to_json().items():
        text = "; ".join(value) if isinstance(value, tuple | list) else str(value)
        click.echo(plain(f"{name:9} {text}"))


@dataclass(frozen=True)
class _DropArguments(SelectingArguments):
    names: tuple[str, ...]
    half: bool
    yes: bool


@fleet_command.command("drop")
@store_options
@click.argument("names", nargs=-1, metavar="MISSION...")
@selecting
@click.option("--half", is_flag=True, help="Also what is half written.")
@click.option("--yes", is_flag=True, help="Do not ask.")
@JSON
@as_object(_DropArguments)
def drop_command(given: _DropArguments) -> None:
    """Remove missions from the data set: each MISSION, or those of robots, days or a build."""
    fleet, selection = given.store, given.selection()
    fleet.check()
    places = {meant(fleet, name) for name in given.names}
    if selection != EVERY:
        with given.engine() as own:
            found = missions(fleet, own, selection)
        places |= {one.place for one in found.found}
    if given.half:
        places |= set(fleet.unfinished())
    if not places and not given.half:
        raise click.UsageError("say which: MISSION, --robot, --since, --until, --build or --half")
    if places and not given.yes and not given.as_json:
        which = f"{many(len(places), 'mission')} from {plain(shown_url(given.fleet))}"
        click.confirm(f"Remove {which}?", abort=True)
    with progress("removing missions") as advance:
        for number, place in enumerate(sorted(places), start=1):
            fleet.drop(place)
            advance(number, len(places))
    if given.as_json:
        print_json(["/".join(place) for place in sorted(places)])
    else:
        click.echo(f"{many(len(places), 'mission')} removed")


for answer in ANSWERS:
    fleet_command.add_command(answer)

COMMANDS: list[click.Command] = [fleet_command]
