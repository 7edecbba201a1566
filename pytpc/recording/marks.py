"""Marks: the times at which an observer says that the robot does wrong.

On a graph they are messages (``topic_of_marks``), beside a bag a CSV file (``read_marks``). What
the columns and topics are: docs/reference/formats.md#marks.
"""

from __future__ import annotations

import csv
import io
import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, get_args

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import InputError
from pytpc.base.regular_files import read_file

MarkType = Literal["I", "II"]
"""``I``: the robot did something that it should not have; ``II``: it should do something and does
not (docs/reference/glossary.md#type-i)."""

MARK_TYPES: tuple[MarkType, ...] = get_args(MarkType)
UNDO_TOPIC = "mark_undo"
NOTE_TOPIC = "mark_note"
_TOPICS: dict[str, MarkType | None] = {
    "mark_action": "I",
    "mark_no_action": "II",
    "mark_wrong": None,
}
LONGEST_NOTE = 500
"""Characters that can be typed, and that are shown."""
MOST_PLACES = 8
"""So many places of one mark are read."""
_MOST_KEPT = 10_000
_HEADER = ["time_ns", "type", "observer", "note"]
# A spreadsheet may have changed the commas; the reader of marks then says what is wrong.
_BEGIN = re.compile(rb'(?:\xef\xbb\xbf)?"?time_ns"?\s*[,;\t]\s*"?type')
_SNIFFED = 256
_PART = "[A-Za-z0-9_]+"
_NAME = rf"(?:(?:~/?|/){_PART}|[A-Za-z_][A-Za-z0-9_]*)(?:/{_PART})*"
_LONGEST_PLACE = 255
_ENDS = ",.;:)"
# A whole word, of which the name is the first group.
_PLACE = re.compile(rf"(?<!\S)@(?!\S{{{_LONGEST_PLACE + 1}}})({_NAME})[,.;:)]*(?!\S)")
_NUMBER = r"(\d{1,6}(?:\.\d{1,3})?)"
# How many seconds before the mark the error began: @-12, or from when to when: @-20..-5.
_BEGAN = re.compile(rf"(?<!\S)@-{_NUMBER}(?:(?:\.\.-?|-){_NUMBER})?[{_ENDS}]*(?!\S)", re.ASCII)
_MOST_SECONDS = 999_999.0
_SECONDS = rf"{_NUMBER}\s*s?"
_NAMESPACE = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)*", re.ASCII)
_TYPED = re.compile(rf"{_SECONDS}(?:\s*(?:-|\.\.|to)\s*{_SECONDS})?", re.ASCII)


@dataclass(frozen=True, slots=True)
class Mark:
    """One mark.

    ``time_ns`` is the marked time, ``type`` is None where the observer only says "wrong", and
    ``observer`` is the namespace of the topic (``marks0``), empty where there is none. ``note`` is
    what the observer wrote about it.

    A word of the note that is an ``@`` and a ROS name says where the robot went wrong: it names a
    topic, a service, an action, a node or a frame of tf. ``@-20..-5`` says when the error began.
    """

    time_ns: int
    type: MarkType | None
    observer: str = ""
    note: str = ""

    def order(self) -> tuple[int, str, str]:
        """Sorting marks by this is deterministic."""
        return (self.time_ns, self.observer, self.type or "")

    @property
    def where(self) -> tuple[str, ...]:
        """The places that the note names, each once, in their order; at most ``MOST_PLACES``.

        >>> Mark(1, "I", "", "@/cmd_vel @~state, not ana@lab, and again @/cmd_vel").where
        ('/cmd_vel', '~state')
        """
        names = dict.fromkeys(found[1] for found in _PLACE.finditer(self.note))
        return tuple(names)[:MOST_PLACES]

    @property
    def began(self) -> tuple[float, float] | None:
        """From when to when the error began, in s before the mark; None if the note does not say.

        >>> Mark(1, "I", "", "@-20..-5 @/cmd_vel too fast").began
        (20.0, 5.0)
        >>> Mark(1, "I", "", "@-12 too fast").began
        (12.0, 12.0)
        """
        found = _BEGAN.search(self.note)
        return None if found is None else _span(found)

    @property
    def remark(self) -> str:
        """The note without the places and the time at its beginning.

        >>> Mark(1, "I", "", "@-20..-5 @/cmd_vel @/odom too fast near @/map").remark
        'too fast near @/map'
        """
        text = self.note.strip()
        while found := _PLACE.match(text) or _BEGAN.match(text):
            text = text[found.end() :].lstrip()
        return text


