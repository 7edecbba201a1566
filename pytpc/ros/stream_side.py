"""The side of `pytpc stream` that speaks to the graph: it hears marks and the clock, and publishes
diagnostics."""

from __future__ import annotations

import contextlib
import os
import secrets
import threading
import time
from collections.abc import Iterator, Sequence
from typing import Protocol

from pytpc.base.errors import RunError
from pytpc.ingest.decoders import ROS1, ROS2, Decoders
from pytpc.recording.marks import Mark, MarkMessages
from pytpc.ros import diagnostic_messages
from pytpc.ros.diagnostic_messages import DIAGNOSTICS, DiagnosticStatus
from pytpc.ros.intake import CLOCK
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.publisher import RawPublisher
from pytpc.ros.ros1.subscriber import UnregisteredSubscriber
from pytpc.ros.ros2.address import Ros2Address, is_ros2
from pytpc.ros.ros2.agent_process import Agent
from pytpc.ros.source import Source

_LOOK_S = 1.0
_POLL_S = 0.2
_CLOCK_TYPE = "rosgraph_msgs/msg/Clock"
_STD = "std_msgs/msg/"
_MOST_TOPICS = 200
_NO_MESSAGES = (
    "nothing is published on /diagnostics yet: if this stays, ROS 2 here has no diagnostic_msgs"
    " (apt install ros-DISTRO-diagnostic-msgs)"
)


class _Graph(Protocol):
    """What is different in ROS 1 and 2."""

    decoders: Decoders
    ros: int

    def look(self) -> None:
        """Find new topics of marks; register again at a master that was restarted.

        Raises:
            RunError: the graph does not answer.
        """

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        """Messages of the clock and of marks."""

    def publish(self, message: bytes) -> None:
        """Publish on /diagnostics.

        Raises:
            RunError: it cannot be.
        """

    def has_clock(self) -> bool:
        """Whether time is simulated, also before it has begun."""

    def close(self) -> None:
        """Leave the graph."""


class StreamSide:
    """Hears the marks of all observers, and the clock; publishes diagnostics if asked to.

    It goes on while the graph is gone.

    Args:
        address: a ROS 1 master's URI or ``ros2://DOMAIN``.
        publishes: become a publisher of /diagnostics.

    Raises:
        TpcError: ROS 2 does not work here, or nobody can connect to this machine.
    """

    def __init__(self, address: str, *, publishes: bool) -> None:
        """Listen in a thread of its own."""
        make = _Ros2Graph if is_ros2(address) else _Ros1Graph
        self._graph: _Graph = make(address, publishes=publishes)
        self._marks = MarkMessages()
        self._clock_ns: int | None = None
        self._seq = 0
        self._lock = threading.Lock()
        self.fault = ""
        self._ended = threading.Event()
        self._threads = [
            threading.Thread(target=one, daemon=True) for one in (self._listen, self._keep_looking)
        ]
        for thread in self._threads:
            thread.start()

    def now_ns(self) -> int | None:
        """The graph's time; None while a simulated clock has not begun."""
        if self._clock_ns is None and self._graph.has_clock():
            return None
        return time.time_ns() if self._clock_ns is None else self._clock_ns

    def marks(self) -> tuple[Mark, ...]:
        """The marks so far that were not undone."""
        with self._lock:
            return self._marks.marks()

    def publish(self, statuses: Sequence[DiagnosticStatus]) -> None:
        """Publish the state of all things, at the graph's time."""
        now_ns = self.now_ns()
        message = diagnostic_messages.encode(statuses, now_ns or 0, self._seq, self._graph.ros)
        self._seq += 1
        with contextlib.suppress(RunError):
            self._graph.publish(message)

    def close(self) -> None:
        """Leave the graph."""
        self._ended.set()
        for thread in self._threads:
            thread.join(5.0)
        self._graph.close()

    def _listen(self) -> None:
        while not self._ended.is_set():
            for source, data in self._graph.poll(_POLL_S):
                # A message that is none says nothing.
                with contextlib.suppress(ValueError):
                    self._hear(source.topic, data)

    def _hear(self, topic: str, data: bytes) -> None:
        decoders = self._graph.decoders
        if topic == CLOCK:
            self._clock_ns = decoders.time(data)
            return
        with self._lock:
            if MarkMessages.message_type(topic) == "String":
                self._marks.add_text(topic, decoders.text(data).decode("utf-8", "replace"))
            else:
                self._marks.add_time(topic, decoders.time(data) or self.now_ns() or 0)

    def _keep_looking(self) -> None:
        while not self._ended.is_set():
            try:
                self._graph.look()
                self.fault = ""
            except RunError as error:
                self.fault = str(error)
            self._ended.wait(_LOOK_S)


