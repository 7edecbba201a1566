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
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from pytpc.base.errors import RunError
from pytpc.base.signals import stop_on_signals
from pytpc.recording.marks import MarkMessages
from pytpc.ros.intake import CLOCK, Recorder
from pytpc.ros.left_processes import GRAPH_WORD, end_processes
from pytpc.ros.mission_run import RecorderStatus, save_status
from pytpc.ros.ros1.bag_file import BagFile
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.subscriber import RawSubscriber
from pytpc.ros.source import Source

NODE_NAME = "/tpc_recorder"
STATUS_PERIOD_S = 0.2
DRAIN_S = 2.0
LOOK_PERIOD_S = 1.0
_ROSOUT = "/rosout"


class Discovery:
    """Finds the topics of observers as they appear, and a master that has forgotten this node.

    If the master does not answer, connected nodes are still recorded.
    """

    def __init__(
        self, subscriber: RawSubscriber, recorder: Recorder, topics: Sequence[str]
    ) -> None:
        """``topics`` are those that are subscribed to already."""
        self._subscriber = subscriber
        self._recorder = recorder
        self._topics = dict.fromkeys(topics)

    def look(self) -> None:
        """Look once."""
        try:
            self._recorder.see_sim_time(self._subscriber.master.has_sim_time())
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

    def resolved(self) -> Wanted:
        """With full names: publishers do not know theirs without the slash in front."""
        full = [f"/{topic.lstrip('/')}" for topic in self.topics]
        return Wanted(full, None if self.until is None else f"/{self.until.lstrip('/')}")


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
        topics, until = wanted.resolved()
        recorded = list(dict.fromkeys([*topics, *([until] if until is not None else [])]))
        subscribed = list(dict.fromkeys([*recorded, CLOCK]))
        self._tolerated = () if strict else (ValueError,)
        self._subscriber = RawSubscriber(master, host, subscribed)
        try:
            self._bag = BagFile(bag)
            simulated = master.has_sim_time()
            self._recorder = Recorder(self._bag, recorded, until, simulated)
            if not simulated:
                self._recorder.hold()
        except BaseException:
            self._subscriber.close()
            raise
        self._left = threading.Event()
        discovery = Discovery(self._subscriber, self._recorder, subscribed)
        # A thread of its own: a master that hangs is given up after seconds.
        threading.Thread(target=self._look, args=(discovery,), daemon=True).start()

    def tell_marks(self, told: Callable[[Source, int], None] | None) -> None:
        """See `Recorder.tell_marks`."""
        self._recorder.tell_marks(told)

    def step(self) -> RecorderStatus:
        """Take the messages that have come, wait a moment for more, and return the account.

        Raises:
            ValueError: see ``strict``.
        """
        self._take(0.05)
        self._recorder.settle()
        return self._status()

    def finish(self) -> RecorderStatus:
        """Take the messages that are still on the way, leave the graph and close the bag.

        Raises:
            ValueError: see ``strict``.
        """
        limit = time.monotonic() + DRAIN_S
        before = -1
        try:
            # A part of a message is no message yet.
            while time.monotonic() < limit and before != self._subscriber.received:
                before = self._subscriber.received
                self._take(0.1)
        finally:
            self.leave()
            try:
                self._recorder.put_early()
            finally:
                self._bag.close()
        return self._status(closed=True)

    def leave(self) -> None:
        """Leave the graph."""
        self._left.set()
        self._subscriber.close()

    def _look(self, discovery: Discovery) -> None:
        discovery.look()
        while not self._left.wait(LOOK_PERIOD_S):
            discovery.look()

    def _status(self, *, closed: bool = False) -> RecorderStatus:
        account = self._recorder.status(closed=closed)
        heard: list[str] = []
        # Nobody asks any more once reports come, and these may be thousands a second.
        if not (closed or account.is_reporting):
            heard = sorted(n for t, n in self._subscriber.connections() if t == _ROSOUT)
        return replace(account, broken=self._subscriber.broken, heard=tuple(heard))

    def _take(self, timeout_s: float) -> None:
        for source, data in self._subscriber.poll(timeout_s):
            with contextlib.suppress(*self._tolerated):
                self._recorder.take(source, data)


def record(bag: Path, status: Path, wanted: Wanted, parent: int) -> None:
    """Record until SIGINT or SIGTERM; needs a master at ROS_MASTER_URI.

    If the process that started the graph was killed, nobody else would end it: then the bag is
    closed, and all processes of the graph are ended.

    Args:
        bag: the file.
        status: where the account is kept, for the process that started this one.
        wanted: what is recorded.
        parent: number of that process.

    Raises:
        RunError: the master does not answer.
        ValueError: a message that is not of the type of its topic.
    """
    with stop_on_signals() as stop:
        master = Master(os.environ["ROS_MASTER_URI"], NODE_NAME)
        graph = GraphRecorder(master, os.environ.get("ROS_IP", "127.0.0.1"), wanted, bag)
        told = 0.0
        try:
            while not stop.is_set() and os.getppid() == parent:
                account = graph.step()
                if time.monotonic() - told > STATUS_PERIOD_S:
                    told = time.monotonic()
                    # On a full disk the bag can still be closed.
                    with contextlib.suppress(OSError):
                        save_status(account, status)
        finally:
            try:
                account = graph.finish()
            finally:
                if os.getppid() != parent:
                    end_processes(os.environ[GRAPH_WORD])
    save_status(account, status)


def main() -> None:
    """Read the arguments that ``pytpc.ros.ros1.record_mission`` gives."""
    parser = argparse.ArgumentParser(description="records topics into a bag")
    parser.add_argument("--bag", type=Path, required=True)
    parser.add_argument("--status", type=Path, required=True)
    parser.add_argument("--until")
    parser.add_argument("--parent", type=int, required=True)
    parser.add_argument("topics", nargs="+")
    arguments = parser.parse_args()
    wanted = Wanted(arguments.topics, arguments.until)
    try:
        record(arguments.bag, arguments.status, wanted, arguments.parent)
    except (RunError, ValueError, OSError) as error:
        raise SystemExit(f"error: {error}") from error


if __name__ == "__main__":
    main()
