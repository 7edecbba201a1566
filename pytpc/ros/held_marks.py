"""Sends marks to whoever listens, and keeps those that nobody got for a recorder that starts."""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections import deque
from typing import NamedTuple

from pytpc.base.wording import many
from pytpc.recording.graph_places import Place
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

# A mark without listeners is sent to those who connect within this time: a recorder that is just
# starting, a master that is being restarted. Later ones may be recording another mission.
HELD_S = 60.0


class _HeldMark(NamedTuple):
    """A message that nobody got yet, and until when (steady seconds) it is kept."""

    topic: str
    content: int | str
    until: float


class HeldMarks(ABC):
    """The marks of an observer on a graph. A mark has its time, so that it may arrive late."""

    def __init__(self, observer: str, what: str) -> None:
        """Nothing is held.

        Args:
            observer: the namespace of the topics, empty for none.
            what: what the observer is doing, for the title.
        """
        self._observer = observer
        self._what = what
        self._start_ns: int | None = None
        self._places: tuple[Place, ...] = ()
        self._held: deque[_HeldMark] = deque()
        self._dropped = 0
        self._sending = threading.Lock()

    @property
    @abstractmethod
    def _waits(self) -> bool:
        """Whether messages wait for subscribers that are known and have not connected yet."""

    @abstractmethod
    def _sent(self, topic: str, content: int | str) -> int:
        """Send a time (ns) or a text to all who listen now; their number."""

    @abstractmethod
    def now_ns(self) -> int | None:
        """The graph's time: that of /clock if anybody publishes it, else the wall's.

        None if the graph is on simulated time and no /clock has come.
        """

    def press(self, key: str) -> bool:
        """No key is for the graph."""
        return False

    def _view(self, place: str, fault: str, heard: str, *, is_simulated: bool) -> View:
        """The title, the state of the connection, and the time.

        ``fault`` is empty while there is none, ``heard`` says who listens, see ``_heard``.
        """
        now_ns = self.now_ns()
        if now_ns is not None and (self._start_ns is None or now_ns < self._start_ns):
            self._start_ns = now_ns
        who = f" as {self._observer}" if self._observer else ""
        clock = "simulated time" if is_simulated else "wall time"
        clock = "no /clock yet" if now_ns is None else clock
        if self.held:
            kept = f"{many(self.held, 'message')} kept for a recorder that starts"
            heard += f"; {kept} within {HELD_S:.0f} s"
        status = f"{fault or 'connected'}; {heard}; {clock}"
        title = f"{self._what}{who} on {place}"
        return View(title, (status,), self._start_ns or 0, now_ns, places=self._places)

    def _heard(self, listeners: int) -> str:
        """Who listens, in words."""
        if listeners:
            return f"{many(listeners, 'node')} listening"
        return (
            "looking for a recorder"
            if self._waits
            else "no recorder listens; start one with: pytpc record"
        )

    @property
    def held(self) -> int:
        """How many messages are kept."""
        return len(self._held)

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

    def _send_last(self) -> None:
        """Give the listeners of messages that are held the time to connect, and send these."""
        while self._held and self._waits:
            time.sleep(0.05)
        self.tick()

    def tick(self) -> None:
        """Send messages that nobody got to those who have connected since, in order."""
        with self._sending:
            self._send_held()

    def unheard(self) -> int:
        """How many messages nobody got."""
        return self._dropped + len(self._held)

    def _send_held(self) -> None:
        if self._waits:
            return
        waiting, self._held = self._held, deque()
        for held in waiting:
            sent = self._sent(held.topic, held.content)
            if sent:
                continue
            if time.monotonic() < held.until:
                self._held.append(held)
            else:
                self._dropped += 1

    def _publish(self, topic: str, content: int | str) -> None:
        with self._sending:
            self._send_held()
            if self._waits or self._sent(topic, content) == 0:
                self._held.append(_HeldMark(topic, content, time.monotonic() + HELD_S))


def times_and_note(observer: str) -> tuple[list[str], str]:
    """The topics of an observer's marks: those that have a time, and that of the notes."""
    times = [topic_for(Mark(0, kind, observer)) for kind in (*MARK_TYPES, None)]
    times.append(topic_of_observer(observer, UNDO_TOPIC))
    return times, topic_of_observer(observer, NOTE_TOPIC)
