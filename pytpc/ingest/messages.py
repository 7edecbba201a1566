"""Turns ROS messages of any source into reports, summaries and marks.

``Messages`` is fed by the readers of bags, one message at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from typing import Protocol, TypeVar

import numpy as np

from pytpc.base.columns import Bools
from pytpc.base.wording import many
from pytpc.ingest.bag_chunks import ChunkMessages as Chunk
from pytpc.ingest.decoders import Decoders
from pytpc.ingest.gathering import Gathering, Way
from pytpc.ingest.lines import Batches, Lines
from pytpc.ingest.losses import LossCounter
from pytpc.ingest.ros1 import LogMessage, decode_logs
from pytpc.ingest.rosout_line import (
    BATCH_PREFIX,
    DROPPED_PREFIX,
    NAME_PREFIX,
    PREFIX,
    SUMMARY_PREFIX,
    Malformed,
    as_text,
    parse_batch,
)
from pytpc.ingest.short_summary import is_short
from pytpc.ingest.unpacking import LARGEST_MESSAGE
from pytpc.recording.marks import MarkMessages

ROSOUT = "/rosout"
ROSOUT_AGG = "/rosout_agg"
REPORTS = "/threshold_information"
BEGIN = b"threshold_"
"""What every text of a report or summary begins with."""
_TOPICS: Mapping[Way, str] = {"log": ROSOUT, "aggregate": ROSOUT_AGG}

_PREFIX = PREFIX.encode()
_BATCH = BATCH_PREFIX.encode()
_BEGINNING_NS = 1_000_000_000
_OTHERS = tuple(prefix.encode() for prefix in (SUMMARY_PREFIX, DROPPED_PREFIX, NAME_PREFIX))
_WITH_TIME = tuple(b"," + prefix for prefix in _OTHERS)


class _AnyConnection(Protocol):
    @property
    def topic(self) -> str: ...
    @property
    def msgtype(self) -> str: ...


_Connection = TypeVar("_Connection", bound=_AnyConnection)


def wanted(
    connections: Iterable[_Connection], topics: Mapping[str, Set[str]], times: Set[str]
) -> tuple[list[_Connection], list[str]]:
    """The connections that carry reports or marks, and a note for each of another type.

    Args:
        connections: each with a topic and its type.
        topics: the types of messages on each topic of reports.
        times: the types of messages with the time of a mark.
    """
    found = []
    notes = set()
    for connection in connections:
        expected = topics.get(connection.topic)
        of_marks = MarkMessages.message_type(connection.topic)
        if expected is None and of_marks is not None:
            expected = times if of_marks == "Time" else topics[REPORTS]
        if expected is None:
            continue
        if connection.msgtype in expected:
            found.append(connection)
        else:
            kinds = " or ".join(sorted(expected))
            notes.add(f"{connection.topic} carries {connection.msgtype}, not {kinds}: not read")
    return found, sorted(notes)


class _Unstamped:
    """Counts records without a stamp, except at the start of a node.

    On simulated time a node has no time until its first /clock. Its reports from before get the
    bag's time, which is no fault. The start of a node is the first second of its log in the bag.
    """

    def __init__(self) -> None:
        self.count = 0
        self._began_ns: dict[bytes, int] = {}

    def see_all(self, nodes: Sequence[bytes], times_ns: Iterable[int]) -> None:
        """Nodes that logged at these times of the bag, in the bag's order."""
        if len(self._began_ns) == len({*nodes, *self._began_ns}):
            return
        for node, time_ns in zip(nodes, times_ns, strict=True):
            self._began_ns.setdefault(node, int(time_ns))

    def add(self, node: bytes, time_ns: int) -> None:
        """A record without a stamp of a node that was seen."""
        self.count += time_ns - self._began_ns[node] > _BEGINNING_NS


