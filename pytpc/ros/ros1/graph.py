"""A real ROS 1 graph: a master on a free port, rosout, and the processes that are started in it.

Everything that a graph starts is ended with it, the children of its children too: roslaunch puts
each node into a session of its own, so a graph knows its processes by a word in their environment.
"""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import socket
import subprocess
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING

from pytpc.base.errors import MissingToolError, RunError
from pytpc.base.signals import Stop, end_group, signals_end
from pytpc.ros.left_processes import GRAPH_WORD, end_processes
from pytpc.ros.ros1.master import Master

if TYPE_CHECKING:
    from typing_extensions import Self

_CALLER = "/tpc_graph"
_START_TRIES = 3
_MASTER_PATIENCE_S = 15.0
_TAIL_BYTES = 16384
# roslaunch also sets the title of the terminal.
_COLOUR = re.compile(r"\x1b\[[0-9;]*m|\x1b\]2;[^\x07]*\x07")
# roslaunch ends with status 0, however a required node ended.
_REQUIRED_DIED = re.compile(r"REQUIRED process \[[^\]]*\] has died!\s+process has died")
_TELLING = re.compile(r"has died|FATAL|Exception|[Ee]rror|ERROR|not found|cannot", re.ASCII)
# What roslaunch says after an exception: the element of the launch file, and where its log is.
_END_OF_DETAILS = re.compile(r"^XML is|^The traceback|has died|Exception:")
_MOST_DETAILS = 6
_ROSOUT = "lib/rosout/rosout"


@dataclass(frozen=True, slots=True)
class GraphProcess:
    """One process that a graph started.

    ``log`` has both of its output streams. ``may_end``: that it ends with status 0 is no error.
    """

    name: str
    popen: subprocess.Popen[bytes]
    log: Path
    patience_s: float
    may_end: bool = False

    @property
    def has_ended_well(self) -> bool:
        """True where it may end, and did with status 0, and so did what ended it."""
        is_over = self.may_end and self.popen.poll() == 0
        return is_over and _REQUIRED_DIED.search(self._end_of_log()) is None

    def tail(self, lines: int = 3) -> list[str]:
        """The last lines of its output; those about errors if there are any.

        Colours and the terminal's title are left out.
        """
        # roslaunch underlines with equals signs, some of them on the line itself.
        said = [line.strip("= \t") for line in self._end_of_log().splitlines()]
        said = [line for line in said if line]
        told: list[str] = []
        number = 0
        while number < len(said):
            if _TELLING.search(said[number]):
                line, number = _with_details(said, number)
                told.append(line)
            else:
                number += 1
        return told[-lines:] or said[-lines:]

    def _end_of_log(self) -> str:
        try:
            with self.log.open("rb") as stream:
                stream.seek(0, os.SEEK_END)
                stream.seek(max(0, stream.tell() - _TAIL_BYTES))
                text = stream.read().decode("utf-8", "replace")
        except OSError:
            return ""
        return without_colours(text)


def _with_details(said: Sequence[str], number: int) -> tuple[str, int]:
    """A line of output, with those that it announces by a colon, as roslaunch does; and the number
    of the line after these.

    For a broken YAML file, these have the file, the line in it, and what is wrong with it.
    """
    line = said[number]
    if not line.endswith(":"):
        return line, number + 1
    details = list(
        takewhile(lambda one: not _END_OF_DETAILS.search(one), said[number + 1 :][:_MOST_DETAILS])
    )
    # An arrow below a line of the file points at nothing when all stands on one line.
    text = " ".join([line, *(one for one in details if one != "^")])
    return text, number + 1 + len(details)


