"""Says once why a graph that is recorded reports nothing, as far as it can be seen from here."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

from pytpc.base.errors import RunError
from pytpc.base.wording import listed, many
from pytpc.ros.mission_run import RecorderStatus
from pytpc.ros.ros1.instrumented_nodes import InstrumentedNodes
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.node_process import is_built_with_tpc, is_gone
from pytpc.static.wiring import is_tool

PATIENCE_S = 10.0
_LOOK_S = 1.0
_CALLER = "/tpc_look"
_ROSOUT = "/rosout"
_LISTED = 3
_LONGEST = 200
_MOST_ASKED = 50


class QuietNode(NamedTuple):
    """A node of the robot.

    Attributes:
        name: its name.
        is_built: whether it was built or started with TPC; None: not known.
        sink: where it reports, empty where that is not known.
        file: the file that it writes, if any.
        is_reached: whether the recorder has connected to its log messages.
    """

    name: str
    is_built: bool | None = None
    sink: str = ""
    file: str = ""
    is_reached: bool = True


class Quiet(NamedTuple):
    """Why nothing is reported, in a line that ends with what to type; whether that is a fault."""

    line: str
    is_fault: bool


class QuietWatch:
    """Watches a recording until something is reported, or until it has said why nothing is.

    Args:
        master: URI of the ROS master.
        on_quiet: called by a thread of its own: once when no node runs, once when nodes report
            nothing.
        is_own: whether the graph was started for this recording, so that nodes will come.
        patience_s: how long nodes may run without a report.
    """

    def __init__(
        self,
        master: str,
        on_quiet: Callable[[str, bool], None] | None,
        *,
        is_own: bool = False,
        patience_s: float = PATIENCE_S,
    ) -> None:
        """See the class; nothing is asked before the first ``see``."""
        self._master = Master(master, _CALLER)
        self._on_quiet = on_quiet
        self._is_own = is_own
        self._patience_s = patience_s
        self._heard: Collection[str] = ()
        self._over = threading.Event()
        self._thread: threading.Thread | None = None

    def see(self, status: RecorderStatus, in_files: int = 0) -> None:
        """Take note of how the recording goes; ``in_files`` reports are in files of nodes."""
        if status.is_reporting or in_files:
            self._over.set()
        self._heard = status.heard
        if self._thread is None and self._on_quiet is not None and not self._over.is_set():
            self._thread = threading.Thread(target=self._watch, name="quiet", daemon=True)
            self._thread.start()

    def close(self) -> None:
        """Ask and tell no more."""
        self._over.set()

    def _watch(self) -> None:
        assert self._on_quiet is not None
        began, has_told_of_none = time.monotonic(), self._is_own
        since: float | None = None
        while not self._over.wait(min(_LOOK_S, self._patience_s)):
            try:
                known = robot_nodes(self._master)
                gone = gone_nodes(self._master, known, self._heard)
                names = [name for name in known if name not in gone]
                if not names:
                    since = None
                    late = time.monotonic() > began + self._patience_s
                    if late and not has_told_of_none:
                        has_told_of_none = True
                        self._on_quiet(*why_quiet([], self._master.uri, gone))
                    continue
                since = since or time.monotonic()
                if time.monotonic() < since + self._patience_s:
                    continue
                found = look_at_nodes(self._master, names, self._heard)
            except RunError:
                continue
            if not self._over.is_set():
                self._on_quiet(*why_quiet(found, self._master.uri))
            return


def robot_nodes(master: Master) -> list[str]:
    """The nodes of a graph without those of TPC and of ROS's own tools, sorted.

    Raises:
        RunError: the master does not answer.
    """
    return sorted(name for name in master.state().nodes if not is_tool(name))


def gone_nodes(master: Master, names: Sequence[str], heard: Collection[str]) -> list[str]:
    """Those that have died, though the master still knows them; ``heard`` are not among them."""
    silent = [name for name in names if name not in heard][:_MOST_ASKED]
    return [name for name in silent if is_gone(master, name)]


def look_at_nodes(master: Master, names: Sequence[str], heard: Collection[str]) -> list[QuietNode]:
    """See how nodes were built and where they report; those that can say it are asked.

    Args:
        master: the ROS master.
        names: of the nodes.
        heard: those to whose log messages the recorder is connected.

    Raises:
        RunError: the master does not answer.
    """
    loggers = set(master.state().publishers.get(_ROSOUT, ()))
    settable = InstrumentedNodes(master.uri)
    offered = [name for name in settable.names() if name in names][:_MOST_ASKED]
    asked = {status.node: status.values for status in settable.reload_all(offered)}
    found = []
    for number, name in enumerate(names):
        values = asked.get(name, {})
        is_built: bool | None = True if name in asked else None
        if is_built is None and number < _MOST_ASKED:
            is_built = is_built_with_tpc(master, name)
        is_reached = name in heard or name not in loggers
        sink, file = values.get("sink", ""), values.get("file", "")
        found.append(QuietNode(name, is_built, sink, file, is_reached))
    return found


def why_quiet(nodes: Sequence[QuietNode], master: str, gone: Sequence[str] = ()) -> Quiet:
    """Why these nodes of a graph, which are all of the robot's that run, report nothing.

    ``gone`` are nodes that the master knows and that do not answer.
    """
    if not nodes:
        dead = (
            f"; {_counted(gone)} that the master lists cannot be reached: dead, or in a container"
            " whose ports are not published"
            if gone
            else ""
        )
        return Quiet(
            f"no node of a robot runs at {master} yet{dead}; start the robot, or, if it runs with"
            " another master: export ROS_MASTER_URI=http://HOST:11311",
            is_fault=False,
        )
    off = [one for one in nodes if one.sink == "off"]
    if off:
        return Quiet(
            f"no reports: {_named(off)} {_verb(off, 'is', 'are')} switched off (sink off); to"
            " switch reports on: pytpc sink --sink auto",
            is_fault=True,
        )
    deaf = [one for one in nodes if one.is_built is not False]
    if deaf and not any(one.is_reached for one in deaf):
        return Quiet(
            f"no reports: the log messages of {_named(deaf)} cannot be reached; where the robot"
            " runs, set ROS_IP to an address that this machine reaches, and start the robot again",
            is_fault=True,
        )
    to_files = [one for one in nodes if one.sink == "file"]
    if to_files:
        where = next((f" ({one.file[:_LONGEST]})" for one in to_files if one.file), "")
        return Quiet(
            f"{_named(to_files)} {_verb(to_files, 'writes', 'write')} reports to files{where}, not"
            " to the graph; copy them into the folder tpc of the recording at its end, or have them"
            " on the graph: pytpc sink --sink auto",
            is_fault=False,
        )
    built = [one for one in nodes if one.is_built]
    if built:
        what = _verb(built, "is built with TPC, and has", "are built with TPC, and have")
        return Quiet(
            f"no reports yet: {_named(built)} {what} compared nothing so far; that is right as long"
            " as the robot has nothing to decide",
            is_fault=False,
        )
    return _not_built(nodes)


def _not_built(nodes: Sequence[QuietNode]) -> Quiet:
    if all(one.is_built is False for one in nodes):
        return Quiet(
            f"no reports: {_named(nodes)} {_verb(nodes, 'is', 'are')} not built with TPC; start the"
            ' robot in a terminal after: eval "$(pytpc env --setup WORKSPACE)"; to check the build:'
            " pytpc doctor WORKSPACE",
            is_fault=True,
        )
    what = _verb(nodes, "is not built with TPC, or has", "are not built with TPC, or have")
    return Quiet(
        f"no reports: {_named(nodes)} {what} compared nothing so far; to check the build, where the"
        " robot runs: pytpc doctor WORKSPACE",
        is_fault=True,
    )


def _named(nodes: Sequence[QuietNode]) -> str:
    return _counted([one.name for one in nodes])


def _counted(names: Sequence[str]) -> str:
    return f"{many(len(names), 'node')} ({listed([name[:_LONGEST] for name in names], _LISTED)})"


def _verb(nodes: Sequence[object], one: str, several: str) -> str:
    return one if len(nodes) == 1 else several
