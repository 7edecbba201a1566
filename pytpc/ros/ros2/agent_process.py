"""The side of pytpc that speaks to the agent (`pytpc.ros.ros2.agent.node`), a node of ROS 2."""

from __future__ import annotations

import contextlib
import itertools
import json
import os
import struct
import subprocess
import tempfile
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from pytpc.base.errors import MissingToolError, RunError
from pytpc.ros.ros2 import interpreter
from pytpc.ros.ros2.address import Ros2Address
from pytpc.ros.ros2.connections import connections_of
from pytpc.ros.ros2.discovery import Discovery
from pytpc.ros.source import Source
from pytpc.static.wiring import Connections

AT_A_TIME = 16
"""How many nodes are asked at a time: one that hangs holds up few others."""
# Without the folder of the caller, whose files may have the names of modules.
_BOOT = (
    "import sys; sys.path[0] = sys.argv[1]; from agent.node import main; del sys.path[0]; main()"
)
_LENGTHS = struct.Struct("<II")
_TIME = struct.Struct("<q")
_START_S = 30.0
_ANSWER_S = 10.0
_END_S = 5.0
_FOUND_S = 1.5

Head = dict[str, Any]


@dataclass(frozen=True)
class Graph:
    """What is on the graph.

    Attributes:
        nodes: full names, without the agent's.
        topics: their types.
        clock: how many publish /clock.
        subscribers: of each topic that the agent publishes.
        publishers: of each topic that it is subscribed to.
    """

    nodes: tuple[str, ...] = ()
    topics: Mapping[str, Sequence[str]] = field(default_factory=dict)
    clock: int = 0
    subscribers: Mapping[str, int] = field(default_factory=dict)
    publishers: Mapping[str, int] = field(default_factory=dict)


Take = Callable[[Head, bytes], None]
"""What takes an answer: its head, which is empty if the agent has ended, and its body."""


@dataclass(slots=True)
class _Answer:
    """An answer that somebody waits for."""

    come: threading.Event = field(default_factory=threading.Event)
    head: Head = field(default_factory=dict)
    body: bytes = b""

    def take(self, head: Head, body: bytes) -> None:
        """It has come."""
        self.head, self.body = head, body
        self.come.set()