def is_place(name: str) -> bool:
    """Whether it is a ROS name, which a note can have as a place.

    >>> is_place("/cmd_vel"), is_place("base_link"), is_place("~state"), is_place("too fast")
    (True, True, True, False)
    """
    return len(name) <= _LONGEST_PLACE and re.fullmatch(_NAME, name) is not None


def is_observer(name: str) -> bool:
    """Whether an observer can have this name: it is a namespace as ROS allows it.

    >>> is_observer("ana"), is_observer("lab/ana"), is_observer("2nd"), is_observer("")
    (True, True, False, False)
    """
    return _NAMESPACE.fullmatch(name) is not None


def with_where(note: str, where: Iterable[str]) -> str:
    """The note with these places before its text, and no others; at most ``LONGEST_NOTE`` long.

    When the error began stays before them. Places that the note began with are gone. One within the
    text stays there as a mere name.

    >>> with_where("@/odom too fast near @/map.", ["/cmd_vel", "~state"])
    '@/cmd_vel @~state too fast near /map.'
    >>> with_where("@/odom too fast", [])
    'too fast'
    """
    began = _BEGAN.search(note)
    before = "" if began is None else f"{began[0].rstrip(_ENDS)} "
    for name in tuple(dict.fromkeys(where))[:MOST_PLACES]:
        if len(before) + len(name) + 1 <= LONGEST_NOTE:
            before += f"@{name} "
    text = _PLACE.sub(lambda found: found[0][1:], Mark(0, None, "", note).remark)
    return _after(before, _BEGAN.sub("", text))


def with_began(note: str, early_s: float, late_s: float) -> str:
    """The note that says when the error began, in s before the mark; at most ``LONGEST_NOTE`` long.

    >>> with_began("@-3 @/odom too fast", 20, 5)
    '@-20..-5 @/odom too fast'
    >>> with_began("", 12.04, 12.04)
    '@-12'
    """
    ends = (min(max(0.0, one), _MOST_SECONDS) for one in (early_s, late_s))
    first, last = (f"{one:.1f}".removesuffix(".0") for one in ends)
    word = f"@-{first}" if first == last else f"@-{first}..-{last}"
    return _after(f"{word} ", _BEGAN.sub("", note).strip())


def _after(before: str, text: str) -> str:
    """A note of these words and a text, which is cut to what is left for it."""
    room = LONGEST_NOTE - len(before)
    return (before + (short_note(text, room) if room > len("...") else "")).rstrip()


def parse_began(text: str) -> tuple[float, float]:
    """What somebody types for when an error began: ``20-5``, ``20..5`` or ``12``.

    Returns:
        The earlier and the later end, as they are counted: the larger number first.

    Raises:
        ValueError: it is neither; the message says what is expected.
    """
    found = _TYPED.fullmatch(text.strip())
    if found is None:
        raise ValueError(f"{text.strip()!r} is not like 20-5, or 12")
    return _span(found)


def _span(found: re.Match[str]) -> tuple[float, float]:
    """The two numbers of a match, the larger one first; one number is both."""
    ends = float(found[1]), float(found[2] or found[1])
    return max(ends), min(ends)


