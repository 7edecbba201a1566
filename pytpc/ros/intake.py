"""Takes in the messages of a graph that is recorded, and keeps the account of them."""

from __future__ import annotations

import contextlib
import time
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Protocol

from pytpc.ingest.decoders import ROS1, Decoders
from pytpc.ingest.losses import LossCounter
from pytpc.ingest.messages import REPORTS, ROSOUT
from pytpc.ingest.rosout_line import (
    DROPPED_PREFIX,
    SUMMARY_PREFIX,
    BatchHead,
    Drop,
    parse_batch,
    parse_other,
)
from pytpc.recording.marks import MarkMessages
from pytpc.recording.mission import Dropped
from pytpc.ros.mission_run import RecorderStatus
from pytpc.ros.source import Source

CLOCK = "/clock"
REPORT = b"threshold_information:"
BATCH = b"threshold_batch:"
_REPORTING = (REPORT, BATCH, SUMMARY_PREFIX.encode())
DROPPED = DROPPED_PREFIX.encode()
_LONGEST_HOLD_NS = 6 * 10**9
_MOST_EARLY = 10_000


class KeptMessages(Protocol):
    """A file that gets the messages; ``messages`` counts them by topic."""

    messages: Counter[str]

    def write(self, source: Source, time_ns: int, data: bytes) -> None:
        """Add one message."""


def sender_of(text: bytes) -> str:
    """The node that a text of several lines names itself, empty if it does not."""
    if not text.startswith(b"#"):
        return ""
    batch = parse_batch(text.partition(b"\n")[0].decode("utf-8", "replace"))
    return batch.node if isinstance(batch, BatchHead) else ""


class Recorder:
    """Takes in messages and keeps the account of them.

    ``sim_time`` says that /clock is the graph's clock, else it is the wall's.
    """

    def __init__(
        self,
        bag: KeptMessages,
        topics: Sequence[str],
        until: str | None,
        sim_time: bool,
        decoders: Decoders = ROS1,
    ) -> None:
        """See the class; ``decoders`` are those of the ROS whose messages come."""
        self._bag = bag
        self._decoders = decoders
        self._topics = set(topics)
        self._until = until
        self._sim_time = sim_time
        self._clock_ns = 0
        self._counter: LossCounter[str] = LossCounter()
        self._batches: LossCounter[str] = LossCounter()
        self._reports = 0
        self._is_reporting = False
        self._dropped: dict[tuple[str, str, str], Dropped] = {}
        self._marks = MarkMessages()
        self._told_mark: Callable[[Source, int], None] | None = None
        self._done_ns: int | None = None
        self._early: list[tuple[Source, bytes, int]] = []
        self._is_held = False
        self._seen: bool | None = None
        self._began_ns = self.now_ns()

    @property
    def waited_ns(self) -> int:
        """For how long the first message that is kept has waited, on the wall's clock."""
        return time.time_ns() - self._early[0][2] if self._early else 0

    def add_topic(self, topic: str) -> None:
        """From now on this topic is put into the bag, too."""
        self._topics.add(topic)

    def hold(self) -> None:
        """Keep messages until ``settle``: the launch file may yet say what the clock is."""
        self._is_held = True

    def see_sim_time(self, simulated: bool) -> None:
        """Whether /use_sim_time is set by now; any thread may say so, ``settle`` acts on it."""
        self._seen = simulated

    def tell_marks(self, told: Callable[[Source, int], None] | None) -> None:
        """Call ``told`` with each mark, and each that is taken back, and its time in ns."""
        self._told_mark = told

    def settle(self) -> None:
        """Put the messages that were kept into the bag, once it is known what the clock is.

        roslaunch sets /use_sim_time before it starts nodes. So the first message settles it, if
        that came before the question. A master that does not answer is not waited for.
        """
        simulated, self._seen = self._seen, None
        if simulated and not self._sim_time:
            self._sim_time = True
            self._began_ns = self._clock_ns
        known = simulated or (simulated is not None and self._early)
        if known or self.waited_ns > _LONGEST_HOLD_NS:
            self._is_held = False
            if self.now_ns():
                self.put_early()

    def now_ns(self) -> int:
        """The graph's time; 0 until the first /clock."""
        return self._clock_ns if self._sim_time else time.time_ns()

    def take(self, source: Source, data: bytes) -> None:
        """Put one message into the bag.

        Raises:
            ValueError: a message that is not of the type of its topic; it is in the bag.
        """
        if source.topic == CLOCK:
            with contextlib.suppress(ValueError):
                self._clock_ns = self._decoders.time(data)
                self._began_ns = self._began_ns or self._clock_ns
        if source.topic in self._topics:
            self._early.append((source, data, time.time_ns()))
        if (self.now_ns() and not self._is_held) or len(self._early) > _MOST_EARLY:
            self.put_early()
        if source.topic == ROSOUT:
            log = self._decoders.log(data)
            sender = source.node or log.node.decode("utf-8", "replace")
            self._is_reporting |= log.msg.startswith(_REPORTING)
            self._counter.see(sender, log.seq, latched=source.latched)
            self._reports += log.msg.startswith(REPORT)
            if log.msg.startswith(BATCH):
                self._reports += self._batches.see_text(sender, log.msg[len(BATCH) :])
            self._see_dropped(sender, log.msg)
        elif source.topic == REPORTS:
            text = self._decoders.text(data)
            node = source.node or sender_of(text)
            self._is_reporting = True
            self._reports += self._counter.see_text(node, text)
            self._see_dropped(node, text)
        elif (
            source.topic == self._until
            and any(data[self._decoders.head :])
            and self._done_ns is None
        ):
            self._done_ns = self.now_ns()
        elif MarkMessages.message_type(source.topic) == "Time":
            # Who reads the bag says what is wrong with a message that is none.
            with contextlib.suppress(ValueError):
                time_ns = self._decoders.time(data)
                self._marks.add_time(source.topic, time_ns or self.now_ns())
                if self._told_mark is not None:
                    self._told_mark(source, time_ns)

    def _see_dropped(self, node: str, text: bytes) -> None:
        """Count what the process of ``node`` says in this text that it dropped."""
        if DROPPED not in text:
            return
        for line in text.decode("utf-8", "replace").split("\n"):
            drop = parse_other(line, node, stamped=not line.startswith(DROPPED_PREFIX))
            if isinstance(drop, Drop):
                known = self._dropped.get((node, drop.key, drop.why))
                count, flops = (known.count, known.flops) if known else (0, 0)
                self._dropped[node, drop.key, drop.why] = Dropped(
                    drop.key, node, count + drop.count, flops + drop.flops, drop.why
                )

    def put_early(self) -> None:
        """Put the messages that wait for a time into the bag; call it before closing.

        A clock may begin at any time. Messages from before it get its first time, as if they had
        come with it: at 0 they would make the mission as long as the clock's first time.
        """
        for source, data, arrived_ns in self._early:
            self._bag.write(source, self.now_ns() if self._sim_time else arrived_ns, data)
        self._early.clear()

    def status(self, *, closed: bool = False) -> RecorderStatus:
        """The account until now."""
        return RecorderStatus(
            ready=True,
            done_ns=self._done_ns,
            closed=closed,
            began_ns=self._began_ns,
            now_ns=self.now_ns(),
            reports=self._reports,
            messages=dict(sorted(self._bag.messages.items())),
            lost=dict(sorted(self._counter.lost.items())),
            missed_before=dict(sorted(self._counter.missed_before.items())),
            dropped=tuple(sorted(self._dropped.values(), key=Dropped.order)),
            is_reporting=self._is_reporting,
            marks=self._marks.count,
        )
