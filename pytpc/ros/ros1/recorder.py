"""Records topics of a ROS 1 graph into a bag without losing any message; a program of its own.

All reports of all nodes go through one topic, thousands in a second. Nothing is dropped here: what
is not yet read waits in the publishers, whose queues for /rosout have no end. Each node numbers
its messages on /rosout, so a loss would be seen and is counted.

It runs below ``pytpc.ros.run_mission``, which reads the status file that it keeps.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import struct
import threading
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import BinaryIO

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Writer

from pytpc.base.errors import RunError
from pytpc.ingest.rosout_line import Batch, parse_batch
from pytpc.recording.marks import MarkMessages
from pytpc.ros.ros1.tcpros import RawSubscriber, Source

REPORT = b"threshold_information:"
NODE_NAME = "/tpc_recorder"
STATUS_PERIOD_S = 0.2
DRAIN_S = 2.0
KEEP_S = 1.0
"""At most so much of a mission is lost when the recorder is killed."""
_CLOCK = "/clock"
_MOST_EARLY = 10_000
# rosbag pads the first record's parts to 4096 bytes, rosbags both with their two lengths.
_FIRST_PADDING = 4096 - 69
_FIRST_PADDING_AT = 13 + 4 + 69
_MORE_PADDING = 8
_CHUNK = 1 << 20
_ROSOUT = "/rosout"
_REPORTS = "/threshold_information"
LOOK_PERIOD_S = 1.0
_LOG_HEAD = struct.Struct("<IIII")
_LENGTH = struct.Struct("<I")
_TIME = struct.Struct("<II")


@dataclass(frozen=True)
class Status:
    """What the recorder says of itself; times in ns on the graph's clock, at the start and now.

    ``done_ns`` is when the topic that says so said that the mission is done, None before.
    ``missed_before`` has the messages on /rosout that a node sent before the recorder was
    connected, ``lost`` those that went missing afterwards.
    """

    ready: bool = False
    done_ns: int | None = None
    closed: bool = False
    began_ns: int = 0
    now_ns: int = 0
    reports: int = 0
    messages: dict[str, int] = field(default_factory=dict)
    lost: dict[str, int] = field(default_factory=dict)
    missed_before: dict[str, int] = field(default_factory=dict)

    @property
    def done(self) -> bool:
        """Whether the mission is."""
        return self.done_ns is not None


class LossCounter:
    """Finds gaps in the numbers that each node gives to its messages on /rosout."""

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self._last: dict[str, int] = {}
        self._spared: set[str] = set()
        self.lost: Counter[str] = Counter()
        self.missed_before: Counter[str] = Counter()

    def see(self, data: bytes, sender: str = "", *, latched: bool = False) -> bytes:
        """Take in one serialized rosgraph_msgs/Log; return its text.

        Who sends numbers: ``rosbag play`` does so anew, in one row for all nodes. Where no
        ``sender`` is known it is the node. One that is ``latched``, as rospy's, sends its last text
        anew to each new subscriber, as rosout is one, by a number of its own: no loss, once.

        Raises:
            ValueError: the bytes are shorter than such a message.
        """
        try:
            sequence, _seconds, _nanoseconds, frame = _LOG_HEAD.unpack_from(data)
            at = _LOG_HEAD.size + frame + 1
            name, at = _text(data, at)
            text, _ = _text(data, at)
        except struct.error as error:
            raise ValueError(f"no rosgraph_msgs/Log: {error}") from error
        node = sender or name.decode("utf-8", "replace")
        last = self._last.get(node)
        if last is None:
            # roscpp counts from 0 and rospy from 1, so that 1 may be the first one.
            if sequence > 1:
                self.missed_before[node] = sequence - 1
        elif sequence == last + 2 and latched and node not in self._spared:
            self._spared.add(node)
        elif sequence > last + 1:
            self.lost[node] += sequence - last - 1
        self._last[node] = sequence
        return text


def _text(data: bytes, at: int) -> tuple[bytes, int]:
    (length,) = _LENGTH.unpack_from(data, at)
    start = at + _LENGTH.size
    if start + length > len(data):
        raise struct.error("the text goes past the end")
    return data[start : start + length], start + length


class BatchCounter:
    """The same for numbered messages on /threshold_information (docs/formats.md)."""

    def __init__(self, counter: LossCounter) -> None:
        """Losses are added to those of ``counter``."""
        self._counter = counter
        self._next: dict[tuple[str, int], int] = {}

    def see(self, node: str, data: bytes) -> int:
        """Take in one serialized std_msgs/String; return how many reports it has.

        Raises:
            ValueError: the bytes are shorter than such a message.
        """
        try:
            text, _ = _text(data, 0)
        except struct.error as error:
            raise ValueError(f"no std_msgs/String: {error}") from error
        if not text.startswith(b"#"):
            return 1
        batch = parse_batch(text.partition(b"\n")[0].decode("utf-8", "replace"))
        if not isinstance(batch, Batch):
            return 0
        process = (node, batch.pid)
        expected = self._next.get(process)
        if expected is None and batch.seq:
            self._counter.missed_before[node] += batch.seq
        elif expected is not None and batch.seq > expected:
            self._counter.lost[node] += batch.seq - expected
        self._next[process] = max(expected or 0, batch.seq + batch.count)
        return batch.count


class BagFile:
    """A bag that gets its name only when it is complete."""

    def __init__(self, path: Path) -> None:
        """Open ``<path>.active``; what an earlier run left there is deleted."""
        self._path = path
        self._active = path.with_name(path.name + ".active")
        self._active.unlink(missing_ok=True)
        self._writer = Writer(self._active)
        self._writer.open()
        assert self._writer.bio is not None, "it was opened"
        self._writer.bio.write(b" " * _MORE_PADDING)
        self._pad(self._writer.bio)
        self._writer.bio.seek(0, os.SEEK_END)
        self._kept = time.monotonic()
        self._connections: dict[tuple[str, str, str], Connection] = {}
        self.messages: Counter[str] = Counter()

    def write(self, source: Source, time_ns: int, data: bytes) -> None:
        """Add one message."""
        key = (source.topic, source.md5sum, source.node)
        connection = self._connections.get(key)
        if connection is None:
            # rosbags names types in the way of ROS 2 and writes them in that of ROS 1.
            package, _, name = source.type.partition("/")
            connection = self._writer.add_connection(
                source.topic,
                f"{package}/msg/{name}",
                msgdef=source.definition,
                md5sum=source.md5sum,
                # On /threshold_information nothing else says whose reports these are.
                callerid=source.node,
                latching=1 if source.latched else None,
            )
            self._connections[key] = connection
        # A chunk stands in memory until it is full: with marks alone, for the whole mission.
        due = time.monotonic() - self._kept > KEEP_S or MarkMessages.message_type(source.topic)
        self._writer.chunk_threshold = -1 if due else _CHUNK
        # Before the first /clock it is 0, which rosbag play and info take for a broken entry.
        self._writer.write(connection, max(time_ns, 1), data)
        if due and self._writer.bio is not None:
            self._writer.bio.flush()
            self._kept = time.monotonic()
        self.messages[source.topic] += 1

    def close(self) -> None:
        """Write the index and give the file its name."""
        self._writer.close()
        with self._active.open("r+b") as stream:
            self._pad(stream)
        self._active.replace(self._path)

    @staticmethod
    def _pad(stream: BinaryIO) -> None:
        """Make the first record as long as rosbag's own: `rosbag reindex` writes it anew, and what
        is longer then stands in the first chunk."""
        stream.seek(_FIRST_PADDING_AT)
        stream.write(_LENGTH.pack(_FIRST_PADDING))


class Recorder:
    """Takes in messages and keeps the account of them.

    ``sim_time`` says that /clock is the graph's clock, else it is the wall's.
    """

    def __init__(
        self, bag: BagFile, topics: Sequence[str], until: str | None, sim_time: bool
    ) -> None:
        """See the class."""
        self._bag = bag
        self._topics = set(topics)
        self._until = until
        self._sim_time = sim_time
        self._clock_ns = 0
        self._counter = LossCounter()
        self._batches = BatchCounter(self._counter)
        self._reports = 0
        self._done_ns: int | None = None
        self._early: list[tuple[Source, bytes]] = []
        self._began_ns = self.now_ns()

    def add_topic(self, topic: str) -> None:
        """From now on this topic is put into the bag, too."""
        self._topics.add(topic)

    def now_ns(self) -> int:
        """The graph's time; 0 until the first /clock."""
        return self._clock_ns if self._sim_time else time.time_ns()

    def take(self, source: Source, data: bytes) -> None:
        """Put one message into the bag.

        Raises:
            ValueError: a message that is not of the type of its topic; it is in the bag.
        """
        if source.topic == _CLOCK and self._sim_time and len(data) >= _TIME.size:
            seconds, nanoseconds = _TIME.unpack_from(data)
            self._clock_ns = seconds * 1_000_000_000 + nanoseconds
            self._began_ns = self._began_ns or self._clock_ns
        if source.topic in self._topics:
            self._early.append((source, data))
        if self.now_ns() or len(self._early) > _MOST_EARLY:
            self.put_early()
        if source.topic == _ROSOUT:
            text = self._counter.see(data, source.node, latched=source.latched)
            self._reports += text.startswith(REPORT)
        elif source.topic == _REPORTS:
            self._reports += self._batches.see(source.node, data)
        elif source.topic == self._until and any(data) and self._done_ns is None:
            self._done_ns = self.now_ns()

    def put_early(self) -> None:
        """Put what waits for the first /clock into the bag; to be called before it is closed.

        A clock may begin at any time. Messages from before it get its first time, as if they had
        come with it: at 0 they would make the mission as long as the clock's first time.
        """
        for source, data in self._early:
            self._bag.write(source, self.now_ns(), data)
        self._early.clear()

    def status(self, *, closed: bool = False) -> Status:
        """The account until now."""
        return Status(
            ready=True,
            done_ns=self._done_ns,
            closed=closed,
            began_ns=self._began_ns,
            now_ns=self.now_ns(),
            reports=self._reports,
            messages=dict(sorted(self._bag.messages.items())),
            lost=dict(sorted(self._counter.lost.items())),
            missed_before=dict(sorted(self._counter.missed_before.items())),
        )


