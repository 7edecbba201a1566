"""Records topics of a ROS 1 graph into a bag without losing any message; a program of its own.

All reports of all nodes go through one topic, thousands in a second. Nothing is dropped here:
unread messages wait in the publishers, whose queues for /rosout have no end. Each node numbers its
messages on /rosout, so each loss is counted.

It runs below ``pytpc.ros.ros1.record_mission``, which reads the status file that it keeps.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from pytpc.base.errors import RunError
from pytpc.base.signals import stop_on_signals
from pytpc.ingest.losses import LossCounter
from pytpc.ingest.ros1 import decode_log, decode_string, decode_time
from pytpc.ingest.rosout_line import DROPPED_PREFIX, Drop, parse_other
from pytpc.recording.marks import MarkMessages
from pytpc.recording.mission import Dropped
from pytpc.ros.mission_run import RecorderStatus, save_status
from pytpc.ros.ros1.bag_file import BagFile
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.subscriber import RawSubscriber, Source

REPORT = b"threshold_information:"
BATCH = b"threshold_batch:"
DROPPED = DROPPED_PREFIX.encode()
NODE_NAME = "/tpc_recorder"
STATUS_PERIOD_S = 0.2
DRAIN_S = 2.0
LOOK_PERIOD_S = 1.0
_CLOCK = "/clock"
_MOST_EARLY = 10_000
_ROSOUT = "/rosout"
_REPORTS = "/threshold_information"
_CLOCK_BYTES = 8


class Recorder:
    """Takes in messages and keeps the account of them.

    ``sim_time`` says that /clock is the graph's clock, else it is the wall's.
    """

    def __init__(
        self, bag: BagFile, topics: Sequence[str], until: str | None, sim_time: bool
    ) -> None:
        self._bag = bag
        self._topics = set(topics)
        self._until = until
        self._sim_time = sim_time
        self._clock_ns = 0
        self._counter: LossCounter[str] = LossCounter()
        self._batches: LossCounter[str] = LossCounter()
        self._reports = 0
        self._dropped: dict[tuple[str, str, str], Dropped] = {}
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
        if source.topic == _CLOCK and self._sim_time and len(data) >= _CLOCK_BYTES:
            self._clock_ns = decode_time(data)
            self._began_ns = self._began_ns or self._clock_ns
        if source.topic in self._topics:
            self._early.append((source, data))
        if self.now_ns() or len(self._early) > _MOST_EARLY:
            self.put_early()
        if source.topic == _ROSOUT:
            log = decode_log(data)
            sender = source.node or log.node.decode("utf-8", "replace")
            self._counter.see(sender, log.seq, latched=source.latched)
            self._reports += log.msg.startswith(REPORT)
            if log.msg.startswith(BATCH):
                self._reports += self._batches.see_text(sender, log.msg[len(BATCH) :])
            self._see_dropped(sender, log.msg)
        elif source.topic == _REPORTS:
            text = decode_string(data)
            self._reports += self._counter.see_text(source.node, text)
            self._see_dropped(source.node, text)
        elif source.topic == self._until and any(data) and self._done_ns is None:
            self._done_ns = self.now_ns()

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
        """Put the messages that wait for the first /clock into the bag; call it before closing.

        A clock may begin at any time. Messages from before it get its first time, as if they had
        come with it: at 0 they would make the mission as long as the clock's first time.
        """
        for source, data in self._early:
            self._bag.write(source, self.now_ns(), data)
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
        )


class Discovery:
    """Finds the topics of observers as they appear, and a master that has forgotten this node.

    The master is asked once a second. If it does not answer, connected nodes are still recorded.
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
            state = self._subscriber.master.state()
            for topic in state.publishers:
                if MarkMessages.message_type(topic) is not None and topic not in self._topics:
                    self._recorder.add_topic(topic)
                    self._subscriber.subscribe(topic)
                    self._topics[topic] = None
            for topic in self._topics:
                # A restarted master knows no node.
                if self._subscriber.master.caller not in state.subscribers.get(topic, ()):
                    self._subscriber.subscribe(topic)
        except RunError:
            return


class Wanted(NamedTuple):
    """Topics to record, and the one of type std_msgs/Bool that says when the mission is done."""

    topics: Sequence[str]
    until: str | None = None


class GraphRecorder:
    """Records topics of a running graph into a bag.

    Args:
        master: the ROS master; its caller is the node that this is.
        host: the address at which the graph reaches this machine.
        wanted: what is recorded; topics of observers are added as they appear.
        bag: the file.
        strict: a message that is not of the type of its topic is an error; otherwise it is in the
            bag, and whoever reads that says so.

    Raises:
        RunError: the master does not answer.
        OSError: the bag cannot be written.
    """

    def __init__(
        self,
        master: Master,
        host: str,
        wanted: Wanted,
        bag: Path,
        *,
        strict: bool = True,
    ) -> None:
        """See the class; on return all topics are registered."""
        topics, until = wanted
        recorded = list(dict.fromkeys([*topics, *([until] if until is not None else [])]))
        subscribed = list(dict.fromkeys([*recorded, _CLOCK]))
        self._tolerated = () if strict else (ValueError,)
        self._subscriber = RawSubscriber(master, host, subscribed)
        try:
            self._bag = BagFile(bag)
            self._recorder = Recorder(self._bag, recorded, until, master.has_sim_time())
        except BaseException:
            self._subscriber.close()
            raise
        self._discovery = Discovery(self._subscriber, self._recorder, subscribed)

    def step(self) -> RecorderStatus:
        """Take the messages that have come, wait a moment for more, and return the account.

        Raises:
            ValueError: see ``strict``.
        """
        self._discovery.look()
        self._take(0.05)
        return self._recorder.status()

    def finish(self) -> RecorderStatus:
        """Take the messages that are still on the way, leave the graph and close the bag.

        Raises:
            ValueError: see ``strict``.
        """
        limit = time.monotonic() + DRAIN_S
        try:
            while time.monotonic() < limit and self._take(0.1):
                pass
        finally:
            self.leave()
        self._recorder.put_early()
        self._bag.close()
        return self._recorder.status(closed=True)

    def leave(self) -> None:
        """Leave the graph."""
        self._subscriber.close()

    def _take(self, timeout_s: float) -> int:
        count = 0
        for source, data in self._subscriber.poll(timeout_s):
            with contextlib.suppress(*self._tolerated):
                self._recorder.take(source, data)
            count += 1
        return count


def record(bag: Path, status: Path, topics: Sequence[str], until: str | None) -> None:
    """Record until SIGINT or SIGTERM; needs a master at ROS_MASTER_URI.

    Raises:
        RunError: the master does not answer.
        ValueError: a message that is not of the type of its topic.
    """
    stop = stop_on_signals()
    master = Master(os.environ["ROS_MASTER_URI"], NODE_NAME)
    graph = GraphRecorder(master, os.environ.get("ROS_IP", "127.0.0.1"), Wanted(topics, until), bag)
    told = 0.0
    while not stop.is_set():
        account = graph.step()
        if time.monotonic() - told > STATUS_PERIOD_S:
            told = time.monotonic()
            save_status(account, status)
    save_status(graph.finish(), status)


def main() -> None:
    """Read the arguments that ``pytpc.ros.ros1.record_mission`` gives."""
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
