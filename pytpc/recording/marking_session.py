"""A session in which an observer sets marks: keys and times in, marks and lines of text out.

Nothing here touches a terminal, a clock, a file or a graph: ``present.marking_terminal``,
``recording.marks_file`` and ``ros.marking`` do.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from rich.cells import cell_len, set_cell_size

from pytpc.base.wording import plain
from pytpc.recording.graph_places import Naming, Place
from pytpc.recording.marks import (
    LONGEST_NOTE,
    Mark,
    MarkType,
    parse_began,
    with_began,
    with_where,
)

MEANINGS: dict[MarkType | None, str] = {
    "I": "it did something it should not have",
    "II": "it should be doing something",
    None: "something is wrong",
}
_KEYS: dict[str, MarkType | None] = {"1": "I", "2": "II", "3": None}
SPEEDS = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
_STEPS_NS = {"left": -5, "right": 5, "down": -60, "up": 60, ",": -1, ".": 1}


class MarkChange(NamedTuple):
    """What a key did to the marks: it made one (``before`` is None), undid one (``after`` is None)
    or gave one a note.
    """

    before: Mark | None
    after: Mark | None

    def apply(self, marks: Sequence[Mark]) -> tuple[Mark, ...]:
        """``marks`` with the change; a note restores its mark if that is gone."""
        result = [mark for mark in marks if not self.is_about(mark)]
        if self.after is not None:
            result.append(self.after)
        return tuple(result)

    def is_about(self, mark: Mark) -> bool:
        """Whether it changes this mark, whatever its note: another file may have an older one."""
        return self.before is not None and self.before.order() == mark.order()


@dataclass(frozen=True, slots=True)
class Session:
    """One observer's marks, in the order in which they were made.

    ``typing`` is the note that is being written, or None; ``naming`` the place at which the last
    mark was wrong, while it is being chosen; ``dating`` what is typed for when its error began.
    ``said`` is a message for the observer, or empty.
    ``used`` are all times that were marked: none is used again, even if its mark was undone.
    """

    observer: str
    marks: tuple[Mark, ...] = ()
    typing: str | None = None
    said: str = ""
    ended: bool = False
    used: frozenset[int] = frozenset()
    naming: Naming | None = None
    dating: str | None = None

    @property
    def is_typing(self) -> bool:
        """Whether keys are text."""
        return self.typing is not None or self.naming is not None or self.dating is not None


def press(
    session: Session, key: str, now_ns: int | None, places: tuple[Place, ...] = ()
) -> tuple[Session, MarkChange | None]:
    """What a key does.

    Args:
        session: what was before.
        key: a character, or ``enter``, ``backspace``, ``escape``, ``left``, ``right``, ``up``,
            ``down``, ``end`` (Ctrl-C, Ctrl-D), ``closed`` (the terminal is gone): a note is kept
            as far as it was typed, and a place or a time is not.
        now_ns: the time to mark; None where it is not known.
        places: the places of the graph, from which the observer chooses.

    Returns:
        What is after, and what happened to the marks.
    """
    if key in {"end", "closed"} or (key == "q" and not session.is_typing):
        change = None
        if key == "closed" and session.typing is not None:
            session, change = _type(session, session.typing, "enter")
        return replace(session, typing=None, naming=None, dating=None, ended=True), change
    if session.is_typing:
        return _answer(session, key)
    if key in _KEYS:
        return _mark(session, _KEYS[key], now_ns)
    if key not in {"n", "u", "w", "b"}:
        return session, None
    return _look_back(session, key, places)


def _answer(session: Session, key: str) -> tuple[Session, MarkChange | None]:
    """A key while something about the last mark is asked."""
    if session.typing is not None:
        return _type(session, session.typing, key)
    if session.naming is not None:
        return _name(session, session.naming, key)
    return _date(session, session.dating or "", key)


def with_places(session: Session, places: tuple[Place, ...]) -> Session:
    """The session, in which the observer can choose from places that were not known before.

    Those that were shown keep their numbers.
    """
    if session.naming is None or session.naming.places:
        return session
    return replace(session, naming=session.naming._replace(places=places))


def _look_back(
    session: Session, key: str, places: tuple[Place, ...]
) -> tuple[Session, MarkChange | None]:
    """Keys for the last mark: say something about it, or undo it."""
    if not session.marks:
        return replace(session, said="no mark yet"), None
    last = session.marks[-1]
    if key == "n":
        # What is typed next does not become part of a place.
        text = f"{last.note} " if last.note and not last.remark else last.note
        return replace(session, typing=text, said=""), None
    if key == "w":
        return replace(session, naming=Naming(places), said=""), None
    if key == "b":
        return replace(session, dating="", said=""), None
    said = f"taken back: {_named(last)}"
    return replace(session, marks=session.marks[:-1], said=said), MarkChange(last, None)


def _mark(
    session: Session, kind: MarkType | None, now_ns: int | None
) -> tuple[Session, MarkChange | None]:
    if now_ns is None:
        return replace(session, said="not marked: the graph has no time yet (no /clock)"), None
    # While a clock stands still two marks would get one time, but undo and notes find a mark by its
    # time.
    used = session.used | {mark.time_ns for mark in session.marks}
    while now_ns in used:
        now_ns += 1
    mark = Mark(now_ns, kind, session.observer)
    said = f"marked: {_named(mark)}"
    after = replace(session, marks=(*session.marks, mark), said=said, used=used | {now_ns})
    return after, MarkChange(None, mark)


def _type(session: Session, text: str, key: str) -> tuple[Session, MarkChange | None]:
    if key == "enter":
        return _noted(replace(session, typing=None), text.strip(), "noted")
    if key == "escape":
        return replace(session, typing=None, said=""), None
    if key == "backspace":
        return replace(session, typing=text[:-1]), None
    if len(key) == 1 and key.isprintable() and len(text) < LONGEST_NOTE:
        return replace(session, typing=text + key), None
    return session, None


def _name(session: Session, naming: Naming, key: str) -> tuple[Session, MarkChange | None]:
    """A key while a place is being chosen."""
    if key == "escape":
        return replace(session, naming=None, said=""), None
    if key != "enter":
        typed = naming.type(key)
        return replace(session, naming=typed, said="" if typed != naming else session.said), None
    try:
        place = naming.chosen()
    except ValueError as error:
        return replace(session, said=str(error)), None
    left = replace(session, naming=None, said="")
    if not place:
        return left, None
    note = with_where(session.marks[-1].note, [place])
    return _noted(left, note, f"wrong at {place}")


def _date(session: Session, text: str, key: str) -> tuple[Session, MarkChange | None]:
    """A key while it is typed when the error began."""
    if key == "escape" or (key == "enter" and not text.strip()):
        return replace(session, dating=None, said=""), None
    if key == "backspace":
        return replace(session, dating=text[:-1], said=""), None
    if key != "enter":
        fits = len(key) == 1 and key.isprintable() and len(text) < LONGEST_TIME
        return (replace(session, dating=text + key, said="") if fits else session), None
    try:
        early, late = parse_began(text)
    except ValueError as error:
        return replace(session, said=str(error)), None
    note = with_began(session.marks[-1].note, early, late)
    ago = f"{early:g} s" if early == late else f"{early:g} to {late:g} s"
    return _noted(replace(session, dating=None), note, f"it began {ago} before the mark")


def _noted(session: Session, note: str, said: str) -> tuple[Session, MarkChange]:
    last = session.marks[-1]
    noted = replace(last, note=note)
    after = replace(session, marks=(*session.marks[:-1], noted), said=said)
    return after, MarkChange(last, noted)


def _named(mark: Mark) -> str:
    return f"type {mark.type}" if mark.type else "wrong"


@dataclass(frozen=True, slots=True)
class Player:
    """A clock that goes through what was recorded; times in nanoseconds.

    It stood at ``at_ns`` when the machine's steady clock was at ``since_ns``.
    """

    start_ns: int
    end_ns: int
    at_ns: int
    since_ns: int
    speed: float = 1.0
    playing: bool = False

    @classmethod
    def of(cls, start_ns: int, end_ns: int) -> Player:
        """A clock that stands at the beginning."""
        return cls(start_ns, max(start_ns, end_ns), start_ns, 0)

    def time_ns(self, steady_ns: int) -> int:
        """The current time of the clock; it stops at the end."""
        run = int((steady_ns - self.since_ns) * self.speed) if self.playing else 0
        return min(self.end_ns, self.at_ns + max(0, run))

    def go_to(self, wanted_ns: int, steady_ns: int) -> Player:
        """The clock at another time, or at the end that is nearest to it."""
        at_ns = min(self.end_ns, max(self.start_ns, wanted_ns))
        return replace(self, at_ns=at_ns, since_ns=steady_ns)

    def press(self, key: str, steady_ns: int) -> Player | None:
        """The clock after a key, None if the key is not for it."""
        at_ns = self.time_ns(steady_ns)
        here = replace(self, at_ns=at_ns, since_ns=steady_ns)
        if key == " ":
            return replace(here, playing=not self.playing)
        if key in _STEPS_NS:
            return self.go_to(at_ns + _STEPS_NS[key] * 10**9, steady_ns)
        if key in {"+", "=", "-"}:
            place = SPEEDS.index(self.speed) + (-1 if key == "-" else 1)
            return replace(here, speed=SPEEDS[min(len(SPEEDS) - 1, max(0, place))])
        return None


_NO_BREAK = "\N{NO-BREAK SPACE}"
OTHER_KEYS = ("n note", "w where", "b when it began", "u undo", "q quit")
"""The keys besides those that mark."""
LONGEST_TIME = 40
"""So many characters can be typed for when an error began."""
BEGAN_PROMPT = "it began so many seconds before the mark (20-5, or 12):"
MOST_CHOICES = 10
"""So many lines show places to choose from."""
PLAYER_HELP = ("space go or stop", "arrows 5 s, 60 s", ", . 1 s", "+ - speed")


class View(NamedTuple):
    """What is shown beside the session: ``title`` and ``status`` lines, the time at which the
    mission began, the time now (None where unknown), further keys, the places of the graph."""

    title: str
    status: tuple[str, ...]
    start_ns: int
    now_ns: int | None
    help: tuple[str, ...] = ()
    places: tuple[Place, ...] = ()


def screen(session: Session, view: View, width: int, height: int) -> list[str]:
    """The lines to show, none wider than ``width``, at most ``height``: the newest marks last."""
    keys = [f"{key} {MEANINGS[kind]}" for key, kind in _KEYS.items()]
    more = "  ".join(key.replace(" ", _NO_BREAK) for key in (*OTHER_KEYS, *view.help))
    above = [view.title, *view.status, *keys, more]
    lines = [part for line in above for part in folded(line, width)]
    foot = [part for line in asked(session) or [session.said] for part in folded(line, width)]
    foot = [*to_choose(session, width, height - len(lines) - len(foot) - 2), *foot]
    room = max(1, height - len(lines) - len(foot) - 1)
    shown = session.marks[-room:]
    of_all = f"{len(session.marks)} marks" if len(session.marks) != 1 else "1 mark"
    lines.append(cut(of_all + (":" if shown else ""), width))
    lines += [cut(_line(mark, view), width) for mark in shown]
    return (lines + foot)[:height]


def asked(session: Session) -> list[str]:
    """The lines that ask the observer to type; none if nothing is being typed."""
    if session.naming is not None:
        prompt = f"where (number, name or part): {session.naming.typed}_"
    elif session.dating is not None:
        prompt = f"{BEGAN_PROMPT} {session.dating}_"
    else:
        return [] if session.typing is None else [f"note: {session.typing}_"]
    return [session.said, prompt] if session.said else [prompt]


def to_choose(session: Session, width: int, room: int) -> list[str]:
    """The places to choose from while one is being named, in at most so many lines."""
    if session.naming is None:
        return []
    return [cut(line, width) for line in session.naming.lines(min(MOST_CHOICES, max(0, room)))]


def clock_text(time_ns: int) -> str:
    """``M:SS.T`` or ``H:MM:SS.T``, the tenths cut off."""
    sign = "-" if time_ns < 0 else ""
    tenths = abs(time_ns) // 10**8
    minutes, tenths = divmod(tenths, 600)
    hours, minutes = divmod(minutes, 60)
    text = f"{minutes:02d}:" if hours else f"{minutes}:"
    return f"{sign}{f'{hours}:' if hours else ''}{text}{tenths // 10:02d}.{tenths % 10}"


def _line(mark: Mark, view: View) -> str:
    kind = mark.type or "-"
    return f"{clock_text(mark.time_ns - view.start_ns):>9}  {kind:2}  {mark.note}".rstrip()


def folded(line: str, width: int) -> list[str]:
    """The line in pieces that fit; words that belong together stay in one piece if possible."""
    parts = textwrap.wrap(line, max(1, width), subsequent_indent="  " if width > 10 else "")
    return [cut(part.replace(_NO_BREAK, " "), width) for part in parts or [""]]


def cut(line: str, width: int) -> str:
    """At most ``width`` columns of it; some characters take two."""
    line = plain(line)
    if cell_len(line) <= width:
        return line
    # What is put behind a joiner or in its place can be wider than the parts were.
    cut = set_cell_size(line, max(0, width - 1))
    while cut and cell_len(f"{cut}~") > width:
        cut = cut[:-1]
    return f"{cut}~"
