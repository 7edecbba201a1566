"""Commands about values: ``origin`` and ``apply``."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import click
from rich.table import Table
from rich.text import Text

from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.build.build import installed, workspace_env
from pytpc.cli.console import console, progress, warn
from pytpc.ros.live_change import set_live, take_back_live
from pytpc.ros.ros1.live_values import LiveChange, Robot
from pytpc.ros.ros1.master import uri_of
from pytpc.values.apply import FileChange, apply_change, change_as_json, diff_of, shown
from pytpc.values.journal import Journal, JournalEntry, folder_of
from pytpc.values.origins import Origin, as_json, to_json
from pytpc.values.target import (
    Target,
    chosen,
    is_yaml,
    plan_addition,
    plan_origin,
    plan_yaml,
    read_target,
)
from pytpc.values.undo import entry_of, take_back_file

_LONGEST = 60
_PATH = click.Path(path_type=Path)
_ARGUMENT = re.compile(r"[A-Za-z_]\w*:=.*", re.DOTALL)
_WORKSPACE = click.option(
    "--workspace",
    type=_PATH,
    help="Built workspace in which $(find ...) is looked up. [default: what is sourced]",
)
_JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON.")


@dataclass(frozen=True, slots=True)
class _Options:
    dry_run: bool
    add: bool
    force: bool
    as_json: bool


@click.command("origin")
@click.argument("target", type=_PATH)
@click.argument("words", nargs=-1, metavar="[PARAMETER] [NAME:=VALUE]...")
@_WORKSPACE
@_JSON
def origin_command(
    target: Path, words: tuple[str, ...], workspace: Path | None, as_json: bool
) -> None:
    """Say where the values of parameters came from.

    TARGET is a mission's folder (or its bag), or a launch file, which is read with NAME:=VALUE as
    roslaunch would; nothing is started.
    """
    names = [word for word in words if _ARGUMENT.fullmatch(word) is None]
    if len(names) > 1:
        raise click.UsageError("give one PARAMETER, or none")
    found = _target(target, words, workspace)
    origins = [chosen(found, names[0])] if names else list(found.origins.values())
    if as_json:
        click.echo(json.dumps({o.name: as_json_of(o) for o in origins}, indent=1))
    elif names:
        _show_origin(origins[0])
    else:
        console().print(_origins_table(origins), highlight=False)


@click.command("apply", context_settings={"ignore_unknown_options": True})
@click.argument("words", nargs=-1, metavar="[TARGET] [PARAMETER VALUE] [NAME:=VALUE]...")
@click.option("--dry-run", is_flag=True, help="Show the change and write nothing.")
@click.option("--undo", is_flag=True, help="Take back the last change (of FILE, or number N).")
@click.option("--list", "listing", is_flag=True, help="List the changes that can be taken back.")
@click.option("--live", is_flag=True, help="Set it on the running robot (with TARGET: too).")
@click.option("--add", is_flag=True, help="Where no file sets it, add it to the launch file.")
@click.option(
    "--force", is_flag=True, help="Change its type, and what other parameters share with it."
)
@_WORKSPACE
@_JSON
def apply_command(
    *,
    words: tuple[str, ...],
    dry_run: bool,
    undo: bool,
    listing: bool,
    live: bool,
    add: bool,
    force: bool,
    workspace: Path | None,
    as_json: bool,
) -> None:
    """Write VALUE into the YAML or launch file that set PARAMETER.

    TARGET is a mission's folder, a launch file or a YAML file. All else in the file stays as it is,
    byte for byte; the change is shown, and noted for --undo. With --live the value is set on the
    robot at ROS_MASTER_URI: on its parameter server, and by dynamic_reconfigure where the node has
    it.

    \b
    pytpc apply mission/ /mission/min_coverage_limit 0.035
    pytpc apply config/params.yaml min_coverage_limit 0.035 --dry-run
    pytpc apply --live /mission/min_coverage_limit 0.035
    pytpc apply --undo
    """
    journal = Journal(folder_of(os.environ))
    options = _Options(dry_run, add, force, as_json)
    if listing or undo:
        for error in journal.broken():
            warn(plain(str(error)))
    if listing:
        _list(journal, as_json)
    elif undo:
        _undo(journal, words, options)
    else:
        needed = 2 if live and len(words) == 2 else 3
        if len(words) < needed:
            raise click.UsageError("give TARGET PARAMETER VALUE, or --live PARAMETER VALUE")
        parameter, value = words[needed - 2], words[needed - 1]
        name, answer = parameter, dict[str, object]()
        if needed == 3:
            change = _plan(Path(words[0]), words[3:], (parameter, value), workspace, options)
            name = change.parameter
            answer["file"] = _write(change, journal, options)
        if live:
            answer["live"] = _set_live(journal, name, value, options)
        if as_json:
            click.echo(json.dumps(answer, indent=1))


def as_json_of(origin: Origin) -> dict[str, object]:
    """An origin for a program that reads it."""
    return {"name": origin.name, "words": origin.words(), **as_json(origin)}


def _target(path: Path, words: Sequence[str], workspace: Path | None) -> Target:
    args = {
        name: value
        for name, separator, value in (word.partition(":=") for word in words)
        if separator
    }
    env: Mapping[str, str] = os.environ
    if workspace is not None:
        env = workspace_env(installed(workspace))
    if is_yaml(path):
        raise InputError("a YAML file says nothing of where else values come from", path)
    with progress(f"reading {path.name}"):
        return read_target(path, args, env)


def _plan(
    path: Path,
    args: Sequence[str],
    setting: tuple[str, str],
    workspace: Path | None,
    options: _Options,
) -> FileChange:
    parameter, value = setting
    for word in args:
        if _ARGUMENT.fullmatch(word) is None:
            raise click.UsageError(f"{word!r} is not NAME:=VALUE")
    if is_yaml(path):
        if options.add:
            raise click.UsageError("--add is for launch files and missions")
        return plan_yaml(path, parameter, value, force=options.force)
    target = _target(path, args, workspace)
    origin = chosen(target, parameter)
    if options.add and origin.kind in ("default", "runtime"):
        return plan_addition(origin, target, value)
    return plan_origin(origin, value, force=options.force, files=target.files)


def _write(change: FileChange, journal: Journal, options: _Options) -> dict[str, object]:
    entry: JournalEntry | None = None
    same = change.before == change.after
    if not options.dry_run and not same:
        entry = apply_change(change, journal)
    if options.as_json:
        number = None if entry is None else entry.number
        return {
            **change_as_json(change),
            "old": to_json(change.old),
            "new": to_json(change.new),
            "written": entry is not None,
            "undo": number,
        }
    _show_diff(change)
    place = f"{change.path}:{change.lineno}"
    what = f"{change.parameter} {shown(change.old)} -> {shown(change.new)}"
    for note in change.notes:
        warn(plain(note))
    if same:
        click.echo(plain(f"{place}: {change.parameter} is {shown(change.new)} already"))
    elif entry is None:
        click.echo(plain(f"{place}: {what} (not written: --dry-run)"))
    else:
        click.echo(plain(f"{place}: {what}"))
        click.echo(f"to take it back: pytpc apply --undo {entry.number}", err=True)
    return {}


def _set_live(journal: Journal, parameter: str, value: str, options: _Options) -> dict[str, object]:
    robot = Robot(uri_of(os.environ))
    name = _full_name(robot, parameter)
    change = robot.plan(name, value, force=options.force)
    if options.dry_run:
        entry, holds, taken = None, change.new, False
    else:
        entry, holds, taken = set_live(robot, change, journal)
    told = _told(change, holds, taken)
    if options.dry_run and change.service:
        told = "the node would take it at once (dynamic_reconfigure)"
    if options.as_json:
        return {
            "parameter": name,
            "master": change.master,
            "old": to_json(change.old),
            "new": to_json(change.new),
            "holds": to_json(holds),
            "service": change.service or None,
            "nodes": list(change.nodes),
            "taken_at_once": taken,
            "note": told,
            "written": entry is not None,
            "undo": None if entry is None else entry.number,
        }
    done = " (not set: --dry-run)" if options.dry_run else ""
    click.echo(plain(f"{change.master}: {name} {shown(change.old)} -> {shown(holds)}{done}"))
    click.echo(plain(told), err=True)
    if entry is not None:
        click.echo(f"to take it back: pytpc apply --undo {entry.number}", err=True)
    return {}


def _full_name(robot: Robot, parameter: str) -> str:
    if parameter.startswith("/"):
        return parameter
    wanted = parameter.lstrip("~/")
    meant = [name for name in robot.parameters() if name.endswith(f"/{wanted}")]
    if len(meant) != 1:
        names = ", ".join(meant[:8]) or "none"
        raise InputError(f"give the full name: the robot has {names} with {parameter} at its end")
    return meant[0]


def _told(change: LiveChange, holds: object, taken: bool) -> str:
    """Whether the node has the new value, too."""
    if taken:
        if repr(holds) != repr(change.new):
            return f"the node has made {shown(holds)} of it (dynamic_reconfigure): its own limits"
        return "the node has taken it (dynamic_reconfigure); it goes on without a restart"
    if not change.nodes:
        return "no node of this namespace runs; one that is started will read it"
    nodes = ", ".join(change.nodes)
    return (
        f"{nodes} reads it when it asks again, mostly when it starts: it has no dynamic_reconfigure"
        " for it. Start it again unless it reads its parameters as it runs"
    )


def _undo(journal: Journal, words: Sequence[str], options: _Options) -> None:
    if len(words) > 1:
        raise click.UsageError("give one FILE or number, or nothing")
    entry = entry_of(journal, words[0] if words else "")
    change = None
    if entry.path is not None:
        change = take_back_file(entry, journal, dry_run=options.dry_run)
    else:
        take_back_live(entry, journal, dry_run=options.dry_run, force=options.force)
    if options.as_json:
        answer = {"undone": entry.number, "written": not options.dry_run, **_entry_json(entry)}
        click.echo(json.dumps(answer, indent=1))
        return
    if change is not None:
        _show_diff(change)
    done = " (not written: --dry-run)" if options.dry_run else ""
    what = f"{entry.parameter} {entry.new} -> {entry.old}"
    click.echo(plain(f"{entry.place}: {what}{done}"))


def _list(journal: Journal, as_json: bool) -> None:
    entries = journal.entries()
    if as_json:
        click.echo(json.dumps([_entry_json(entry) for entry in entries], indent=1))
        return
    table = Table()
    table.add_column("Change", justify="right")
    for heading in ("Time", "Parameter", "Old", "New", "Where"):
        table.add_column(heading, overflow="fold")
    for entry in entries:
        cells = (entry.time, entry.parameter, entry.old, entry.new, entry.place)
        table.add_row(str(entry.number), *(Text(plain(cell)) for cell in cells))
    if entries:
        console().print(table, highlight=False)
    else:
        click.echo("no changes are noted", err=True)


def _entry_json(entry: JournalEntry) -> dict[str, object]:
    return {
        "number": entry.number,
        "time": entry.time,
        "parameter": entry.parameter,
        "old": entry.old,
        "new": entry.new,
        "path": None if entry.path is None else str(entry.path),
        "master": entry.live.get("master"),
    }


def _show_diff(change: FileChange) -> None:
    for line in diff_of(change).splitlines():
        click.echo("\t".join(plain(part) for part in line.split("\t")))


def _show_origin(origin: Origin) -> None:
    click.echo(plain(f"{origin.name} = {_short(shown(origin.value))}: {origin.words()}"))
    lines = [origin.text] if origin.text else []
    lines += [f"through {place}" for place in origin.via]
    lines += [f"overrides {place}" for place in origin.overridden]
    lines += [f"a copy of {origin.source}"] if origin.source is not None else []
    lines += [origin.note] if origin.note else []
    for line in lines:
        click.echo(plain(f"    {line}"))


def _origins_table(origins: Sequence[Origin]) -> Table:
    table = Table()
    for heading in ("Parameter", "Value", "Kind", "Where", "Note"):
        table.add_column(heading, overflow="fold")
    for origin in origins:
        where = origin.words() if origin.path is not None else ""
        cells = (origin.name, _short(shown(origin.value)), origin.kind, where, origin.note)
        table.add_row(*(Text(plain(cell)) for cell in cells))
    return table


def _short(text: str) -> str:
    """A robot's description is a parameter, too, of half a megabyte."""
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


COMMANDS: list[click.Command] = [origin_command, apply_command]
