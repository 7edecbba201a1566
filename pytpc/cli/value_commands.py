"""Commands about values: ``origin`` and ``apply``."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import click
from rich.table import Table

from pytpc.api import values
from pytpc.api.values import (
    FileChange,
    Journal,
    JournalEntry,
    LiveChange,
    Origin,
    OutsideError,
    Place,
)
from pytpc.base.wording import listed, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.completion_commands import offer_parameters
from pytpc.cli.console import console, print_json, progress, table_of, telling, warn
from pytpc.cli.lines import say
from pytpc.cli.running_graph import ROS, use_graph
from pytpc.ros.ros2.address import is_ros2, words_of
from pytpc.values.apply import change_as_json, diff_of, shown
from pytpc.values.origins import as_json, to_json

Planned = TypeVar("Planned")
_LONGEST = 60
_MOST_NAMED = 8
_ARGUMENT = re.compile(r"[A-Za-z_]\w*:=.*", re.DOTALL)
WORKSPACE = click.option(
    "--workspace",
    type=PATH,
    help="Look up $(find ...) in this built workspace. [default: what is sourced]",
)


@dataclass(frozen=True)
class _ApplyArguments:
    words: tuple[str, ...]
    dry_run: bool
    undo: bool
    listing: bool
    live: bool
    add: bool
    force: bool
    file: Path | None
    workspace: Path | None
    as_json: bool


@click.command("origin")
@click.argument("target", type=PATH)
@click.argument(
    "words", nargs=-1, metavar="[PARAMETER] [NAME:=VALUE]...", shell_complete=offer_parameters
)
@WORKSPACE
@JSON
def origin_command(
    target: Path, words: tuple[str, ...], workspace: Path | None, as_json: bool
) -> None:
    """Show where the values of parameters came from.

    TARGET is a mission's folder, its bag, a launch file, or a params file of ROS 2. A launch file
    is read with NAME:=VALUE as roslaunch or `ros2 launch` would read it; nothing is started.
    """
    names = [word for word in words if _ARGUMENT.fullmatch(word) is None]
    if len(names) > 1:
        raise click.UsageError("give one PARAMETER, or none")
    with progress(f"reading {target.name}"):
        place = Place(target, _arguments(words), workspace)
        origins = values.origins(place, names[0] if names else None)
    if as_json:
        print_json({o.name: as_json_of(o) for o in origins})
    elif names:
        _show_origin(origins[0])
    else:
        console().print(_origins_table(origins), highlight=False)


@click.command("apply", context_settings={"ignore_unknown_options": True})
@click.argument(
    "words",
    nargs=-1,
    metavar="[TARGET] [PARAMETER VALUE] [NAME:=VALUE]...",
    shell_complete=offer_parameters,
)
@click.option("--dry-run", is_flag=True, help="Show the change without writing it.")
@click.option(
    "--undo", is_flag=True, help="Take back the last change, or the last of FILE, or number N."
)
@click.option("--list", "listing", is_flag=True, help="List the changes that can be taken back.")
@click.option(
    "--live", is_flag=True, help="Set the value on the running robot (with TARGET: there, too)."
)
@click.option(
    "--add",
    is_flag=True,
    help="Add it to the launch file (of ROS 1) or the params file if no file sets it.",
)
@click.option(
    "--force",
    is_flag=True,
    help="Allow another type, a value outside of the declared range, a name that nothing sets or"
    " reads, changes that affect other parameters, too, and changes of a file that is not as it was"
    " recorded.",
)
@click.option(
    "--file",
    type=PATH,
    metavar="FILE",
    help="Change this file, which a recording names though it is outside of the workspace.",
)
@WORKSPACE
@ROS
@JSON
@as_object(_ApplyArguments)
def apply_command(given: _ApplyArguments) -> None:
    """Write VALUE into the YAML or launch file that set PARAMETER.

    TARGET is a mission's folder, a launch file or a YAML file. In a params file of ROS 2, PARAMETER
    is /NODE/NAME, NODE NAME or NAME, with dots in NAME. The rest of the file stays the same,
    byte for byte. The change is shown, and can be taken back with --undo. With --live the value is
    set on the robot at ROS_MASTER_URI: on its parameter server, and by dynamic_reconfigure if the
    node supports it. On ROS 2 the node that has the parameter is asked, and may refuse.

    \b
    pytpc apply mission/ /mission/min_coverage_limit 0.035
    pytpc apply config/params.yaml min_coverage_limit 0.035 --dry-run
    pytpc apply --live /mission/min_coverage_limit 0.035
    pytpc apply --undo
    """
    journal = values.journal()
    if given.listing or given.undo:
        for error in journal.broken():
            warn(plain(str(error)))
    if given.listing:
        _list(journal, given.as_json)
    elif given.undo:
        _undo(journal, given)
    else:
        _set(journal, given)


def _set(journal: Journal, given: _ApplyArguments) -> None:
    words = given.words
    needed = 2 if given.live and len(words) == 2 else 3
    if len(words) < needed:
        raise click.UsageError("give TARGET PARAMETER VALUE, or --live PARAMETER VALUE")
    parameter, value = words[needed - 2], words[needed - 1]
    name, answer = parameter, dict[str, object]()
    if needed == 3:
        change = _plan(given)
        name = change.parameter
        answer["file"] = _write(change, journal, given)
    if given.live:
        graph = use_graph().master
        answer["live"] = _set_live(journal, (name, value), graph, given)
    if given.as_json:
        print_json(answer)


def is_terminal() -> bool:
    """Whether somebody can answer a question."""
    return sys.stdin.isatty()


def with_consent(place: Place, planned: Callable[[Place], Planned], *, asks: bool) -> Planned:
    """What is planned; a file that only the recording names is asked for on a terminal.

    Raises:
        OutsideError: nobody can be asked.
        Abort: it is not to be changed.
        TpcError: whatever the plan raises.
    """
    try:
        return planned(place)
    except OutsideError as error:
        if not asks or not is_terminal():
            raise
        where = f"{error.file}:{error.line}" if error.line else str(error.file)
        say(plain(f"{where} is in no workspace; only the recording names it."))
        click.confirm("Change this file?", abort=True, err=True)
        return planned(replace(place, confirmed=error.file))


def as_json_of(origin: Origin) -> dict[str, object]:
    """An origin as JSON."""
    return {"name": origin.name, "words": origin.words(), **as_json(origin)}


def _arguments(words: Sequence[str]) -> dict[str, str]:
    """The launch arguments NAME:=VALUE among words."""
    pairs = (word.partition(":=") for word in words)
    return {name: value for name, separator, value in pairs if separator}


def _with_node(words: tuple[str, ...]) -> tuple[str, ...]:
    """The words, with NODE PARAMETER as one where they mean a params file or a node of ROS 2."""
    if len(words) < 4 or _ARGUMENT.fullmatch(words[3]) or not values.is_of_ros2(Path(words[0])):
        return words
    return (words[0], f"{words[1].rstrip('/')}/{words[2]}", *words[3:])


def _plan(given: _ApplyArguments) -> FileChange:
    target, parameter, value, *args = _with_node(given.words)
    for word in args:
        if _ARGUMENT.fullmatch(word) is None:
            raise click.UsageError(f"{word!r} is not NAME:=VALUE")
    path = Path(target)
    if given.add and values.is_yaml(path) and path.exists() and not values.is_of_ros2(path):
        raise click.UsageError("--add is for launch files, missions and params files of ROS 2")
    place = Place(path, _arguments(args), given.workspace, given.file)

    def planned(place: Place) -> FileChange:
        with progress(f"reading {place.path.name}"):
            return values.plan(place, parameter, value, add=given.add, force=given.force)

    return with_consent(place, planned, asks=not given.as_json)


def _write(change: FileChange, journal: Journal, given: _ApplyArguments) -> dict[str, object]:
    entry = None if given.dry_run else values.apply(change, journal)
    if given.as_json:
        number = None if entry is None else entry.number
        return {
            **change_as_json(change),
            "old": to_json(change.old),
            "new": to_json(change.new),
            "written": entry is not None,
            "undo": number,
        }
    show_diff(change)
    place = f"{change.path}:{change.lineno}"
    names = listed(change.parameters, _MOST_NAMED)
    what = f"{names} {shown(change.old)} -> {shown(change.new)}"
    for note in change.notes:
        warn(plain(note))
    if change.before == change.after:
        click.echo(plain(f"{place}: {names} is {shown(change.new)} already"))
    elif entry is None:
        click.echo(plain(f"{place}: {what} (not written: --dry-run)"))
    else:
        click.echo(plain(f"{place}: {what}"))
        say(f"to take it back: pytpc apply --undo {entry.number}")
    return {}


def _set_live(
    journal: Journal, change_to: tuple[str, str], graph: str, given: _ApplyArguments
) -> dict[str, object]:
    with telling("asking the nodes"):
        done = values.apply_live(
            change_to, journal, graph=graph, dry_run=given.dry_run, force=given.force
        )
    change, entry = done.change, done.entry
    told = _told(change, done.holds, done.taken)
    if given.dry_run and change.service:
        told = "the node would take it at once (dynamic_reconfigure)"
        if is_ros2(change.master):
            told = "the node would be asked, and may refuse it"
    if given.as_json:
        return {
            "parameter": done.name,
            "master": change.master,
            "old": to_json(change.old),
            "new": to_json(change.new),
            "holds": to_json(done.holds),
            "service": change.service or None,
            "nodes": list(change.nodes),
            "taken_at_once": done.taken,
            "note": told,
            "written": entry is not None,
            "undo": None if entry is None else entry.number,
        }
    dry = " (not set: --dry-run)" if given.dry_run else ""
    what = f"{done.name} {shown(change.old)} -> {shown(done.holds)}{dry}"
    click.echo(plain(f"{words_of(change.master)}: {what}"))
    say(plain(told))
    if entry is not None:
        say(f"to take it back: pytpc apply --undo {entry.number}")
    return {}


def _told(change: LiveChange, holds: object, taken: bool) -> str:
    """Say whether the node uses the new value already."""
    if is_ros2(change.master):
        return (
            "the node has taken it; it uses it now if it has a callback for that, or reads the"
            " parameter while it runs"
        )
    if taken:
        if repr(holds) != repr(change.new):
            return f"the node limited it to {shown(holds)} (dynamic_reconfigure)"
        return "the node uses it now (dynamic_reconfigure), without a restart"
    if not change.nodes:
        return "no node of this namespace is running; one that is started will read it"
    nodes = ", ".join(change.nodes)
    return (
        f"{nodes} does not offer it by dynamic_reconfigure and most likely reads it at its start:"
        " restart it, unless it reads its parameters while it runs"
    )


def _undo(journal: Journal, given: _ApplyArguments) -> None:
    if len(given.words) > 1:
        raise click.UsageError("give one FILE or number, or nothing")
    what = given.words[0] if given.words else ""
    entry, change = values.undo(journal, what, dry_run=given.dry_run, force=given.force)
    if given.as_json:
        answer = {"undone": entry.number, "written": not given.dry_run, **_entry_json(entry)}
        print_json(answer)
        return
    if change is not None:
        show_diff(change)
    done = " (not written: --dry-run)" if given.dry_run else ""
    click.echo(plain(f"{entry.place}: {entry.parameter} {entry.new} -> {entry.old}{done}"))


def _list(journal: Journal, as_json: bool) -> None:
    entries = journal.entries()
    if as_json:
        print_json([_entry_json(entry) for entry in entries])
        return
    if entries:
        rows = [
            (str(one.number), one.time, one.parameter, one.old, one.new, one.place)
            for one in entries
        ]
        headings = ("Change", "Time", "Parameter", "Old", "New", "Where")
        console().print(table_of(headings, rows, right=("Change",)), highlight=False)
    else:
        say("no changes to take back")


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


def show_diff(change: FileChange) -> None:
    """Print a change as a diff."""
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
    rows = [
        (
            origin.name,
            _short(shown(origin.value)),
            origin.kind,
            origin.words() if origin.path is not None else "",
            origin.note,
        )
        for origin in origins
    ]
    return table_of(("Parameter", "Value", "Kind", "Where", "Note"), rows)


def _short(text: str) -> str:
    """Cut a long value: a robot's description is a parameter of half a megabyte."""
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


COMMANDS: list[click.Command] = [origin_command, apply_command]