class _MarkSubscriber(UnregisteredSubscriber):
    """Receives the clock and every topic of marks that anybody publishes."""

    def look(self) -> None:
        published = self._master.state().publishers
        with self._lock:
            room = _MOST_TOPICS - len(self._wanted)
            new = [topic for topic in sorted(published) if MarkMessages.message_type(topic)]
            for topic in [one for one in new if one not in self._wanted][: max(0, room)]:
                self._wanted[topic] = set()
        super().look()


class _Ros1Graph:
    decoders = ROS1
    ros = 1

    def __init__(self, address: str, *, publishes: bool) -> None:
        self._master = Master(address, f"/tpc_stream_{os.getpid()}_{secrets.token_hex(3)}")
        self._subscriber = _MarkSubscriber(self._master, [CLOCK])
        self._publisher: RawPublisher | None = None
        if publishes:
            topics = {DIAGNOSTICS: diagnostic_messages.ros1_type()}
            self._publisher = RawPublisher(self._master, topics)
        self._is_simulated = False
        self.poll = self._subscriber.poll

    def look(self) -> None:
        self._is_simulated = self._master.has_sim_time()
        if self._publisher is not None and not self._publisher.is_registered():
            self._publisher.register()
        self._subscriber.look()

    def publish(self, message: bytes) -> None:
        if self._publisher is not None:
            self._publisher.publish(DIAGNOSTICS, message)

    def has_clock(self) -> bool:
        return self._is_simulated

    def close(self) -> None:
        self._subscriber.close()
        if self._publisher is not None:
            self._publisher.close()


class _Ros2Graph:
    decoders = ROS2
    ros = 2

    def __init__(self, address: str, *, publishes: bool) -> None:
        self._agent = Agent(Ros2Address.parse(address))
        self._heard: set[str] = set()
        self._publishes = publishes
        if publishes:
            self._agent.advertise({DIAGNOSTICS: diagnostic_messages.ROS2_TYPE})
        self._agent.subscribe(CLOCK, _CLOCK_TYPE)

    def look(self) -> None:
        if self._agent.fault:
            raise RunError(self._agent.fault)
        if self._publishes and DIAGNOSTICS not in self._agent.graph.subscribers:
            raise RunError(_NO_MESSAGES)
        for topic in sorted(self._agent.graph.topics):
            kind = MarkMessages.message_type(topic)
            if kind is None or topic in self._heard or len(self._heard) >= _MOST_TOPICS:
                continue
            self._heard.add(topic)
            named = "builtin_interfaces/msg/Time" if kind == "Time" else f"{_STD}String"
            self._agent.subscribe(topic, named, history=None)

    def poll(self, timeout_s: float) -> Iterator[tuple[Source, bytes]]:
        if self._agent.fault:
            time.sleep(timeout_s)
        for source, _, data in self._agent.poll(timeout_s):
            yield source, data

    def publish(self, message: bytes) -> None:
        self._agent.publish(DIAGNOSTICS, message)

    def has_clock(self) -> bool:
        return bool(self._agent.graph.clock)

    def close(self) -> None:
        self._agent.close()