class RosGraph:
    """A context manager: the graph stands from ``with`` to its end.

    Args:
        env: the environment of an installed workspace (``pytpc.build.build.workspace_env``).
        folder: for ROS's home, its logs and the output of all processes; made where missing.
        use_sim_time: set ``/use_sim_time`` before any node starts.
        stop: what the caller does at a signal: it ends the graph itself. Without it, SIGTERM and
            SIGHUP raise SystemExit as long as the graph stands.
        inherited: descriptors that the processes of the graph hold, too, such as a lock.

    Raises:
        RunError: on entering, when the master does not come up.
        MissingToolError: on entering, when rosmaster is not installed.
    """

    def __init__(
        self,
        env: Mapping[str, str],
        folder: Path,
        *,
        use_sim_time: bool = False,
        stop: Stop | None = None,
        inherited: Sequence[int] = (),
    ) -> None:
        self.folder = folder.absolute()
        self.uri = ""
        self._word = secrets.token_hex(8)
        self._base_env = dict(env)
        self._use_sim_time = use_sim_time
        self._stop = stop
        self._inherited = tuple(inherited)
        self._unhurried: list[GraphProcess] = []
        self._processes: list[GraphProcess] = []
        self._exits = contextlib.ExitStack()

    @property
    def env(self) -> dict[str, str]:
        """The environment in which processes of this graph run."""
        return {
            **self._base_env,
            "ROS_MASTER_URI": self.uri,
            "ROS_IP": "127.0.0.1",
            "ROS_HOME": str(self.folder / "home"),
            "ROS_LOG_DIR": str(self.folder / "log"),
            "PYTHONUNBUFFERED": "1",
            GRAPH_WORD: self._word,
        }

    def __enter__(self) -> Self:
        for name in ("home", "log", "out"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        with contextlib.ExitStack() as exits:
            if self._stop is None:
                exits.enter_context(signals_end())
            exits.callback(self._end)
            self._start_master()
            if self._use_sim_time:
                self.call("setParam", "/use_sim_time", True)
            self.start("rosout", [self._rosout()])
            self._exits = exits.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._exits.close()

    def start(
        self,
        name: str,
        argv: Sequence[str],
        *,
        env: Mapping[str, str] | None = None,
        patience_s: float = 5.0,
        may_end: bool = False,
    ) -> GraphProcess:
        """Start a process in the graph.

        Args:
            name: for messages and for the file of its output.
            argv: program and arguments.
            env: added to the graph's environment.
            patience_s: how long it may take to end after SIGINT.
            may_end: that it ends by itself with status 0 is no error.

        Raises:
            MissingToolError: there is no such program.
        """
        log = self.folder / "out" / f"{name}.log"
        environment = {**self.env, **(env or {})}
        with log.open("wb") as stream:
            try:
                popen = subprocess.Popen(
                    list(argv),
                    env=environment,
                    cwd=self.folder,
                    stdin=subprocess.DEVNULL,
                    stdout=stream,
                    stderr=subprocess.STDOUT,
                    start_new_session=True,
                    pass_fds=self._inherited,
                )
            except FileNotFoundError as error:
                raise MissingToolError(f"{argv[0]} not found: is ROS 1 installed?") from error
            except OSError as error:
                raise RunError(f"{argv[0]} cannot be started: {error.strerror}") from error
        process = GraphProcess(name, popen, log, patience_s, may_end)
        self._processes.append(process)
        return process

    def never_hurry(self, process: GraphProcess) -> None:
        """Let a process have its patience to end, even if the user asks twice to stop."""
        self._unhurried.append(process)

    def check(self) -> None:
        """Check that all processes still run, except those that may end.

        Raises:
            RunError: one has ended; the message has its status and what it said last.
        """
        for process in self._processes:
            status = process.popen.poll()
            if status is not None and not process.has_ended_well:
                said = "; ".join(process.tail()) or "it says nothing"
                raise RunError(f"{process.name} ended with status {status}: {said}", process.log)

    def stop(self, process: GraphProcess) -> int:
        """End one process: SIGINT, after its patience SIGTERM, then SIGKILL.

        Returns:
            Its exit status.
        """
        if process in self._processes:
            self._processes.remove(process)

        def hurry() -> bool:
            in_a_hurry = self._stop is not None and self._stop.in_a_hurry
            return in_a_hurry and process not in self._unhurried

        return end_group(process.popen, process.patience_s, 3.0, hurry)

    def call(self, method: str, *arguments: object) -> object:
        """Call a method of ROS's master API, which gives code, message and value.

        Raises:
            RunError: the master does not answer, or says no.
        """
        return Master(self.uri, _CALLER).call(method, *arguments)

    def _rosout(self) -> str:
        """The program of ROS that gathers log messages, where this ROS has it."""
        prefixes = self._base_env.get("CMAKE_PREFIX_PATH", "").split(os.pathsep)
        places = [Path(prefix) / _ROSOUT for prefix in (*prefixes, "/usr") if prefix]
        return str(next((place for place in places if place.is_file()), places[-1]))

    def _start_master(self) -> None:
        for attempt in range(_START_TRIES):
            port = _free_port()
            self.uri = f"http://127.0.0.1:{port}"
            master = self.start("rosmaster", ["rosmaster", "--core", "-p", str(port)])
            try:
                self._wait_for_master()
                return
            except RunError:
                # Another program may have taken the port in between.
                self.stop(master)
                if attempt == _START_TRIES - 1:
                    raise

    def _wait_for_master(self) -> None:
        until = time.monotonic() + _MASTER_PATIENCE_S
        while True:
            self.check()
            try:
                self.call("getPid")
                return
            except RunError:
                if time.monotonic() > until:
                    raise
            time.sleep(0.05)

    def _end(self) -> None:
        for process in reversed(list(self._processes)):
            self.stop(process)
        end_processes(self._word)


def without_colours(text: str) -> str:
    """The output of roslaunch without colours and the terminal's title."""
    return _COLOUR.sub("", text)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
