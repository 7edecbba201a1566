"""The marks of several observers who watch one mission: a session, and topics, for each of them.

What a key does to a session is said in `pytpc.recording.marking_session`; here words do the same.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

from pytpc.base.errors import TpcError
from pytpc.present.marking_terminal import MarkedMission
from pytpc.recording.graph_places import Place
from pytpc.recording.marking_session import MarkChange, Session, View, press
from pytpc.recording.marks import LONGEST_NOTE, Mark
from pytpc.recording.marks_file import END_PATIENCE_S, KEY_PATIENCE_S, MarksFile

MOST_OBSERVERS = 32
"""Each has topics, and on ROS 2 a process."""

_KINDS = {"1", "2", "3"}
_ASKED = {"note": "n", "where": "w", "began": "b"}


class SendsMarks(Protocol):
    """What marks are sent to: `pytpc.api.live_mission.WatchedMission`."""

    def now_ns(self) -> int | None:
        """The time that a mark would have now."""

    def view(self) -> View:
        """What is shown of the mission."""

    def send(self, change: MarkChange) -> str:
        """Publish a change; what to tell the observer."""


class Answer(NamedTuple):
    """What became of what an observer did; ``said`` tells it in one line."""

    ok: bool
    said: str


class Observers:
    """The sessions of all observers, and the one file that their marks are in.

    Args:
        mission: what is marked.
        file: where the marks go.
    """

    def __init__(self, mission: SendsMarks, file: MarksFile) -> None:
        """See the class."""
        self._mission = mission
        self._file = file
        self._sessions: dict[str, Session] = {}
        # Marks of observers who are not here now; they are shown, too.
        self._others = {mark.order(): mark for mark in file.before}
        self.unsaved = ""

    @property
    def marks(self) -> list[Mark]:
        """All marks, of all observers, by time."""
        kept = dict(self._others)
        for session in self._sessions.values():
            kept.update({mark.order(): mark for mark in session.marks})
        return sorted(kept.values(), key=Mark.order)

    def is_new(self, name: str) -> bool:
        """Whether an observer of this name has no session yet."""
        return name not in self._sessions

    def join(self, name: str) -> Answer:
        """Begin or go on with the session of an observer."""
        if name in self._sessions:
            return Answer(True, "")
        if len(self._sessions) >= MOST_OBSERVERS:
            return Answer(False, f"there are {MOST_OBSERVERS} observers already: use one of theirs")
        ours = tuple(mark for mark in self._file.before if mark.observer == name)
        for mark in ours:
            self._others.pop(mark.order(), None)
        self._sessions[name] = Session(name, ours)
        return Answer(True, "")

    def do(self, name: str, what: str, text: str = "", at_ns: int | None = None) -> Answer:
        """Do what a key of `pytpc mark` does.

        Args:
            name: of the observer, who has joined.
            what: ``1``, ``2``, ``3`` mark; ``undo``; ``note``, ``where`` and ``began`` say
                something about the observer's last mark.
            text: the note, the place or the time before the mark, as typed.
            at_ns: the time of the mark; None: now.
        """
        session = self._sessions[name]
        view = self._mission.view()
        before = session.marks
        if what in _KINDS:
            now_ns = self._mission.now_ns() if at_ns is None else at_ns
            after, change = press(session, what, now_ns)
        elif what == "undo":
            after, change = press(session, "u", None)
        elif what in _ASKED:
            after, change = _answered(session, _ASKED[what], text, view.places)
        else:
            return Answer(False, f"nothing is called {what!r}")
        said = after.said
        if change is not None:
            self._file.take(change)
            if told := self._mission.send(change):
                said = f"{said}: {told}"
        self._sessions[name] = replace(after, said="")
        self.flush()
        return Answer(after.marks != before, f"{said}; {self.unsaved}" if self.unsaved else said)

    def flush(self) -> None:
        """Write what is not on the disk yet; ``unsaved`` says what is wrong, if anything."""
        self.unsaved = self._file.flush(KEY_PATIENCE_S)

    def close(self) -> str:
        """Write what is left; what is wrong, or nothing."""
        return self._file.flush(END_PATIENCE_S)


def _answered(
    session: Session, key: str, text: str, places: tuple[Place, ...]
) -> tuple[Session, MarkChange | None]:
    """Type a text where a key asks for one; what was there before is replaced."""
    asking, _ = press(session, key, None, places)
    if not asking.is_typing:
        return asking, None
    if asking.typing is not None:
        # The place and the time that the note begins with stay.
        last = session.marks[-1]
        words = last.note.strip().removesuffix(last.remark).strip()
        asking = replace(asking, typing=f"{words} " if words else "")
    # A place of the page is chosen by its name, and not by a number or a part of one.
    typed = f"@{text.strip().removeprefix('@')}" if key == "w" else text
    for character in typed[: LONGEST_NOTE + 1]:
        asking, _ = press(asking, character, None, places)
    after, change = press(asking, "enter", None, places)
    if after.is_typing:
        # It was no place or no time, as ``said`` tells.
        said = after.said
        after, _ = press(after, "escape", None)
        after = replace(after, said=said)
    return after, change


class ObserverMissions:
    """A mission of ``pytpc.present.marking_terminal`` whose marks go to topics of each observer.

    An observer becomes a node of the graph with the first mark, which waits for that: to become one
    can take seconds, and the others do not wait for it.

    Args:
        base: has the clock and the places; marks without an observer are its own.
        opened: makes the mission of an observer; None for a recording, where nobody is told.
    """

    def __init__(
        self, base: MarkedMission, opened: Callable[[str], MarkedMission] | None = None
    ) -> None:
        """Nobody has marked yet."""
        self._base = base
        self._opened = opened
        self._missions: dict[str, MarkedMission] = {}
        self._waiting: dict[str, list[MarkChange]] = {}
        self._opening: dict[str, threading.Thread] = {}
        self._faults: dict[str, str] = {}

    def now_ns(self) -> int | None:
        """The time that a mark would have now."""
        return self._base.now_ns()

    def press(self, key: str) -> bool:
        """A key of the clock of a recording."""
        return self._base.press(key)

    def view(self) -> View:
        """That of the mission, with the state of each observer who has marked."""
        view = self._base.view()
        told = [f"{name}: {one.view().status[0]}" for name, one in sorted(self._missions.items())]
        told += [f"{name}: {fault}" for name, fault in sorted(self._faults.items())]
        return view._replace(status=(*view.status, *told)) if told else view

    def send(self, change: MarkChange) -> str:
        """Tell the graph, on the observer's topics."""
        about = change.after or change.before
        name = "" if about is None else about.observer
        if self._opened is None or not name:
            return self._base.send(change)
        if name in self._missions:
            self._send_waiting()
            return self._missions[name].send(change)
        self._waiting.setdefault(name, []).append(change)
        if name not in self._opening:
            thread = threading.Thread(target=self._open, args=(name,), daemon=True)
            self._opening[name] = thread
            thread.start()
        return ""

    def tick(self) -> None:
        """Send what waited for its observer to be a node."""
        self._base.tick()
        self._send_waiting()
        for mission in list(self._missions.values()):
            mission.tick()

    def close(self) -> None:
        """Send what waits, and leave the graph."""
        for thread in self._opening.values():
            thread.join(END_PATIENCE_S)
        self.tick()
        for mission in self._missions.values():
            mission.close()
        self._base.close()

    def unheard(self) -> int:
        """How many messages about marks nobody got."""
        waiting = sum(len(changes) for changes in self._waiting.values())
        found = [self._base, *self._missions.values()]
        return waiting + sum(mission.unheard() for mission in found)

    def _send_waiting(self) -> None:
        for name in [name for name in self._waiting if name in self._missions]:
            for change in self._waiting.pop(name):
                self._missions[name].send(change)

    def _open(self, name: str) -> None:
        assert self._opened is not None
        try:
            self._missions[name] = self._opened(name)
        except TpcError as error:
            self._faults[name] = f"marks are in the file, and not on the graph: {error}"


def free_name(wanted: str, taken: Sequence[str]) -> str:
    """``wanted``, or it with the first number that nobody has.

    >>> free_name("observer", ["observer", "observer2"])
    'observer3'
    """
    number, name = 1, wanted
    while name in taken:
        number += 1
        name = f"{wanted}{number}"
    return name
