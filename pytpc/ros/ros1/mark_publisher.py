"""Publishes marks on a ROS 1 graph, and knows its time; goes on without a master."""

from __future__ import annotations

import os
import secrets
import threading
import time
from collections.abc import Iterable

from pytpc.base.errors import RunError
from pytpc.ingest.ros1 import decode_time
from pytpc.ros.ros1.master import Master, own_host
from pytpc.ros.ros1.publisher import STRING, TIME, RawPublisher, encode_string, encode_time
from pytpc.ros.ros1.subscriber import RawSubscriber

_CLOCK = "/clock"
_LOOK_S = 1.0


class MarkPublisher:
    """Publishes times and texts. ``fault`` says what is wrong with the connection.

    Args:
        master: URI of the ROS master.
        times: topics of type std_msgs/Time.
        texts: topics of type std_msgs/String.
    """

    def __init__(self, master: str, times: Iterable[str], texts: Iterable[str]) -> None:
        """See the class; connects in the background."""
        self._master = Master(master, f"/tpc_mark_{os.getpid()}_{secrets.token_hex(3)}")
        topics = {**dict.fromkeys(times, TIME), **dict.fromkeys(texts, STRING)}
        self._publisher = RawPublisher(self._master, topics)
        self.fault = f"waiting for the ROS master at {master}"
        self._simulated = False
        self._clock_ns: int | None = None
        self._clock: _Clock | None = None
        self._ended = threading.Event()
        self._looked = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()
        self._looked.wait(3.0)

    @property
    def has_clock(self) -> bool:
        """Whether the time is that of /clock."""
        return self._clock_ns is not None

    def now_ns(self) -> int | None:
        """The graph's time: that of /clock where anybody publishes it, else the wall's.

        None where the graph is on simulated time and nothing was heard of it.
        """
        if self._clock_ns is None and not self._simulated:
            return time.time_ns()
        return self._clock_ns

    def publish(self, topic: str, content: int | str) -> int:
        """Send a time (ns) or a text to all who listen now; their number."""
        message = encode_time(content) if isinstance(content, int) else encode_string(content)
        return self._publisher.publish(topic, message)

    def listeners(self) -> set[str]:
        """The names of the nodes that listen to any topic."""
        return self._publisher.listeners()

    def close(self) -> None:
        """Leave the graph."""
        self._ended.set()
        self._thread.join(3.0)
        if self._clock is not None:
            self._clock.close()
        self._publisher.close()

    def _watch(self) -> None:
        """See every second that the master knows us; where it is a new one, register again."""
        while not self._ended.is_set():
            try:
                if not self._publisher.is_registered():
                    self._join()
                self.fault = ""
            except RunError:
                if not self.fault:
                    self.fault = "the ROS master is gone: marks are kept, and sent to who is left"
            self._looked.set()
            self._ended.wait(_LOOK_S)

    def _join(self) -> None:
        self._publisher.register()
        self._simulated = self._master.has_sim_time()
        if self._clock is not None:
            self._clock.close()
        self._clock = _Clock(self, Master(self._master.uri, f"{self._master.caller}_clock"))

    def on_clock(self, message: bytes) -> None:
        """A message of /clock has come."""
        try:
            self._clock_ns = decode_time(message)
        except ValueError as error:
            self.fault = f"{_CLOCK}: {error}"


class _Clock:
    """Listens to /clock in a thread of its own."""

    def __init__(self, graph: MarkPublisher, master: Master) -> None:
        self._graph = graph
        self._ended = threading.Event()
        self._subscriber = RawSubscriber(master, own_host(os.environ, master.uri), [_CLOCK])
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._ended.set()
        self._thread.join()
        self._subscriber.close()

    def _listen(self) -> None:
        while not self._ended.is_set():
            for _, message in self._subscriber.poll(0.2):
                self._graph.on_clock(message)
