"""Records topics of a ROS 1 graph into a bag without losing any message; a program of its own.

rosbag's recorder keeps at most 100 waiting messages of a topic and drops the rest, and all reports
of all nodes go through one topic: at 2,400 messages a second on a busy machine it lost one in a
thousand. Here nothing is dropped: what is not yet read waits in the publishers, whose queues for
/rosout have no end. Each node numbers its messages on /rosout, so a loss would be seen and counted.

It runs below ``pytpc.mission``, which reads the status file that it keeps.
"""

from __future__ import annotations

import argparse
import json
import signal
import struct
import threading
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Protocol

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Writer

REPORT = b"threshold_information:"
STATUS_PERIOD_S = 0.2
_LOG_HEAD = struct.Struct("<IIII")
_LENGTH = struct.Struct("<I")


@dataclass
class Status:
    """What the recorder says of itself; times in ns on the graph's clock, at the start and now.

    ``missed_before`` has the messages on /rosout that a node sent before the recorder was
    connected, ``lost`` those that went missing afterwards.
    """

    ready: bool = False
    done: bool = False
    closed: bool = False
    began_ns: int = 0
    now_ns: int = 0
    reports: int = 0
    messages: dict[str, int] = field(default_factory=dict)
    lost: dict[str, int] = field(default_factory=dict)
    missed_before: dict[str, int] = field(default_factory=dict)


class LossCounter:
    """Finds gaps in the numbers that each node gives to its messages on /rosout."""

    def __init__(self) -> None:
        """Nothing was seen yet."""
        self._last: dict[str, int] = {}
        self.lost: Counter[str] = Counter()
        self.missed_before: Counter[str] = Counter()

    def see(self, data: bytes) -> bytes:
        """Take in one serialized rosgraph_msgs/Log; return its text.

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
        node = name.decode("utf-8", "replace")
        last = self._last.get(node)
        # roscpp counts from 1. A node that was restarted counts from the start again.
        if last is None:
            if sequence > 1:
                self.missed_before[node] = sequence - 1
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


class BagFile:
    """A bag that gets its name only when it is complete; ``write`` may be called by any thread."""

    def __init__(self, path: Path) -> None:
        """Open ``<path>.active``; what an earlier run left there is deleted."""
        self._path = path
        self._active = path.with_name(path.name + ".active")
        self._active.unlink(missing_ok=True)
        self._writer = Writer(self._active)
        self._writer.open()
        self._lock = threading.Lock()
        self._connections: dict[str, Connection] = {}
        self._open = True
        self.messages: Counter[str] = Counter()

    def write(self, topic: str, header: dict[str, str], time_ns: int, data: bytes) -> None:
        """Add one message; ``header`` is that of the connection it came on."""
        with self._lock:
            if not self._open:
                return
            connection = self._connections.get(topic)
            if connection is None:
                # rosbags names types in the way of ROS 2 and writes them in that of ROS 1.
                package, _, name = header["type"].partition("/")
                connection = self._writer.add_connection(
                    topic,
                    f"{package}/msg/{name}",
                    msgdef=header["message_definition"],
                    md5sum=header["md5sum"],
                )
                self._connections[topic] = connection
            self._writer.write(connection, time_ns, data)
            self.messages[topic] += 1

    def close(self) -> None:
        """Write the index and give the file its name."""
        with self._lock:
            self._open = False
            self._writer.close()
            self._active.replace(self._path)


def save_status(status: Status, path: Path) -> None:
    """Replace the status file; no reader ever sees a half of it."""
    beside = path.with_name(path.name + ".new")
    beside.write_text(json.dumps(asdict(status)), encoding="utf-8")
    beside.replace(path)


class Message(Protocol):
    """What rospy hands over: not decoded, but for a topic to which rospy itself listens."""

    _connection_header: dict[str, str]

    def serialize(self, buff: BytesIO) -> None:
        """Write the bytes that came over the wire."""


class Recorder:
    """Takes in messages of all topics, from any thread, and keeps the account of them."""

    def __init__(
        self,
        bag: BagFile,
        until: str | None,
        now_ns: Callable[[], int],
        on_failure: Callable[[], None],
    ) -> None:
        """``now_ns`` is the graph's clock; ``on_failure`` is called when recording must end."""
        self.failure: Exception | None = None
        self._on_failure = on_failure
        self._bag = bag
        self._until = until
        self._now_ns = now_ns
        self._began_ns = now_ns()
        self._counter = LossCounter()
        self._lock = threading.Lock()
        self._reports = 0
        self._done = False

    def on_message(self, message: Message, topic: str) -> None:
        """Put one message into the bag; a failure is kept, since rospy would only print it."""
        try:
            self._take(message, topic)
        except Exception as error:
            self.failure = self.failure or error
            self._on_failure()

    def _take(self, message: Message, topic: str) -> None:
        buffer = BytesIO()
        message.serialize(buffer)
        data = buffer.getvalue()
        self._bag.write(topic, message._connection_header, self._now_ns(), data)
        if topic == "/rosout":
            with self._lock:
                self._reports += self._counter.see(data).startswith(REPORT)
        elif topic == self._until and any(data):
            self._done = True

    def status(self, *, closed: bool = False) -> Status:
        """The account until now."""
        with self._lock:
            return Status(
                ready=True,
                done=self._done,
                closed=closed,
                began_ns=self._began_ns,
                now_ns=self._now_ns(),
                reports=self._reports,
                messages=dict(sorted(self._bag.messages.items())),
                lost=dict(sorted(self._counter.lost.items())),
                missed_before=dict(sorted(self._counter.missed_before.items())),
            )


def record(bag_path: Path, status_path: Path, topics: Sequence[str], until: str | None) -> None:
    """Record until SIGINT or SIGTERM; needs a master at ROS_MASTER_URI."""
    # Imported here, so that what stands above can be tested without ROS.
    import rospy  # noqa: PLC0415

    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    bag = BagFile(bag_path)
    rospy.init_node("tpc_recorder", disable_signals=True, disable_rosout=True)
    recorder = Recorder(bag, until, lambda: int(rospy.get_rostime().to_nsec()), stop.set)
    for topic in dict.fromkeys([*topics, *([until] if until is not None else [])]):
        rospy.Subscriber(topic, rospy.AnyMsg, recorder.on_message, topic, tcp_nodelay=True)
    save_status(recorder.status(), status_path)
    while not stop.wait(STATUS_PERIOD_S):
        save_status(recorder.status(), status_path)
    rospy.signal_shutdown("recorded")
    if recorder.failure is not None:
        raise SystemExit(f"{type(recorder.failure).__name__}: {recorder.failure}")
    bag.close()
    save_status(recorder.status(closed=True), status_path)


def main() -> None:
    """Read the arguments that ``pytpc.mission`` gives."""
    parser = argparse.ArgumentParser(description="records topics into a bag")
    parser.add_argument("--bag", type=Path, required=True)
    parser.add_argument("--status", type=Path, required=True)
    parser.add_argument("--until")
    parser.add_argument("topics", nargs="+")
    arguments = parser.parse_args()
    record(arguments.bag, arguments.status, arguments.topics, arguments.until)


if __name__ == "__main__":
    main()
