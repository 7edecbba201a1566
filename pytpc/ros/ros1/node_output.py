"""Nodes of a launch file that died, as roslaunch tells it, and what was printed last.

roslaunch gets what all nodes write to standard error, and the standard output of those with
``output="screen"``. The standard output of the others is in files of their own.
"""

from __future__ import annotations

import re
from collections import deque
from pathlib import Path

from pytpc.ros.mission_run import DiedNode
from pytpc.ros.ros1.graph import without_colours

_MOST_BYTES = 1 << 20
_LINES = 5
_LONGEST = 300
_DIED = re.compile(
    r"(?:\[(?P<name>[^\]\s]+)\] )?process has died \[pid \d+, exit code (?P<status>-?\d+)"
)
_REQUIRED = re.compile(r"=*REQUIRED process \[(?P<name>[^\]\s]+)\] has died!")
_STARTED = "process["
# What roslaunch itself says while nodes run.
_OWN = re.compile(
    r"=+$|log file: |\[[^\]]*\] (killing|escalating|restarting|process)"
    r"|\.\.\. shutting|shutting down|Initiating shutdown|done$"
)


class NodeOutput:
    """Reads the output of roslaunch while that is written.

    Args:
        log: its file, which need not exist yet.
    """

    def __init__(self, log: Path) -> None:
        self._log = log
        self._at = 0
        self._rest = b""
        self._said: deque[str] = deque(maxlen=_LINES)
        self._required = ""
        self._has_nodes = False

    def died(self) -> list[DiedNode]:
        """The nodes that died since the last call."""
        try:
            with self._log.open("rb") as stream:
                stream.seek(self._at)
                data = stream.read(_MOST_BYTES)
        except OSError:
            return []
        self._at += len(data)
        *lines, self._rest = (self._rest + data).split(b"\n")
        # Nobody ends a line of megabytes.
        self._rest = self._rest[-_MOST_BYTES:]
        found = []
        for line in lines:
            one = self._read(without_colours(line.decode("utf-8", "replace")).rstrip())
            found += [] if one is None else [one]
        return found

    def _read(self, line: str) -> DiedNode | None:
        required = _REQUIRED.match(line)
        if required is not None:
            self._required = required["name"]
            return None
        found = _DIED.match(line)
        if found is not None:
            name = found["name"] or self._required
            return DiedNode(name, int(found["status"]), tuple(self._said), self._log)
        if line.startswith(_STARTED):
            self._has_nodes = True
        elif line and self._has_nodes and not _OWN.match(line):
            self._said.append(line[:_LONGEST])
        return None
