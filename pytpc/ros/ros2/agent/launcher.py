"""Runs a launch file of ROS 2, and writes down which processes start and how they end.

A program of its own: it runs below ``pytpc.ros.ros2.flight`` with the Python that launch has, and
needs nothing but launch.

    python3 launcher.py EVENTS FILE [NAME:=VALUE]...

Each line of EVENTS is a JSON object: ``{"started": "guard-1", "pid": 7, "words": [...], "folder":
...}``, or ``{"ended": "guard-1", "status": -11, "said": [...], "stopping": false}`` with the last
lines on standard error.
"""

from __future__ import annotations

import json
import os
import sys
from collections import defaultdict, deque
from typing import Any

_LINES = 5
_LONGEST = 300


class Notes:
    """Writes the events; launch calls it in its one thread."""

    def __init__(self, path: str) -> None:
        self._stream = open(path, "w", encoding="utf-8")  # noqa: SIM115 - open as long as this runs
        self._said: Any = defaultdict(lambda: deque(maxlen=_LINES))
        self._rest: Any = defaultdict(str)

    def start(self, event: Any, _context: Any) -> None:
        """A process has started."""
        self._write(
            {
                "started": event.process_name,
                "pid": event.pid,
                "words": list(event.cmd),
                "folder": event.cwd or os.getcwd(),
            }
        )

    def hear(self, event: Any) -> None:
        """A process has written to standard error."""
        name = event.process_name
        *lines, rest = (self._rest[name] + event.text.decode("utf-8", "replace")).split("\n")
        self._rest[name] = rest[-_LONGEST:]
        self._said[name].extend(line.rstrip()[:_LONGEST] for line in lines if line.strip())

    def end(self, event: Any, context: Any) -> None:
        """A process has ended."""
        name = event.process_name
        rest = self._rest.pop(name, "").strip()
        said = [*self._said.pop(name, ()), *([rest] if rest else [])][-_LINES:]
        status, stopping = event.returncode, bool(context.is_shutdown)
        self._write({"ended": name, "status": status, "said": said, "stopping": stopping})

    def _write(self, line: Any) -> None:
        self._stream.write(json.dumps(line) + "\n")
        self._stream.flush()


def main(argv: list[str]) -> int:
    """Run the launch file; the status of launch."""
    # Files beside this one must not stand for modules.
    del sys.path[0]
    from launch import LaunchDescription, LaunchService
    from launch.actions import IncludeLaunchDescription, RegisterEventHandler
    from launch.event_handlers import OnProcessExit, OnProcessIO, OnProcessStart
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    events, launch, *given = argv
    notes = Notes(events)
    handlers = [
        OnProcessStart(on_start=notes.start),
        OnProcessIO(on_stderr=notes.hear),
        OnProcessExit(on_exit=notes.end),
    ]
    arguments = [(name, value) for name, _, value in (word.partition(":=") for word in given)]
    description = LaunchDescription(
        [
            *(RegisterEventHandler(one) for one in handlers),
            IncludeLaunchDescription(
                AnyLaunchDescriptionSource(launch), launch_arguments=arguments
            ),
        ]
    )
    service = LaunchService(argv=given)
    service.include_launch_description(description)
    return int(service.run())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
