"""Changes a value on the running robot, records that, and undoes it."""

from __future__ import annotations

import contextlib

from pytpc.base.errors import RunError, TpcError
from pytpc.ros.ros1.live_values import LiveChange, Robot
from pytpc.values.apply import shown
from pytpc.values.journal import Journal, JournalEntry
from pytpc.values.origins import from_json, to_json


def set_live(
    robot: Robot, change: LiveChange, journal: Journal
) -> tuple[JournalEntry, object, bool]:
    """Set a value on the running robot and record it.

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
    entry = journal.add_live(change.name, (shown(change.old), shown(change.new)), live)
    try:
        holds, taken = robot.put(change)
    except BaseException:
        # The node may have taken it all the same, and only its answer did not come.
        with contextlib.suppress(TpcError):
            if repr(robot.value(change.name)) == repr(change.old):
                journal.remove(entry)
        raise
    return entry, holds, taken


def take_back_live(
    entry: JournalEntry, journal: Journal, *, dry_run: bool = False, force: bool = False
) -> None:
    """Undo a change of the running robot and forget it.

    Raises:
        TpcError: the value was changed since, or the robot does not take it.
    """
    live = entry.live
    name, old, new = str(live["name"]), from_json(live["old"]), from_json(live["new"])
    robot = Robot(str(live["master"]))
    now = robot.value(name)
    if not force and repr(now) not in (repr(new), repr(old)):
        raise RunError(
            f"{name} is {shown(now)} now: something else has set it; --force sets {entry.old}"
        )
    if not dry_run:
        robot.take_back(name, old, str(live["service"]))
        journal.remove(entry)