def topic_of_marks(topic: str) -> tuple[MarkType | None, str] | None:
    """Type and observer of the marks on ``topic``, or None if it carries no marks.

    ``/mark_action`` -> ``("I", "")``, ``/marks0/mark_no_action`` -> ``("II", "marks0")``,
    ``/mark_wrong`` -> ``(None, "")``.
    """
    observer, last = _split(topic)
    return (_TOPICS[last], observer) if last in _TOPICS else None


def topic_for(mark: Mark) -> str:
    """The reverse of ``topic_of_marks``."""
    (last,) = (name for name, kind in _TOPICS.items() if kind == mark.type)
    return topic_of_observer(mark.observer, last)


def topic_of_observer(observer: str, last: str) -> str:
    """The topic called ``last`` in an observer's namespace."""
    return f"/{observer}/{last}" if observer else f"/{last}"


def joined(marks: Iterable[Mark]) -> tuple[Mark, ...]:
    """``marks`` sorted, each once.

    Of two that differ in their notes alone, it is the one that says where and when, or else has a
    note.
    """
    found: dict[tuple[int, str, str], Mark] = {}
    for mark in marks:
        before = found.get(mark.order())
        if before is None or _says(mark) > _says(before):
            found[mark.order()] = mark
    return tuple(sorted(found.values(), key=Mark.order))


def _says(mark: Mark) -> tuple[int, str]:
    return (bool(mark.where) + bool(mark.began), mark.note)


def marks_between(marks: Iterable[Mark], start_ns: int, end_ns: int) -> list[Mark]:
    """The marks from ``start_ns`` to ``end_ns``."""
    return [mark for mark in marks if start_ns <= mark.time_ns <= end_ns]


def with_short_note(mark: Mark) -> Mark:
    """The mark, with the beginning of its note if that is longer than anybody writes."""
    return mark if len(mark.note) <= _MOST_KEPT else replace(mark, note=_kept(mark.note))


def _kept(note: str) -> str:
    return short_note(note, _MOST_KEPT)


def short_note(note: str, most: int = LONGEST_NOTE) -> str:
    """A note of at most so many characters."""
    return note if len(note) <= most else f"{note[: most - 3]}..."


def note_text(time_ns: int, note: str) -> str:
    """A note as it stands on ``mark_note``: ``SECONDS.NANOSECONDS,NOTE``."""
    return f"{time_ns // 10**9}.{time_ns % 10**9:09d},{note}"


def parse_note(text: str) -> tuple[int, str] | None:
    """The reverse of ``note_text``; None if the text is not a note."""
    time, comma, note = text.partition(",")
    seconds, dot, nanoseconds = time.partition(".")
    if not comma or not dot or len(nanoseconds) != 9:
        return None
    digits = seconds + nanoseconds
    if not (digits.isascii() and digits.isdigit()) or len(digits) > 20:
        return None
    return int(digits), note


class MarkMessages:
    """Gathers the marks of a graph from the messages of all their topics, in any order.

    An observer marks no time twice, so an observer and a time name one mark.
    """

    def __init__(self) -> None:
        self._types: defaultdict[tuple[str, int], set[MarkType | None]] = defaultdict(set)
        self._undone: set[tuple[str, int]] = set()
        self._notes: dict[tuple[str, int], str] = {}
        self.count = 0
        """How many marks there are that were not undone."""

    @staticmethod
    def message_type(topic: str) -> Literal["Time", "String"] | None:
        """The std_msgs type of a topic's messages; None if the topic is not about marks."""
        _, last = _split(topic)
        if last == NOTE_TOPIC:
            return "String"
        return "Time" if last in {*_TOPICS, UNDO_TOPIC} else None

    def add_time(self, topic: str, time_ns: int) -> None:
        """Take in a std_msgs/Time of a topic that ``message_type`` knows."""
        observer, last = _split(topic)
        named = (observer, time_ns)
        # A recorder counts at any time, and a robot may send millions.
        before = self._count_of(named)
        if last == UNDO_TOPIC:
            self._undone.add(named)
        else:
            self._types[named].add(_TOPICS[last])
        self.count += self._count_of(named) - before

    def _count_of(self, named: tuple[str, int]) -> int:
        return 0 if named in self._undone else len(self._types.get(named, ()))

    def add_text(self, topic: str, text: str) -> None:
        """Take in a std_msgs/String of such a topic.

        Raises:
            ValueError: it is no note.
        """
        found = parse_note(text)
        if found is None:
            raise ValueError("not a note: expected SECONDS.NANOSECONDS,NOTE")
        time_ns, note = found
        self._notes[_split(topic)[0], time_ns] = _kept(note)

    def marks(self) -> tuple[Mark, ...]:
        """The marks that were not undone, with their last notes, sorted."""
        found = [
            Mark(time_ns, kind, observer, self._notes.get((observer, time_ns), ""))
            for (observer, time_ns), kinds in self._types.items()
            if (observer, time_ns) not in self._undone
            for kind in kinds
        ]
        return tuple(sorted(found, key=Mark.order))


