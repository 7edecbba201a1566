"""Marking on a live graph, or on a bag that is replayed into one."""

from __future__ import annotations

import contextlib
import os
import secrets
import threading
import time
from collections.abc import Callable

from pytpc.base.errors import RunError
from pytpc.ingest.ros1 import decode_time
from pytpc.recording.graph_places import places_of
from pytpc.recording.marking_session import View
from pytpc.ros.held_marks import HeldMarks, times_and_note
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.publisher import (
    STRING,
    TIME,
    MessageType,
    RawPublisher,
    encode_string,
    encode_time,
)
from pytpc.ros.ros1.subscriber import UnregisteredSubscriber

_CLOCK = "/clock"
_LOOK_S = 1.0
# A recorder that looks for new topics finds those of this node within a second, as rosbag's does.
_FOUND_S = 1.5
# How long messages wait for subscribers that the master knows and that have not connected yet.
_CONNECTED_S = 5.0
# How old the places to choose from may be.
_PLACES_S = 5.0


class GraphMarks(HeldMarks):
    """The side of a marking session that speaks to a graph. It goes on without a master.

    A new node has no subscribers for a moment: a recorder has to find its topics and to connect. So
    its first messages wait for those that the master knows, for some seconds at most. A mark has
    the time at which the key was pressed, so that it may arrive late.

    Args:
        master: URI of the ROS master.
        observer: namespace of the topics, empty for none.
        what: what the observer is doing, for the title.
        advertise: become a node of the graph at once, else with the first mark.
    """

    def __init__(
        self, master: str, observer: str, what: str = "marking", *, advertise: bool = True
    ) -> None:
        super().__init__(observer, what)
        self._master = Master(master, f"/tpc_mark_{os.getpid()}_{secrets.token_hex(3)}")
        self._advertise = advertise
        self._publisher: RawPublisher | None = None
        self._new = _NewNode()
        self._placed_at = 0.0
        self._fault = f"waiting for the ROS master at {master}"
        self._simulated = False
        self._clock_ns: int | None = None
        self._clock = _Clock(self._master, self._hear)
        self._ended = False
        self._wake = threading.Event()
        self._looked = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()
        self._looked.wait(3.0)

    def now_ns(self) -> int | None:
        """See `HeldMarks`."""
        if self._clock_ns is None and not self._simulated:
            return time.time_ns()
        return self._clock_ns

    def view(self) -> View:
        """The title and state of the connection, and the time."""
        listeners = self._publisher.listeners() if self._publisher is not None else ()
        heard = self._heard(len(listeners))
        return self._view(
            self._master.uri,
            self._fault,
            heard if self._advertise else "listeners are found with the first mark",
            is_simulated=self._clock_ns is not None,
        )

    @property
    def _waits(self) -> bool:
        return self._new.waits

    def close(self) -> None:
        """Leave the graph."""
        self._send_last()
        self._ended = True
        self._wake.set()
        self._thread.join(0.5)
        self._clock.close()
        if self._publisher is not None:
            self._publisher.close()

    def _publish(self, topic: str, content: int | str) -> None:
        super()._publish(topic, content)
        if not self._advertise:
            self._advertise = True
            self._new.begin()
            self._wake.set()

    def _sent(self, topic: str, content: int | str) -> int:
        if self._publisher is None:
            return 0
        message = encode_time(content) if isinstance(content, int) else encode_string(content)
        return self._publisher.publish(topic, message)

    def _watch(self) -> None:
        """Look every second at the master, and register at one that does not know us."""
        while not self._ended:
            try:
                self._look()
                self._fault = ""
            except RunError as error:
                if self._publisher is None and self._advertise:
                    self._fault = str(error)
                elif not self._fault:
                    self._fault = (
                        "the ROS master is gone: marks go to the nodes that are still connected"
                    )
            self._looked.set()
            self._wake.wait(_LOOK_S)
            self._wake.clear()

    def _look(self) -> None:
        if self._advertise and self._publisher is None:
            self._publisher = RawPublisher(self._master, _topics(self._observer))
        if self._fault:
            self._simulated = self._master.has_sim_time()
        self._clock.look()
        if self._publisher is not None and not self._publisher.is_registered():
            self._new.begin()
            self._publisher.register()
            self._simulated = self._master.has_sim_time()
        if self._publisher is not None:
            self._new.look(self._master, self._publisher)
            # A terminal that is stopped keeps no mark back.
            self.tick()
        if time.monotonic() >= self._placed_at + _PLACES_S:
            # Without them an observer can still type a name.
            with contextlib.suppress(RunError):
                self._places = places_of(self._master.connections())
            self._placed_at = time.monotonic()

    def _hear(self, message: bytes) -> None:
        try:
            self._clock_ns = decode_time(message)
        except ValueError as error:
            self._fault = f"{_CLOCK}: {error}"


class _NewNode:
    """Whom the messages of a new node wait for: the subscribers that the master knows."""

    def __init__(self) -> None:
        self._since: float | None = None
        self._all_there = False

    @property
    def waits(self) -> bool:
        """Whether messages wait: not before the node is new, and not for longer than they may."""
        limit = _FOUND_S + _CONNECTED_S
        is_new = self._since is not None and time.monotonic() < self._since + limit
        return is_new and not self._all_there

    def begin(self) -> None:
        """The node registers now; for one that did before, nobody is waited for again."""
        self._since = self._since or time.monotonic()

    def look(self, master: Master, publisher: RawPublisher) -> None:
        """See whether the subscribers that the master knows have connected.

        Raises:
            RunError: the master does not answer.
        """
        if not self.waits or time.monotonic() < (self._since or 0.0) + _FOUND_S:
            return
        known = master.state().subscribers
        self._all_there = all(
            publisher.listeners(topic).issuperset(known.get(topic, ()))
            for topic in publisher.topics
        )


def _topics(observer: str) -> dict[str, MessageType]:
    """The topics of an observer's marks."""
    times, note = times_and_note(observer)
    return {**dict.fromkeys(times, TIME), note: STRING}


class _Clock:
    """Listens to /clock in a thread of its own."""

    def __init__(self, master: Master, on_message: Callable[[bytes], None]) -> None:
        self._on_message = on_message
        self._ended = threading.Event()
        self._subscriber = UnregisteredSubscriber(master, [_CLOCK])
        self.look = self._subscriber.look
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()
        self._subscriber.close()

    def _listen(self) -> None:
        while not self._ended.is_set():
            for _, message in self._subscriber.poll(0.2):
                self._on_message(message)
