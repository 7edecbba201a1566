"""The processes of a mission of ROS 2: launch with the nodes that it starts, or executables."""

from __future__ import annotations

import json
import os
import secrets
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from pytpc.base.errors import RunError
from pytpc.base.signals import end_group
from pytpc.ros.left_processes import GRAPH_WORD, end_processes
from pytpc.ros.mission_run import DiedNode

LOG = "launch.log"
_EVENTS = "launch_events.jsonl"
_LAUNCHER = Path(__file__).parent / "agent/launcher.py"
# launch waits for 5 s after SIGINT and as long after SIGTERM.
_LAUNCH_S = 12.0
_NODE_S = 5.0
_TERM_S = 3.0
_LINES = 5
_LONGEST = 300
_TAIL_BYTES = 16384


class StartedProcess(NamedTuple):
    """A process of a node: its number, its command line, and the folder that it began in."""

    pid: int
    words: tuple[str, ...]
    folder: Path


@dataclass(frozen=True)
class _Own:
    """A process that this one has started."""

    name: str
    popen: subprocess.Popen[bytes]
    log: Path


class Flight:
    """What a mission starts; all of it is ended by ``stop``.

    Args:
        env: the environment of the nodes.
        folder: ``ros`` in that of the mission: for ROS's logs and the output of all processes.
        inherited: descriptors that the processes hold, too, such as a lock.
    """

    def __init__(self, env: Mapping[str, str], folder: Path, inherited: Sequence[int] = ()) -> None:
        """Make the folders."""
        self._folder = folder.absolute()
        self._inherited = tuple(inherited)
        self._word = secrets.token_hex(8)
        for name in ("out", "log"):
            (self._folder / name).mkdir(parents=True, exist_ok=True)
        own = {"ROS_LOG_DIR": str(self._folder / "log"), "PYTHONUNBUFFERED": "1"}
        self._env = {**env, **own, GRAPH_WORD: self._word}
        self._events = self._folder / "out" / _EVENTS
        self._read_bytes = 0
        self._launch: _Own | None = None
        self._programs: list[_Own] = []
        self._told: set[int] = set()
        self.started: list[StartedProcess] = []

    def launch(self, python: Sequence[str], launch: Path, args: Mapping[str, str]) -> None:
        """Run a launch file by launch itself.

        Raises:
            RunError: the interpreter cannot be started.
        """
        given = [f"{name}:={value}" for name, value in sorted(args.items())]
        self._events.unlink(missing_ok=True)
        command = [*python, str(_LAUNCHER), str(self._events), str(launch.absolute()), *given]
        self._launch = self._popen("launch", command, self._folder / "out" / LOG)

    def execute(self, program: Path, command: Sequence[str]) -> None:
        """Run an executable by a command.

        Raises:
            RunError: it cannot be started.
        """
        count = sum(one.name.partition("-")[0] == program.name for one in self._programs)
        name = f"{program.name}-{count + 1}" if count else program.name
        own = self._popen(name, command, self._folder / "out" / f"{name}.log")
        self._programs.append(own)
        self.started.append(StartedProcess(own.popen.pid, tuple(command), Path.cwd()))

    @property
    def is_over(self) -> bool:
        """Whether all that was started has ended."""
        own = [*self._programs, *([self._launch] if self._launch else [])]
        return all(one.popen.poll() is not None for one in own)

    def failure(self) -> RunError | None:
        """Why launch could not run the file; None while it runs, or where it has ended well."""
        if self._launch is None or self._launch.popen.poll() in (None, 0):
            return None
        said = _tail(self._launch.log, 3)
        what = "; ".join(said) or "it says nothing"
        status = self._launch.popen.returncode
        return RunError(f"launch ended with status {status}: {what}", self._launch.log)

    def look(self) -> list[DiedNode]:
        """The nodes that died since the last call."""
        died = [*self._launched()]
        for one in self._programs:
            status = one.popen.poll()
            if status and one.popen.pid not in self._told:
                self._told.add(one.popen.pid)
                died.append(DiedNode(one.name, status, tuple(_tail(one.log, _LINES)), one.log))
        return died

    def stop(self, hurry: Callable[[], bool]) -> None:
        """End everything: SIGINT, after a while SIGTERM, then SIGKILL."""
        for one in self._programs:
            if one.popen.poll() is None:
                one.popen.send_signal(signal.SIGINT)
        if self._launch is not None:
            end_group(self._launch.popen, _LAUNCH_S, _TERM_S, hurry)
        until = time.monotonic() + _NODE_S
        for one in self._programs:
            end_group(one.popen, max(0.0, until - time.monotonic()), _TERM_S, hurry)
        end_processes(self._word)

    def _popen(self, name: str, command: Sequence[str], log: Path) -> _Own:
        with log.open("wb") as stream:
            try:
                popen = subprocess.Popen(
                    list(command),
                    env=self._env,
                    stdin=subprocess.DEVNULL,
                    stdout=stream,
                    stderr=subprocess.STDOUT,
                    start_new_session=True,
                    pass_fds=self._inherited,
                )
            except OSError as error:
                raise RunError(f"{command[0]} cannot be started: {error.strerror}") from error
        return _Own(name, popen, log)

    def _launched(self) -> Iterator[DiedNode]:
        """What the launcher has written down since the last call."""
        try:
            with self._events.open("rb") as stream:
                stream.seek(self._read_bytes)
                data = stream.read()
        except OSError:
            return
        whole = data[: data.rfind(b"\n") + 1]
        self._read_bytes += len(whole)
        for line in whole.splitlines():
            event = json.loads(line)
            if "started" in event:
                words, folder = tuple(map(str, event["words"])), Path(event["folder"])
                self.started.append(StartedProcess(int(event["pid"]), words, folder))
            elif event["status"] and not event["stopping"]:
                log = self._folder / "out" / LOG
                yield DiedNode(event["ended"], int(event["status"]), tuple(event["said"]), log)


def _tail(log: Path, lines: int) -> list[str]:
    """The last lines of a file that are not empty."""
    try:
        with log.open("rb") as stream:
            stream.seek(0, os.SEEK_END)
            stream.seek(max(0, stream.tell() - _TAIL_BYTES))
            text = stream.read().decode("utf-8", "replace")
    except OSError:
        return []
    return [line.strip()[:_LONGEST] for line in text.splitlines() if line.strip()][-lines:]
