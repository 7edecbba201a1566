"""Marking on a live graph, or on a bag that is replayed into one."""

from __future__ import annotations

import os
import secrets
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from pytpc.base.errors import RunError
from pytpc.base.wording import many
from pytpc.ingest.ros1 import decode_time
from pytpc.recording.marking_session import MarkChange, View
from pytpc.recording.marks import (
    MARK_TYPES,
    NOTE_TOPIC,
    UNDO_TOPIC,
    Mark,
    note_text,
    topic_for,
    topic_of_observer,
)
from pytpc.ros.ros1.master import Master, own_host
from pytpc.ros.ros1.publisher import STRING, TIME, RawPublisher, encode_string, encode_time
from pytpc.ros.ros1.subscriber import RawSubscriber

_CLOCK = "/clock"
_LOOK_S = 1.0
# A mark without listeners is sent to those who connect within this time: a recorder that is just
# starting, a master that is being restarted. Later ones may be recording another mission.
_HELD_S = 60.0


class _HeldMark(NamedTuple):
    """A message without listeners, and until when (steady seconds) it is kept."""

    topic: str
    content: int | str
    until: float


class GraphMarks:
    """The side of a marking session that speaks to a graph. It goes on without a master.

    Args:
        master: URI of the ROS master.
        observer: namespace of the topics, empty for none.
        what: what the observer is doing, for the title.
    """

    def __init__(self, master: str, observer: str, what: str = "marking") -> None:
        self._what = what
        self._observer = observer
        self._master = Master(master, f"/tpc_mark_{os.getpid()}_{secrets.token_hex(3)}")
        times = [topic_for(Mark(0, kind, observer)) for kind in (*MARK_TYPES, None)]
        times.append(topic_of_observer(observer, UNDO_TOPIC))
        topics = {**dict.fromkeys(times, TIME), topic_of_observer(observer, NOTE_TOPIC): STRING}
        self._publisher = RawPublisher(self._master, topics)
        self._held: deque[_HeldMark] = deque()
        self._start_ns: int | None = None
        self._fault = f"waiting for the ROS master at {master}"
        self._simulated = False
        self._clock_ns: int | None = None
        self._clock: _Clock | None = None
        self._ended = threading.Event()
        self._looked = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()
        self._looked.wait(3.0)

    def now_ns(self) -> int | None:
        """The graph's time: that of /clock if anybody publishes it, else the wall's.

        None if the graph is on simulated time and no /clock has come.
        """
        if self._clock_ns is None and not self._simulated:
            return time.time_ns()
        return self._clock_ns

    def press(self, key: str) -> bool:
        """No key is for the graph."""
        return False

    def view(self) -> View:
        """The title and state of the connection, and the time."""
        now_ns = self.now_ns()
        if now_ns is not None and (self._start_ns is None or now_ns < self._start_ns):
            self._start_ns = now_ns
        start_ns = self._start_ns or 0
        who = f" as {self._observer}" if self._observer else ""
        listeners = self._publisher.listeners()
        heard = f"{many(len(listeners), 'node')} listening" if listeners else "nobody listens"
        if self._held:
            heard += f", {many(len(self._held), 'message')} kept for later listeners"
        clock = "wall time" if self._clock_ns is None else "simulated time"
        clock = "no /clock yet" if now_ns is None else clock
        status = f"{self._fault or 'connected'}; {heard}; {clock}"
        return View(f"{self._what}{who} on {self._master.uri}", (status,), start_ns, now_ns)

    def send(self, change: MarkChange) -> str:
        """Tell the graph what happened to the marks."""
        before, after = change
        if after is None and before is not None:
            self._publish(topic_of_observer(self._observer, UNDO_TOPIC), before.time_ns)
        elif after is not None and before is not None:
            topic = topic_of_observer(self._observer, NOTE_TOPIC)
            self._publish(topic, note_text(after.time_ns, after.note))
        elif after is not None:
            self._publish(topic_for(after), after.time_ns)
        return ""

    def tick(self) -> None:
        """Send messages that had no listeners to those who have connected since, in order."""
        waiting, self._held = self._held, deque()
        for held in waiting:
            sent = self._sent(held.topic, held.content)
            if sent == 0 and time.monotonic() < held.until:
                self._held.append(held)

    def close(self) -> None:
        """Leave the graph."""
        self._ended.set()
        self._thread.join(3.0)
        if self._clock is not None:
            self._clock.close()
        self._publisher.close()

    def _publish(self, topic: str, content: int | str) -> None:
        if self._sent(topic, content) == 0:
            self._held.append(_HeldMark(topic, content, time.monotonic() + _HELD_S))

    def _sent(self, topic: str, content: int | str) -> int:
        """Send a time (ns) or a text to all who listen now; their number."""
        message = encode_time(content) if isinstance(content, int) else encode_string(content)
        return self._publisher.publish(topic, message)

    def _watch(self) -> None:
        """Check every second that the master knows us, and register at one that does not."""
        while not self._ended.is_set():
            try:
                if not self._publisher.is_registered():
                    self._join()
                self._fault = ""
            except RunError:
                if not self._fault:
                    self._fault = (
                        "the ROS master is gone: marks go to the nodes that are still connected"
                    )
            self._looked.set()
            self._ended.wait(_LOOK_S)

    def _join(self) -> None:
        self._publisher.register()
        self._simulated = self._master.has_sim_time()
        if self._clock is not None:
            self._clock.close()
        listener = Master(self._master.uri, f"{self._master.caller}_clock")
        self._clock = _Clock(listener, self._hear)

    def _hear(self, message: bytes) -> None:
        try:
            self._clock_ns = decode_time(message)
        except ValueError as error:
            self._fault = f"{_CLOCK}: {error}"


class _Clock:
    """Listens to /clock in a thread of its own."""

    def __init__(self, master: Master, on_message: Callable[[bytes], None]) -> None:
        self._on_message = on_message
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
                self._on_message(message)
