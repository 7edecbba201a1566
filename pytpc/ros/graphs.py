"""The graph at an address: a ROS 1 master's URI, or ``ros2://DOMAIN``."""

from __future__ import annotations

import contextlib

from pytpc.base.errors import RunError, TpcError
from pytpc.ros.live_change import LiveChange, LiveRobot
from pytpc.ros.node_status import SettableNodes
from pytpc.ros.ros1.instrumented_nodes import InstrumentedNodes
from pytpc.ros.ros1.live_values import Robot
from pytpc.ros.ros1.marking import GraphMarks
from pytpc.ros.ros2.address import Ros2Address, is_ros2
from pytpc.ros.ros2.instrumented_nodes import Ros2Nodes
from pytpc.ros.ros2.live_values import Ros2Robot
from pytpc.ros.ros2.marking import Ros2Marks
from pytpc.values.apply import shown
from pytpc.values.journal import Journal, JournalEntry
from pytpc.values.origins import from_json, to_json


def marks_at(
    address: str, observer: str, what: str = "marking", *, advertise: bool = True
) -> GraphMarks | Ros2Marks:
    """The side of a marking session that speaks to the graph.

    Raises:
        TpcError: ROS 2 does not work here.
    """
    if is_ros2(address):
        return Ros2Marks(Ros2Address.parse(address), observer, what)
    return GraphMarks(address, observer, what, advertise=advertise)


def nodes_at(address: str) -> SettableNodes:
    """The instrumented nodes of the graph.

    Raises:
        TpcError: ROS 2 does not work here.
    """
    if is_ros2(address):
        return Ros2Nodes(Ros2Address.parse(address))
    return InstrumentedNodes(address)


def robot_at(address: str) -> LiveRobot:
    """The graph whose parameters can be set.

    Raises:
        TpcError: ROS 2 does not work here.
    """
    return Ros2Robot(Ros2Address.parse(address)) if is_ros2(address) else Robot(address)


def values_at(address: str) -> dict[str, object]:
    """All parameters of the graph, by full names.

    Raises:
        TpcError: nobody answers.
    """
    with contextlib.closing(robot_at(address)) as robot:
        return robot.values()


def set_live(
    robot: LiveRobot, change: LiveChange, journal: Journal
) -> tuple[JournalEntry, object, bool]:
    """Set a value on the running robot and record it.

    Returns:
        The entry of the journal; the value that holds then; whether the node has taken it at once.

    Raises:
        RunError: the robot refuses it.
        TpcError: it cannot be recorded; then nothing is set.
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
        holds, taken = robot.put(change.name, change.new, change.service)
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
        TpcError: the value was changed since, or the robot refuses it.
    """
    live = entry.live
    name, old, new = str(live["name"]), from_json(live["old"]), from_json(live["new"])
    with contextlib.closing(robot_at(str(live["master"]))) as robot:
        now = robot.value(name)
        if not force and repr(now) not in (repr(new), repr(old)):
            raise RunError(
                f"{name} is {shown(now)} now: something else has set it; --force sets {entry.old}"
            )
        if not dry_run:
            robot.take_back(name, old, str(entry.live["service"]))
            journal.remove(entry)