class Agent:
    """A node on a graph of ROS 2, which another interpreter runs.

    Args:
        address: of the graph.
        env: the environment of the user.

    Attributes:
        patience_s: how long to wait for other nodes: longer where this one has started slowly.

    Raises:
        MissingToolError: no interpreter has rclpy.
        RunError: the node cannot be made; one line with the reason.
    """

    def __init__(self, address: Ros2Address, env: Mapping[str, str] | None = None) -> None:
        """Start it and wait until it is a node."""
        self.address = address
        self.graph = Graph()
        self.lost: Counter[str] = Counter()
        self.untaken: dict[str, str] = {}
        self.about: Head = {}
        self._numbers = itertools.count()
        self._answers: dict[int, Take] = {}
        self._sources: dict[bytes, Source] = {}
        self._messages: deque[tuple[Source, int, bytes]] = deque()
        self._come = threading.Condition()
        self._sending = threading.Lock()
        self._seen = threading.Event()
        self._ended = threading.Event()
        self._closing = False
        self._frames = 0
        self._said: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed by `close`
        start = time.monotonic()
        self._process = self._started(os.environ if env is None else env)
        began = time.monotonic()
        self._discovery = Discovery(began, took_s=began - start)
        self.patience_s = self._discovery.patience_s
        self._thread = threading.Thread(target=self._read, name="agent", daemon=True)
        self._thread.start()

    @property
    def fault(self) -> str:
        """What became of the agent, empty while it works."""
        if not self._ended.is_set() or self._closing:
            return ""
        return f"the node of ROS 2 that pytpc runs has ended{_colon(self._last_words())}"

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, int, bytes]]:
        """Wait for messages, and yield those that came: with the time of their source (ns)."""
        with self._come:
            if not self._messages and not self._ended.is_set():
                self._come.wait(timeout_s)
        for _ in range(len(self._messages)):
            yield self._messages.popleft()

    def subscribe(self, topic: str, kind: str = "", *, history: bool | None = False) -> None:
        """Receive a topic, as soon as its type is known.

        ``history``: what was sent before, too; None: if its publishers keep that, and with
        whatever quality of service they offer.
        """
        self._send({"op": "subscribe", "topic": topic, "type": kind, "history": history})

    def source_of(self, topic: str) -> Source | None:
        """Where the messages of a topic come from; None before it is subscribed to."""
        return next((one for one in list(self._sources.values()) if one.topic == topic), None)

    def advertise(self, topics: Mapping[str, str]) -> None:
        """Become a publisher of these topics, given with their types."""
        for topic, kind in topics.items():
            self._send({"op": "advertise", "topic": topic, "type": kind})

    def publish(self, topic: str, message: bytes) -> None:
        """Publish a message of a topic that is advertised."""
        self._send({"op": "publish", "topic": topic}, message)

    def wait_for_graph(self, enough: Callable[[Graph], bool] = lambda _: True) -> Graph:
        """The graph, after the time that others have to be found since the agent began.

        If it is not ``enough`` by then, it waits until `Discovery` says that nobody else is there.
        """
        self._ended.wait(max(0.0, self._discovery.began_s + _FOUND_S - time.monotonic()))
        while not self.has_found(enough) and not self._ended.is_set():
            self._ended.wait(0.1)
        return self.graph

    def has_found(self, enough: Callable[[Graph], bool]) -> bool:
        """Whether the graph is ``enough``, or by `Discovery` nobody else is there."""
        return enough(self.graph) or time.monotonic() >= self._discovery.until_s

    def values(self, node: str) -> bytes:
        """All parameters of a node, as a serialized rcl_interfaces/ParameterEvent.

        Raises:
            RunError: it does not answer.
        """
        return self._call({"op": "values", "node": node})[1]

    def values_later(self, node: str, take: Take) -> None:
        """Have ``take`` called with `values`, by another thread, as soon as the node answers.

        If the node goes before it has answered, the head has an ``error``.

        Raises:
            RunError: the agent has ended.
        """
        self._later({"op": "values", "node": node, "patience": None}, take)

    def set(
        self, node: str, parameters: Sequence[tuple[str, int, object]]
    ) -> list[tuple[bool, str]]:
        """Set parameters (name, type of rcl_interfaces/ParameterType, value) of a node.

        Returns:
            For each whether the node took it, and if not, why.

        Raises:
            RunError: it does not answer.
        """
        head, _ = self._call({"op": "set", "node": node, "parameters": list(parameters)})
        return [(bool(taken), str(why)) for taken, why in head["results"]]

    def _later(self, head: Head, take: Take) -> None:
        number = next(self._numbers)
        self._answers[number] = take
        self._send({**head, "id": number})

    def _call(self, head: Head) -> tuple[Head, bytes]:
        """``ask`` for what another node has to answer, by up to two calls."""
        head = {**head, "patience": self.patience_s}
        return self.ask(head, 2 * self.patience_s + _ANSWER_S)

    def ask(self, head: Head, patience_s: float = _ANSWER_S) -> tuple[Head, bytes]:
        """Ask the agent, and wait for its answer: so long, and while it is not silent.

        Raises:
            RunError: there is none, or it is an error.
        """
        number, answer = next(self._numbers), _Answer()
        self._answers[number] = answer.take
        try:
            self._send({**head, "id": number})
            frames = -1
            while not answer.come.is_set() and frames != self._frames:
                frames = self._frames
                answer.come.wait(patience_s)
            if not answer.head:
                raise RunError(self.fault or "ROS 2 does not answer in time")
        finally:
            self._answers.pop(number, None)
        if "error" in answer.head:
            raise RunError(str(answer.head["error"]))
        return answer.head, answer.body

    def connections(self) -> Connections:
        """All topics and services of the graph with their nodes, without the agent.

        Raises:
            RunError: the agent has ended.
        """
        return connections_of(self.ask({"op": "connections"})[0])

    def connections_later(self, take: Callable[[Connections | None], None]) -> None:
        """Have ``take`` called with `connections` by another thread; None: they could not be had.

        Raises:
            RunError: the agent has ended.
        """
        self._later(
            {"op": "connections"},
            lambda head, _: take(connections_of(head) if "topics" in head else None),
        )

    def drain(self) -> None:
        """Have all messages that have come to this machine be in ``poll``.

        Raises:
            RunError: the agent has ended.
        """
        self.ask({"op": "drain"})

    def close(self) -> None:
        """Leave the graph."""
        self._closing = True
        with contextlib.suppress(RunError):
            self._send({"op": "end"})
        with contextlib.suppress(OSError):
            if self._process.stdin is not None:
                self._process.stdin.close()
        try:
            self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._thread.join(_END_S)
        if self._process.stdout is not None:
            self._process.stdout.close()
        self._said.close()

    def _started(self, env: Mapping[str, str]) -> subprocess.Popen[bytes]:
        tried = []
        for python, its_env in interpreter.interpreters(env):
            process = self._popen(python, its_env)
            head = self._first(process)
            if head.get("ev") == "ready":
                self.about = head
                return process
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()
            why = str(head.get("error") or self._last_words() or "it says nothing")
            if not head.get("missing"):
                raise RunError(f"{self.address.words}: {_explained(why, self.address)}")
            tried.append(f"{python}: {why}")
        self._said.close()
        said = f" (tried {'; '.join(tried)})" if tried else ""
        raise MissingToolError(f"no Python with rclpy is found{said}; {interpreter.HOW_TO}")

    def _popen(self, python: str, env: Mapping[str, str]) -> subprocess.Popen[bytes]:
        try:
            return subprocess.Popen(
                [python, "-c", _BOOT, str(Path(__file__).parent)],
                env=self.address.env(env),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._said,
                # A Ctrl-C in the terminal does not reach another session.
                start_new_session=True,
            )
        except OSError as error:
            raise MissingToolError(f"{python} cannot be started: {error.strerror}") from error

    @staticmethod
    def _first(process: subprocess.Popen[bytes]) -> Head:
        """The agent's first frame; empty if there is none in time."""
        timer = threading.Timer(_START_S, process.kill)
        timer.start()
        try:
            found = _frame(process)
        finally:
            timer.cancel()
        return {} if found is None else dict(json.loads(found[0]))

    def _read(self) -> None:
        try:
            while (found := _frame(self._process)) is not None:
                head, body = found
                self._frames += 1
                source = self._sources.get(head)
                if source is None:
                    self._hear(dict(json.loads(head)), body)
                    continue
                (stamp,) = _TIME.unpack_from(body)
                self._messages.append((source, stamp, body[_TIME.size :]))
                if len(self._messages) == 1:
                    with self._come:
                        self._come.notify_all()
        except (OSError, ValueError):
            # Closed, or cut off.
            pass
        finally:
            self._ended.set()
            for number in list(self._answers):
                if (take := self._answers.pop(number, None)) is not None:
                    take({}, b"")
            with self._come:
                self._come.notify_all()

    def _hear(self, head: Head, body: bytes) -> None:
        event = head.pop("ev", "")
        if event == "graph":
            nodes = tuple(head.pop("nodes"))
            self._discovery.changed_s = time.monotonic()
            self.graph = Graph(nodes, **head)
        elif event == "subscribed":
            number = json.dumps({"m": head["number"]}).encode()
            self._sources[number] = Source(head["topic"], "", head["type"], "", head["definition"])
        elif event == "untaken":
            self.untaken[head["topic"]] = head["why"]
        elif event == "lost":
            self.lost[head["topic"]] += head["count"]
        elif (
            event == "answer" and (take := self._answers.pop(head.get("id", -1), None)) is not None
        ):
            take(head, body)

    def _send(self, head: Head, body: bytes = b"") -> None:
        """Send a frame.

        Raises:
            RunError: the agent has ended.
        """
        data = json.dumps(head).encode()
        assert self._process.stdin is not None, "it is a pipe"
        try:
            with self._sending:
                self._process.stdin.write(_LENGTHS.pack(len(data), len(body)) + data + body)
                self._process.stdin.flush()
        except (OSError, ValueError) as error:
            self._ended.wait(1.0)
            raise RunError(self.fault or "ROS 2 is not connected any more") from error

    def _last_words(self) -> str:
        """The last line that the agent wrote to standard error."""
        with contextlib.suppress(OSError, ValueError):
            self._said.seek(0)
            lines = self._said.read().decode("utf-8", "replace").split("\n")
            return next((line.strip() for line in reversed(lines) if line.strip()), "")
        return ""


def _frame(process: subprocess.Popen[bytes]) -> tuple[bytes, bytes] | None:
    """The next head and body; None at the end."""
    stream = process.stdout
    assert stream is not None, "it is a pipe"
    lengths = stream.read(_LENGTHS.size)
    if len(lengths) < _LENGTHS.size:
        return None
    head_size, body_size = _LENGTHS.unpack(lengths)
    head, body = stream.read(head_size), stream.read(body_size)
    return (head, body) if len(head) == head_size and len(body) == body_size else None


def _explained(why: str, address: Ros2Address) -> str:
    rmw = dict(address.settings).get("RMW_IMPLEMENTATION", "")
    if rmw and (rmw in why or "rmw" in why.lower()):
        return (
            f"RMW_IMPLEMENTATION={rmw} is not installed; unset it, or install it"
            f" (ros-DISTRO-{rmw.replace('_', '-')})"
        )
    return f"no node can be made: {why}"


def _colon(text: str) -> str:
    return f": {text}" if text else ""
