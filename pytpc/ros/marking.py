"""Marking on a live graph, or on a bag that is replayed into one."""

from __future__ import annotations

import time
from collections import deque
from typing import NamedTuple

from pytpc.base.wording import many
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
from pytpc.ros.ros1.mark_publisher import MarkPublisher

# A mark without listeners is sent to those who connect within this time: a recorder that is just
# starting, a master that is being restarted. Later ones may be recording another mission.
_HELD_S = 60.0


class _HeldMark(NamedTuple):
    """A message without listeners, and until when (steady seconds) it is kept."""

    topic: str
    content: int | str
    until: float


class GraphMarks:
    """The side of a marking session that speaks to a graph. It goes on without one.

    Args:
        master: URI of the ROS master.
        observer: namespace of the topics, empty for none.
        what: what the observer is doing, for the title.
    """

    def __init__(self, master: str, observer: str, what: str = "marking") -> None:
        """See the class; connects in the background."""
        self._what = what
        self._master = master
        self._observer = observer
        times = [topic_for(Mark(0, kind, observer)) for kind in (*MARK_TYPES, None)]
        times.append(topic_of_observer(observer, UNDO_TOPIC))
        self._publisher = MarkPublisher(master, times, [topic_of_observer(observer, NOTE_TOPIC)])
        self._held: deque[_HeldMark] = deque()
        self._start_ns: int | None = None

    def now_ns(self) -> int | None:
        """The graph's time: that of /clock where anybody publishes it, else the wall's.

        None where the graph is on simulated time and nothing was heard of it.
        """
        return self._publisher.now_ns()

    def press(self, key: str) -> bool:
        """No key is for the graph."""
        return False

    def view(self) -> View:
        """What is shown of the graph."""
        now_ns = self.now_ns()
        if now_ns is not None and (self._start_ns is None or now_ns < self._start_ns):
            self._start_ns = now_ns
        start_ns = self._start_ns or 0
        who = f" as {self._observer}" if self._observer else ""
        listeners = self._publisher.listeners()
        heard = f"{many(len(listeners), 'node')} listening" if listeners else "nobody listens"
        if self._held:
            heard += f", {many(len(self._held), 'message')} kept for who comes"
        clock = "simulated time" if self._publisher.has_clock else "wall time"
        clock = "no /clock yet" if now_ns is None else clock
        status = f"{self._publisher.fault or 'connected'}; {heard}; {clock}"
        return View(f"{self._what}{who} on {self._master}", (status,), start_ns, now_ns)

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
            sent = self._publisher.publish(held.topic, held.content)
            if sent == 0 and time.monotonic() < held.until:
                self._held.append(held)

    def close(self) -> None:
        """Leave the graph."""
        self._publisher.close()

    def _publish(self, topic: str, content: int | str) -> None:
        if self._publisher.publish(topic, content) == 0:
            self._held.append(_HeldMark(topic, content, time.monotonic() + _HELD_S))