def _split(topic: str) -> tuple[str, str]:
    """The observer of a topic, and the topic's last part."""
    observer, _, last = topic.rpartition("/")
    return observer.strip("/"), last


def begins_marks(first: bytes) -> bool:
    """Whether a file with these first bytes is one of marks."""
    return _BEGIN.match(first) is not None


def is_marks_file(path: Path) -> bool:
    """Whether it is there and begins like a file of marks."""
    try:
        if not path.is_file():
            return False
        with path.open("rb") as stream:
            return begins_marks(stream.read(_SNIFFED))
    except OSError:
        return False


def marks_beside(recording: Path) -> Path:
    """The file beside a recording: ``BAG.marks.csv``. Use ``marks_home`` for all of its marks."""
    return recording.with_name(f"{recording.name}.marks.csv")


def marks_text(marks: Sequence[Mark]) -> str:
    """The CSV file of ``marks``, sorted."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(_HEADER)
    for mark in sorted(marks, key=Mark.order):
        writer.writerow([mark.time_ns, mark.type or "", mark.observer, mark.note])
    return stream.getvalue()


def write_marks(marks: Sequence[Mark], path: Path) -> None:
    """Write the CSV file, atomically.

    Raises:
        TpcError: it cannot be written; what stood there before is untouched.
    """
    write_atomic(path, marks_text(marks).encode("utf-8", "backslashreplace"))


def read_marks(path: Path) -> tuple[Mark, ...]:
    """Read a file of ``write_marks``, or one written by hand; trailing columns may be missing.

    Raises:
        InputError: it cannot be read, or a line is no mark.
    """
    try:
        text = read_file(path).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"not CSV: byte {error.start} is not UTF-8", path) from error
    reader = csv.reader(io.StringIO(text, newline=""))
    marks = []
    try:
        if next(reader, None) != _HEADER:
            raise InputError(f"the first line is not {','.join(_HEADER)}", path, 1)
        for row in reader:
            if row:
                marks.append(_mark(row))
    except (ValueError, csv.Error) as error:
        raise InputError(str(error), path, reader.line_num) from error
    return tuple(sorted(marks, key=Mark.order))


def _mark(row: list[str]) -> Mark:
    time, kind, observer, note = (row + [""] * len(_HEADER))[: len(_HEADER)]
    if len(row) > len(_HEADER):
        raise ValueError(f"{len(row)} columns, not {len(_HEADER)}")
    if not (time.isascii() and time.isdigit() and len(time) < 20) or int(time) >= 2**63:
        raise ValueError(f"{time!r} is not a time in nanoseconds")
    if kind and kind not in MARK_TYPES:
        raise ValueError(f"{kind!r} is not a type of mark (I, II or nothing)")
    mark_type = next((known for known in MARK_TYPES if known == kind), None)
    return Mark(int(time), mark_type, observer, _kept(note))
