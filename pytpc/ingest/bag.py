"""ROS 1 bags: the reports, the marks, and what is wrong with the recording.

``read_bag`` is the entrance. The bag is read with rosbags' own ROS 1 reader rather than its
``AnyReader``: that one parses the message definitions of every topic and refuses a bag for the sake
of one odd type that TPC never looks at.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rosbags.interfaces import Connection, ConnectionExtRosbag1
from rosbags.rosbag1 import Reader

from pytpc.errors import InputError
from pytpc.events import Bools, EventBuilder, Events, concat
from pytpc.ingest.bag_damage import describe_damage
from pytpc.ingest.recording import MalformedRecord, Recording
from pytpc.ingest.ros1 import decode_log, decode_string, decode_time
from pytpc.ingest.rosout_line import Malformed, parse_report, parse_stamped
from pytpc.marks import Mark, topic_of_marks
from pytpc.words import many

ROSOUT = "/rosout"
ROSOUT_AGG = "/rosout_agg"
REPORTS = "/threshold_information"

Progress = Callable[[int, int], None]

_LOG = "rosgraph_msgs/msg/Log"
_STRING = "std_msgs/msg/String"
_TIME = "std_msgs/msg/Time"
_SHOWN = 20
_SHOWN_TEXT = 200
_STEP = 2000
_OTHER_CLOCK_NS = 60 * 10**9

_Raw = tuple[Connection, int, bytes]


def read_bag(path: Path, on_progress: Progress | None = None) -> Recording:
    """Read a ROS 1 bag.

    Reports come from /rosout, /rosout_agg and /threshold_information. Where the same reports are on
    more than one of them, one is counted: of a node that reports on /rosout nothing is taken from
    /rosout_agg, and of a key that is on either of these nothing from /threshold_information (there
    the publisher may be a converter, which does not say whose report it passes on). Time is the
    message's own stamp; where that is 0, the time at which the bag got it. Marks are
    docs/formats.md's topics.

    Args:
        path: the file.
        on_progress: called with (messages read, messages in all) every now and then.

    Raises:
        InputError: the file is no bag, is truncated, has no index or is damaged; one line with the
            byte, where the file itself tells it.
    """
    reader = _open(path)
    try:
        wanted, notes = _wanted(reader.connections)
        total = sum(connection.msgcount for connection in wanted)
        reading = _Reading(notes=notes)
        for number, message in enumerate(_messages(reader, wanted, path)):
            reading.take(*message)
            if on_progress is not None and number % _STEP == 0:
                on_progress(number, total)
        if on_progress is not None:
            on_progress(total, total)
        # The reader's end is one nanosecond after the last message.
        span = (reader.start_time, reader.end_time - 1) if reader.chunk_infos else None
    finally:
        reader.close()
    return reading.recording(path.stem, span)


def _open(path: Path) -> Reader:
    if not path.is_file():
        raise InputError("no such bag" if not path.exists() else "a folder, not a bag", path)
    try:
        reader = Reader(path)
        reader.open()
    except Exception as error:
        raise _broken(path, error) from error
    return reader


def _messages(reader: Reader, wanted: list[Connection], path: Path) -> Iterator[_Raw]:
    """The messages of ``wanted``; whatever the reader dies of becomes one InputError."""
    if not wanted:
        return
    messages = reader.messages(wanted)
    while True:
        try:
            message = next(messages)
        except StopIteration:
            return
        except Exception as error:
            raise _broken(path, error) from error
        yield message


def _broken(path: Path, error: Exception) -> InputError:
    """What to say of a bag on which the reader failed.

    rosbags fails with its own error, but on damaged bytes also with those of struct, bz2, lz4 and
    with assertions, none of which has a place in it; the walk over the records has.
    """
    if isinstance(error, PermissionError):
        return InputError("cannot be read: permission denied", path)
    try:
        damage = describe_damage(path)
    except OSError as failure:
        return InputError(f"cannot be read: {failure.strerror or failure}", path)
    if damage is None:
        return InputError(f"damaged: {str(error) or type(error).__name__}", path)
    hint = "" if damage.startswith("not a") else f'; "rosbag reindex {path.name}" saves the rest'
    return InputError(damage + hint, path)


def _wanted(connections: list[Connection]) -> tuple[list[Connection], list[str]]:
    """The connections that carry reports or marks, and a note for each of another type."""
    wanted = []
    notes = set()
    for connection in connections:
        expected = {ROSOUT: _LOG, ROSOUT_AGG: _LOG, REPORTS: _STRING}.get(connection.topic)
        if expected is None and topic_of_marks(connection.topic) is not None:
            expected = _TIME
        if expected == connection.msgtype:
            wanted.append(connection)
        elif expected is not None:
            notes.add(f"{connection.topic} carries {connection.msgtype}, not {expected}: not read")
    return wanted, sorted(notes)


@dataclass
class _Reading:
    """What has been read so far."""

    notes: list[str]
    rosout: EventBuilder = field(default_factory=EventBuilder)
    aggregated: EventBuilder = field(default_factory=EventBuilder)
    topic: EventBuilder = field(default_factory=EventBuilder)
    marks: list[Mark] = field(default_factory=list)
    malformed: int = 0
    malformed_first: list[MalformedRecord] = field(default_factory=list)
    last_seq: dict[str, int] = field(default_factory=dict)
    lost: Counter[str] = field(default_factory=Counter)
    unstamped: int = 0

    def take(self, connection: Connection, bag_ns: int, raw: bytes) -> None:
        """Read one message."""
        topic = connection.topic
        try:
            if topic in {ROSOUT, ROSOUT_AGG}:
                self._log(topic, bag_ns, raw)
            elif topic == REPORTS:
                self._string(_publisher(connection), bag_ns, raw)
            else:
                self._mark(topic, bag_ns, raw)
        except ValueError as error:
            self._skip(topic, bag_ns, str(error), "")

    def _log(self, topic: str, bag_ns: int, raw: bytes) -> None:
        log = decode_log(raw)
        if topic == ROSOUT:
            self._count_lost(log.node, log.seq)
        found = parse_report(log.msg)
        if found is None:
            return
        time_ns = log.stamp_ns or self._from_bag(bag_ns)
        if isinstance(found, Malformed):
            self._skip(topic, time_ns, f"{found.what}, column {found.column}", log.msg)
        else:
            builder = self.rosout if topic == ROSOUT else self.aggregated
            builder.add(time_ns, log.node, found)

    def _string(self, node: str, bag_ns: int, raw: bytes) -> None:
        text = decode_string(raw)
        found = parse_stamped(text)
        if isinstance(found, Malformed):
            self._skip(REPORTS, bag_ns, f"{found.what}, column {found.column}", text)
        else:
            self.topic.add(found.time_ns or self._from_bag(bag_ns), node, found.report)

    def _mark(self, topic: str, bag_ns: int, raw: bytes) -> None:
        named = topic_of_marks(topic)
        if named is not None:
            self.marks.append(Mark(decode_time(raw) or self._from_bag(bag_ns), *named))

    def _from_bag(self, bag_ns: int) -> int:
        self.unstamped += 1
        return bag_ns

    def _count_lost(self, node: str, seq: int) -> None:
        """roscpp and rospy number a node's log messages; a restarted node counts from the start."""
        last = self.last_seq.get(node)
        if last is not None and seq > last + 1:
            self.lost[node] += seq - last - 1
        self.last_seq[node] = seq

    def _skip(self, topic: str, time_ns: int, what: str, text: str) -> None:
        self.malformed += 1
        if len(self.malformed_first) < _SHOWN:
            self.malformed_first.append(MalformedRecord(topic, time_ns, what, text[:_SHOWN_TEXT]))

    def recording(self, name: str, span: tuple[int, int] | None) -> Recording:
        """What was read, every report once; ``span`` has the first and last time of the bag."""
        rosout = self.rosout.build()
        aggregated = self.aggregated.build()
        topic = self.topic.build()
        direct = set(rosout.nodes)
        aggregated = self._drop(
            aggregated,
            np.array([node in direct for node in aggregated.nodes] or [False])[aggregated.node],
            f"on {ROSOUT_AGG} of nodes that report on {ROSOUT} too",
        )
        logged = set(rosout.keys) | {aggregated.keys[code] for code in set(aggregated.key.tolist())}
        topic = self._drop(
            topic,
            np.array([key in logged for key in topic.keys] or [False])[topic.key],
            f"on {REPORTS} with keys that are in the log messages too",
        )
        events = concat([rosout, aggregated, topic])
        marks = tuple(sorted(self.marks, key=Mark.order))
        start_ns, end_ns = self._span(events, marks, span)
        if self.unstamped:
            self.notes.append(
                f"{many(self.unstamped, 'record')} without a stamp got the bag's time"
            )
        return Recording(
            name=name,
            events=events,
            marks=marks,
            start_ns=start_ns,
            end_ns=end_ns,
            malformed=self.malformed,
            malformed_first=tuple(self.malformed_first),
            lost=dict(sorted(self.lost.items())),
            notes=tuple(self.notes),
        )

    def _drop(self, events: Events, twice: Bools, why: str) -> Events:
        count = int(np.count_nonzero(twice))
        if not count:
            return events
        self.notes.append(f"{many(count, 'report')} {why}: counted once")
        return events.take(~twice)

    def _span(
        self, events: Events, marks: tuple[Mark, ...], bag: tuple[int, int] | None
    ) -> tuple[int, int]:
        """First and last time, on the clock of the reports.

        A bag that was recorded on another clock (wall time, the robot on simulated time) says
        nothing about it.
        """
        times = [mark.time_ns for mark in marks]
        if len(events):
            times += [int(events.time_ns[0]), int(events.time_ns[-1])]
        if bag is None or not times:
            return (min(times), max(times)) if times else bag or (0, 0)
        if min(times) > bag[1] + _OTHER_CLOCK_NS or max(times) < bag[0] - _OTHER_CLOCK_NS:
            self.notes.append("the bag was recorded on another clock than the reports'")
            return min(times), max(times)
        return min(*times, bag[0]), max(*times, bag[1])


def _publisher(connection: Connection) -> str:
    extra = connection.ext
    return (extra.callerid or "") if isinstance(extra, ConnectionExtRosbag1) else ""