class Discovery:
    """Finds the topics of observers as they appear, and a master that has forgotten this node.

    The master is asked once a second. One that does not answer is waited for: what is connected
    goes on without it.
    """

    def __init__(
        self, subscriber: RawSubscriber, recorder: Recorder, topics: Sequence[str]
    ) -> None:
        """``topics`` are those that are subscribed to already."""
        self._subscriber = subscriber
        self._recorder = recorder
        self._topics = dict.fromkeys(topics)
        self._looked = 0.0

    def look(self) -> None:
        """Look, where the last time is long enough ago."""
        if time.monotonic() - self._looked < LOOK_PERIOD_S:
            return
        self._looked = time.monotonic()
        try:
            state = self._subscriber.call_master("getSystemState")
        except RunError:
            return
        publishers, subscribers = _topics_of(state, 0), _topics_of(state, 1)
        try:
            for topic in publishers:
                if MarkMessages.message_type(topic) is not None and topic not in self._topics:
                    self._recorder.add_topic(topic)
                    self._subscriber.subscribe(topic)
                    self._topics[topic] = None
            for topic in self._topics:
                # A master that was started anew knows nobody.
                if self._subscriber.name not in subscribers.get(topic, ()):
                    self._subscriber.subscribe(topic)
        except RunError:
            return