class Messages:
    """Reads the messages of one source.

    Args:
        gathering: where it goes.
        source: the file, for messages.
        decoders: for its serialisation.
        numbered: whether log messages have the publisher's own number (ROS 1).
        latched: senders that send their last message to each new subscriber.
    """

    def __init__(
        self,
        gathering: Gathering,
        source: str,
        decoders: Decoders,
        *,
        numbered: bool = True,
        latched: Set[bytes] = frozenset(),
    ) -> None:
        self._gathering = gathering
        self._source = source
        self._decoders = decoders
        self._numbered = numbered
        self._batches = Batches(gathering)
        self._latched = latched
        self._losses_of_nodes: LossCounter[bytes] = LossCounter()
        self._losses_of_senders: LossCounter[bytes] = LossCounter()
        self._lines: dict[tuple[Way, bool], Lines] = {}
        self._nodes: dict[bytes, int] = {}
        self._unstamped = _Unstamped()

    def take(self, topic: str, caller: str, time_ns: int, raw: bytes) -> None:
        """Read one message; ``time_ns`` is when the recorder got it, ``caller`` who sent it."""
        if len(raw) > LARGEST_MESSAGE:
            self._gathering.skip(topic, time_ns, f"a message of {len(raw):,} bytes", "")
            return
        try:
            if topic in {ROSOUT, ROSOUT_AGG}:
                self._log(topic, caller, time_ns, raw)
            elif topic == REPORTS:
                self._text(caller, time_ns, self._decoders.text(raw))
            else:
                self._mark(topic, time_ns, raw)
        except ValueError as error:
            self._gathering.skip(topic, time_ns, str(error), "")

    def take_logs(self, chunk: Chunk, which: Bools, senders: Mapping[int, bytes]) -> bool:
        """Read many messages of /rosout (ROS 1); False if one is malformed, and none is read.

        ``senders`` has who sent the messages of each connection, empty where that is not known.
        """
        if not which.any():
            return True
        data = np.frombuffer(chunk.data, np.uint8)
        logs = decode_logs(data, chunk.begin[which], chunk.end[which])
        if logs is None:
            return False
        places = zip(logs.node_begin.tolist(), logs.node_end.tolist(), strict=True)
        names = [chunk.data[begin:end] for begin, end in places]
        sent_by = [senders[number] for number in chunk.connection[which].tolist()]
        self._losses_of_nodes.see_all(names, logs.seq, self._latched)
        known = [sender or name for sender, name in zip(sent_by, names, strict=True)]
        self._losses_of_senders.see_all(known, logs.seq, self._latched)
        bag_ns = chunk.time_ns[which]
        self._unstamped.see_all(names, bag_ns)
        codes = {name: self._node(name) for name in set(names)}
        nodes = np.array([codes[name] for name in names], np.int32)
        # The first bytes of each text. A text that is shorter is no report.
        long = logs.msg_end - logs.msg_begin >= len(_PREFIX)
        rows = np.flatnonzero(long)
        first = data[logs.msg_begin[rows, None] + np.arange(len(_PREFIX))]
        begun = (first[:, : len(BEGIN)] == np.frombuffer(BEGIN, np.uint8)).all(axis=1)
        reports = begun & (first == np.frombuffer(_PREFIX, np.uint8)).all(axis=1)
        others = np.concatenate([rows[begun & ~reports], np.flatnonzero(~long)])
        for row in np.sort(others).tolist():
            msg = chunk.data[logs.msg_begin[row] : logs.msg_end[row]]
            log = LogMessage(0, int(logs.stamp_ns[row]), names[row], msg)
            self._text_of(log, ROSOUT, int(bag_ns[row]))
        rows = rows[reports]
        stamps = logs.stamp_ns[rows]
        for row in rows[stamps == 0].tolist():
            self._unstamped.add(names[row], int(bag_ns[row]))
        stamps = np.where(stamps == 0, bag_ns[rows], stamps)
        begins = logs.msg_begin[rows] + len(_PREFIX)
        places = zip(begins.tolist(), logs.msg_end[rows].tolist(), strict=True)
        texts = [chunk.data[begin:end] for begin, end in places]
        lines = self._lines_of("log", ROSOUT, stamped=False, prefix=PREFIX)
        lines.extend(texts, stamps.tolist(), nodes[rows].tolist())
        return True

    def close(self) -> None:
        """Hand in what is still held back."""
        for lines in self._lines.values():
            lines.flush()
            self._unstamped.count += lines.unstamped
        self._batches.close()
        # The sender numbers messages: rosbag play numbers those of all nodes in one row. But rosbag
        # filter names one sender for all. A message is lost only if both ways of counting miss it.
        ways = (self._losses_of_nodes, self._losses_of_senders)
        for name, count in min(ways, key=lambda one: one.lost.total()).lost.items():
            self._gathering.lost[as_text(name)] += count
        if self._unstamped.count:
            self._gathering.late_notes.append(
                f"{many(self._unstamped.count, 'record')} without a stamp got the bag's time"
            )

    def _log(self, topic: str, caller: str, time_ns: int, raw: bytes) -> None:
        log = self._decoders.log(raw)
        if topic == ROSOUT and self._numbered:
            sender = caller.encode() or log.node
            self._losses_of_nodes.see(log.node, log.seq, latched=log.node in self._latched)
            self._losses_of_senders.see(sender, log.seq, latched=sender in self._latched)
        self._text_of(log, topic, time_ns)

    def _text_of(self, log: LogMessage, topic: str, time_ns: int) -> None:
        self._unstamped.see_all([log.node], [time_ns])
        if not log.msg.startswith(BEGIN):
            return
        way: Way = "log" if topic == ROSOUT else "aggregate"
        if log.msg.startswith(_PREFIX):
            if not log.stamp_ns:
                self._unstamped.add(log.node, time_ns)
            stamp_ns = log.stamp_ns or time_ns
            lines = self._lines_of(way, topic, stamped=False, prefix=PREFIX)
            lines.add(log.msg[len(_PREFIX) :], stamp_ns, self._node(log.node))
        elif log.msg.startswith(_BATCH):
            self._batch(way, as_text(log.node), time_ns, log.msg[len(_BATCH) :])
        elif log.msg.startswith(_OTHERS) and topic == ROSOUT:
            # The rosout node passes on the same lines.
            lines = self._lines_of(way, topic, stamped=False, prefix=PREFIX)
            lines.add_other(as_text(log.msg), as_text(log.node), log.stamp_ns or time_ns)

    def _text(self, caller: str, time_ns: int, text: bytes) -> None:
        """Read a message on the topic: one line, or a numbered first line and several others."""
        if not text.startswith(b"#"):
            self._stamped("topic", caller, time_ns, text)
            return
        self._batch("batch", caller, time_ns, text)

    def _batch(self, way: Way, caller: str, time_ns: int, text: bytes) -> None:
        head, _, rest = text.partition(b"\n")
        topic = _TOPICS.get(way, REPORTS)
        batch = parse_batch(as_text(head))
        lines = [line for line in rest.split(b"\n") if line]
        if isinstance(batch, Malformed):
            self._gathering.skip(
                topic, time_ns, f"{batch.what}, column {batch.column}", as_text(head)
            )
        else:
            caller = caller or batch.node
            self._batches.see(caller, batch)
            said = sum(1 for line in lines if not _is_other(line))
            if said != batch.count:
                what = f"the first line announces {batch.count} reports, {said} found"
                self._gathering.skip(topic, time_ns, what, as_text(head))
        for number, line in enumerate(lines, start=2):
            # The rosout node passes on the same batch.
            if way != "aggregate" or not line.startswith(_WITH_TIME[1], line.find(b",")):
                self._stamped(way, caller, time_ns, line, number)

    def _stamped(self, way: Way, caller: str, time_ns: int, line: bytes, number: int = 0) -> None:
        topic = _TOPICS.get(way, REPORTS)
        lines = self._lines_of(way, topic, stamped=True)
        if _is_other(line):
            lines.add_other(as_text(line), caller, time_ns, number)
        else:
            lines.add(line, time_ns, self._node(caller.encode()), number)

    def _mark(self, topic: str, time_ns: int, raw: bytes) -> None:
        if MarkMessages.message_type(topic) == "String":
            self._gathering.mark_messages.add_text(topic, as_text(self._decoders.text(raw)))
        else:
            marked_ns = self._decoders.time(raw)
            self._unstamped.count += not marked_ns
            self._gathering.mark_messages.add_time(topic, marked_ns or time_ns)

    def _node(self, name: bytes) -> int:
        code = self._nodes.get(name)
        if code is None:
            code = self._nodes[name] = self._gathering.nodes.code(as_text(name))
        return code

    def _lines_of(self, way: Way, topic: str, *, stamped: bool, prefix: str = "") -> Lines:
        lines = self._lines.get((way, stamped))
        if lines is None:
            channel = self._gathering.channel(self._source, way, topic)
            lines = Lines(self._batches, channel, stamped=stamped, prefix=prefix)
            self._lines[way, stamped] = lines
        return lines


def _is_other(line: bytes) -> bool:
    comma = line.find(b",")
    return is_short(line) or line.startswith(_WITH_TIME, comma) or line.startswith(_OTHERS)
