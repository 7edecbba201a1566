"""Marking on a graph of ROS 2 that runs, or on a bag that is replayed into one."""

from __future__ import annotations

import contextlib
import struct
import time
from threading import Event, Thread

from pytpc.base.errors import RunError
from pytpc.ingest.ros2 import decode_time
from pytpc.recording.graph_places import places_of
from pytpc.recording.marking_session import View
from pytpc.ros.held_marks import HeldMarks, times_and_note
from pytpc.ros.intake import CLOCK
from pytpc.ros.ros2.address import Ros2Address
from pytpc.ros.ros2.agent_process import Agent, Graph
from pytpc.static.wiring import Connections

TIME = "builtin_interfaces/msg/Time"
STRING = "std_msgs/msg/String"
_CLOCK_TYPE = "rosgraph_msgs/msg/Clock"
_HEAD = b"\0\1\0\0"
_TIME = struct.Struct("<iI")
_TICK_S = 0.2
# How old the places to choose from may be.
_PLACES_S = 5.0


def encode_time(time_ns: int) -> bytes:
    """A builtin_interfaces/Time."""
    seconds, nanoseconds = divmod(time_ns, 10**9)
    return _HEAD + _TIME.pack(seconds, nanoseconds)


def encode_string(text: str) -> bytes:
    """A std_msgs/String."""
    data = text.encode("utf-8", "replace") + b"\0"
    return _HEAD + struct.pack("<I", len(data)) + data


class Ros2Marks(HeldMarks):
    """The side of a marking session that speaks to a graph of ROS 2.

    Its first messages wait for a recorder that has to find its topics, for some seconds at most.

    Args:
        address: of the graph.
        observer: namespace of the topics, empty for none.
        what: what the observer is doing, for the title.

    Raises:
        TpcError: ROS 2 does not work here.
    """

    def __init__(self, address: Ros2Address, observer: str, what: str = "marking") -> None:
        """Become a node of the graph."""
        super().__init__(observer, what)
        self._agent = Agent(address)
        times, note = times_and_note(observer)
        self._agent.advertise({**dict.fromkeys(times, TIME), note: STRING})
        self._agent.subscribe(CLOCK, _CLOCK_TYPE)
        self._since = time.monotonic()
        self._clock_ns: int | None = None
        self._places_at = 0.0
        self._placed: Graph | None = None
        self._is_asked = False
        self._ended = Event()
        self._thread = Thread(target=self._listen, name="clock", daemon=True)
        self._thread.start()
        self._agent.wait_for_graph()

    @property
    def _waits(self) -> bool:
        is_new = time.monotonic() < self._since + self._agent.patience_s
        return is_new and not self._listeners()

    def now_ns(self) -> int | None:
        """See `HeldMarks`."""
        if self._clock_ns is None and self._agent.graph.clock:
            return None
        return time.time_ns() if self._clock_ns is None else self._clock_ns

    def view(self) -> View:
        """The title, who listens, and the time."""
        return self._view(
            self._agent.address.words,
            self._agent.fault,
            self._heard(self._listeners()),
            is_simulated=self._clock_ns is not None,
        )

    def close(self) -> None:
        """Leave the graph, when those who listen have what was sent."""
        self._send_last()
        self._ended.set()
        self._thread.join()
        with contextlib.suppress(RunError):
            # What was published is on its way when the agent has done this.
            self._agent.drain()
        self._agent.close()

    def _listeners(self) -> int:
        return max(self._agent.graph.subscribers.values(), default=0)

    def _sent(self, topic: str, content: int | str) -> int:
        listeners = self._agent.graph.subscribers.get(topic, 0)
        if listeners:
            message = encode_time(content) if isinstance(content, int) else encode_string(content)
            try:
                self._agent.publish(topic, message)
            except RunError:
                return 0
        return listeners

    def _listen(self) -> None:
        while not self._ended.is_set():
            for source, _, data in self._agent.poll(_TICK_S):
                if source.topic == CLOCK:
                    with contextlib.suppress(ValueError):
                        self._clock_ns = decode_time(data)
            if self._agent.fault:
                self._ended.wait(_TICK_S)
            # A terminal that is stopped keeps no mark back.
            self.tick()
            self._look()

    def _look(self) -> None:
        """Ask for the places to choose from; the clock does not wait for them."""
        graph = self._agent.graph
        is_old = graph is not self._placed or time.monotonic() >= self._places_at
        if is_old and not self._is_asked:
            self._placed, self._is_asked = graph, True
            with contextlib.suppress(RunError):
                self._agent.connections_later(self._take_places)

    def _take_places(self, found: Connections | None) -> None:
        if found is not None:
            self._places = places_of(found)
        self._places_at = time.monotonic() + _PLACES_S
        self._is_asked = False