def _topics_of(state: object, part: int) -> dict[str, list[str]]:
    """Topic -> nodes of a part of the master's answer; nothing where it is of another form."""
    try:
        return {str(topic): [str(node) for node in nodes] for topic, nodes in state[part]}  # type: ignore[index]
    except (TypeError, ValueError, IndexError, KeyError):
        return {}


def graph_has_sim_time(subscriber: RawSubscriber) -> bool:
    """Whether /clock is the graph's clock."""
    return subscriber.call_master("hasParam", "/use_sim_time") is True and (
        subscriber.call_master("getParam", "/use_sim_time") is True
    )


def save_status(status: Status, path: Path) -> None:
    """Replace the status file; no reader ever sees a half of it."""
    beside = path.with_name(path.name + ".new")
    beside.write_text(json.dumps(asdict(status)), encoding="utf-8")
    beside.replace(path)


def record(bag_path: Path, status_path: Path, topics: Sequence[str], until: str | None) -> None:
    """Record until SIGINT or SIGTERM; needs a master at ROS_MASTER_URI.

    Raises:
        RunError: the master does not answer.
        ValueError: a message that is not of the type of its topic.
    """
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    recorded = list(dict.fromkeys([*topics, *([until] if until is not None else [])]))
    subscriber = RawSubscriber(
        os.environ["ROS_MASTER_URI"],
        NODE_NAME,
        os.environ.get("ROS_IP", "127.0.0.1"),
        list(dict.fromkeys([*recorded, _CLOCK])),
    )
    bag = BagFile(bag_path)
    recorder = Recorder(bag, recorded, until, graph_has_sim_time(subscriber))
    discovery = Discovery(subscriber, recorder, [*recorded, _CLOCK])
    told = 0.0
    while not stop.is_set():
        if time.monotonic() - told > STATUS_PERIOD_S:
            told = time.monotonic()
            save_status(recorder.status(), status_path)
        discovery.look()
        for source, data in subscriber.poll(0.05):
            recorder.take(source, data)
    drain(subscriber, recorder)
    subscriber.close()
    recorder.put_early()
    bag.close()
    save_status(recorder.status(closed=True), status_path)


def drain(subscriber: RawSubscriber, recorder: Recorder) -> None:
    """Take what is still on the way."""
    limit = time.monotonic() + DRAIN_S
    while time.monotonic() < limit:
        waiting = list(subscriber.poll(0.1))
        if not waiting:
            return
        for source, data in waiting:
            recorder.take(source, data)


def main() -> None:
    """Read the arguments that ``pytpc.ros.run_mission`` gives."""
    parser = argparse.ArgumentParser(description="records topics into a bag")
    parser.add_argument("--bag", type=Path, required=True)
    parser.add_argument("--status", type=Path, required=True)
    parser.add_argument("--until")
    parser.add_argument("topics", nargs="+")
    arguments = parser.parse_args()
    try:
        record(arguments.bag, arguments.status, arguments.topics, arguments.until)
    except (RunError, ValueError, OSError) as error:
        raise SystemExit(f"error: {error}") from error


if __name__ == "__main__":
    main()
