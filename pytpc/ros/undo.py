"""Taking back what ``pytpc apply`` did, on disk or on the running robot."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path

from pytpc.base.errors import InputError, RunError, TpcError
from pytpc.ros.ros1.live_values import LiveChange, Robot
from pytpc.values.apply import Change, replace_file, shown, undo_change
from pytpc.values.journal import Entry, Journal
from pytpc.values.origins import from_json, to_json


def set_live(robot: Robot, change: LiveChange, journal: Journal) -> tuple[Entry, object, bool]:
    """Set a value on the running robot, and note it.

    Returns:
        The note; the value that holds then; whether the node has taken it over by itself.

    Raises:
        RunError: the robot does not take it.
        TpcError: it cannot be noted; then nothing is set.
    """
    live = {
        "master": change.master,
        "name": change.name,
        "service": change.service,
        "old": to_json(change.old),
        "new": to_json(change.new),
    }
    entry = journal.add(change.name, (shown(change.old), shown(change.new)), live=live)
    try:
        holds, taken = robot.put(change)
    except BaseException:
        # The node may have taken it all the same, and only its answer did not come.
        with contextlib.suppress(TpcError):
            if repr(robot.value(change.name)) == repr(change.old):
                journal.remove(entry)
        raise
    return entry, holds, taken


def entry_of(journal: Journal, what: str) -> Entry:
    """The change that is to be taken back.

    Args:
        journal: of the changes.
        what: its number, a file of which the last change is meant, or empty for the last of all.

    Raises:
        InputError: there is none.
    """
    entries = journal.entries()
    if what.isdigit() and not Path(what).exists():
        meant = [entry for entry in entries if entry.number == int(what)]
    elif what:
        real = Path(what).resolve()
        meant = [entry for entry in entries if entry.path == real]
    else:
        meant = entries
    if not meant:
        raise InputError(
            f"no change of {what} is noted" if what else "no change is noted: nothing to take back"
        )
    return meant[-1]


def take_back(
    entry: Entry,
    journal: Journal,
    *,
    robot_at: Callable[[str], Robot] = Robot,
    dry_run: bool = False,
    force: bool = False,
) -> Change | None:
    """Take a change back and forget it.

    Returns:
        What it does to the file; None for a running robot.

    Raises:
        TpcError: the file, or the robot's value, was changed since.
    """
    if entry.path is not None:
        with journal.held():
            change = undo_change(entry, journal)
            if not dry_run:
                replace_file(change.path, change.after)
                journal.remove(entry)
        return change
    live = entry.live
    name, old, new = str(live["name"]), from_json(live["old"]), from_json(live["new"])
    robot = robot_at(str(live["master"]))
    now = robot.value(name)
    if not force and repr(now) not in (repr(new), repr(old)):
        raise RunError(
            f"{name} is {shown(now)} now, which somebody else has set; --force sets {entry.old}"
        )
    if not dry_run:
        robot.take_back(name, old, str(live["service"]))
        journal.remove(entry)
    return None
