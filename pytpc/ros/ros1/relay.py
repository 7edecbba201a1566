"""The node that passes reports on from /rosout to /threshold_information.

It is for readers that know only the topic, and nodes that report by log messages. The raw
subscriber reads, because it loses nothing while nodes start. rospy publishes: it has a queue and a
thread for each subscriber, so that a slow one delays no other.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Sequence

from pytpc.base.errors import MissingToolError, RunError
from pytpc.base.paths import reach_debians_packages
from pytpc.base.signals import stop_on_signals
from pytpc.base.wording import many
from pytpc.ingest.losses import LossCounter
from pytpc.ingest.ros1 import decode_log
from pytpc.ros.ros1.master import Master, own_host, uri_of
from pytpc.ros.ros1.subscriber import RawSubscriber

ROSOUT = "/rosout"
TOPIC = "/threshold_information"

_NODE = "tpc_relay"
_REPORT = "threshold_information"
_ACCOUNTS = ("threshold_summary", "threshold_dropped", "threshold_name")
_BATCH = "threshold_batch"
# What a slow subscriber may leave waiting before rospy drops the oldest.
_QUEUE = 65_536
_WATCH_S = 2.0
_POLL_S = 0.2
_LEAVE_S = 1.0

Say = Callable[[str], None]


def line_of(message: str, stamp_ns: int) -> str | None:
    """The line on the topic for the text of a log message; None where it is no report.

    >>> line_of("threshold_information:K,1,cmp:2,thresh:1,res:1", 1_500_000_000)
    '1.5000000,K,1,cmp:2,thresh:1,res:1'
    >>> line_of("threshold_dropped:K,count:2,flops:0,why:site", 0)
    '0.0000000,threshold_dropped:K,count:2,flops:0,why:site'
    """
    word, separator, rest = message.partition(":")
    if not separator or word not in (_REPORT, *_ACCOUNTS):
        return None
    seconds, nanoseconds = divmod(stamp_ns, 10**9)
    return f"{seconds}.{nanoseconds // 100:07d},{rest if word == _REPORT else message}"


def lines_of(message: str, stamp_ns: int) -> list[str]:
    """The lines on the topic for the text of a log message, which may be a batch.

    The short summaries of a batch are left out: nobody who knows only the topic reads them.

    >>> lines_of("threshold_batch:#seq:0\\n1.5,K,1,cmp:2,thresh:1,res:1\\n~K,1,2,1,9", 0)
    ['1.5,K,1,cmp:2,thresh:1,res:1']
    """
    if message.startswith(f"{_BATCH}:"):
        return [line for line in message.split("\n")[1:] if line and line[0] not in "@~"]
    line = line_of(message, stamp_ns)
    return [] if line is None else [line]


class Relay:
    """Takes log messages and publishes the reports among them.

    Args:
        publish: publishes one line.
    """

    def __init__(self, publish: Callable[[str], object]) -> None:
        self._publish = publish
        self._counter: LossCounter[str] = LossCounter()
        self.passed_on = 0
        self.malformed = 0

    @property
    def lost(self) -> int:
        """Log messages that did not come, by their numbers."""
        return sum(self._counter.lost.values())

    def take(self, data: bytes, sender: str = "") -> None:
        """Take one serialized rosgraph_msgs/Log; ``sender`` is who published it."""
        try:
            log = decode_log(data)
        except ValueError:
            self.malformed += 1
            return
        self._counter.see(sender or log.node.decode("utf-8", "replace"), log.seq)
        for line in lines_of(log.msg.decode("utf-8", "replace"), log.stamp_ns):
            self._publish(line)
            self.passed_on += 1

    def account(self) -> str:
        """How many reports were passed on, in one sentence without a full stop."""
        text = f"{many(self.passed_on, 'report')} passed on"
        if self.lost:
            text += f", {many(self.lost, 'log message')} never came"
        if self.malformed:
            text += f", {many(self.malformed, 'log message')} could not be read"
        return text


class MasterWatch:
    """Notices that the master went and came back, and registers again.

    Args:
        is_known: asks the master whether it knows this node; raises RunError where it does not
            answer.
        register: registers everything.
        say: gets a sentence at each change.
    """

    def __init__(
        self, is_known: Callable[[], bool], register: Callable[[], None], say: Say
    ) -> None:
        self._is_known = is_known
        self._register = register
        self._say = say
        self._gone = False

    def look(self) -> None:
        """Look once."""
        try:
            if not self._is_known():
                self._register()
                self._say("the ROS master was started again: registered with it")
            elif self._gone:
                self._say("the ROS master answers again")
            self._gone = False
        except RunError as error:
            if not self._gone:
                self._say(f"waiting for the master, while connected nodes are still heard: {error}")
            self._gone = True


def run(arguments: Sequence[str], say: Say) -> None:
    """Relay reports until SIGINT, SIGTERM or the graph ends this node.

    Args:
        arguments: remappings of ROS, as ``__name:=other``; others are ignored.
        say: called with each sentence for the user.

    Raises:
        RunError: the master does not answer at the start.
        MissingToolError: rospy is not installed.
    """
    reach_debians_packages()
    try:
        import rospy  # noqa: PLC0415 (a second, and only with ROS)
        from std_msgs.msg import String  # noqa: PLC0415
    except ImportError as error:
        raise MissingToolError(
            "rospy is not installed; install it with: apt-get install python3-rospy"
        ) from error
    with stop_on_signals() as stop:
        uri = uri_of(os.environ)
        name = _name(arguments)
        # First, because rospy waits forever for a master.
        subscriber = RawSubscriber(
            Master(uri, f"{name}_reader"), own_host(os.environ, uri), [ROSOUT]
        )
        try:
            rospy.init_node(
                name.strip("/"),
                argv=[_NODE, *(word for word in arguments if ":=" in word)],
                disable_signals=True,
                disable_rosout=True,
            )
            publisher = rospy.Publisher(TOPIC, String, queue_size=_QUEUE)
            relay = Relay(lambda line: publisher.publish(String(line)))
            node = Master(uri, rospy.get_name())
            watch = MasterWatch(
                lambda: _knows(node), lambda: _register(subscriber, node, rospy.get_node_uri()), say
            )
            say(f"passing on reports from {ROSOUT} to {TOPIC}")
            _serve(subscriber, relay, watch, lambda: stop.is_set() or rospy.is_shutdown())
            broken = sum(subscriber.broken.values())
            say(relay.account() + (f", {many(broken, 'message')} broken off" if broken else ""))
        finally:
            subscriber.close()
            # It calls the master, without a limit in time.
            leaving = threading.Thread(target=rospy.signal_shutdown, args=("it ends",), daemon=True)
            leaving.start()
            leaving.join(_LEAVE_S)


def _serve(
    subscriber: RawSubscriber, relay: Relay, watch: MasterWatch, ended: Callable[[], bool]
) -> None:
    """Relay until ``ended``. The watch has its own thread, because a dead host answers late."""

    def look() -> None:
        while not over.wait(_WATCH_S):
            watch.look()

    over = threading.Event()
    thread = threading.Thread(target=look, daemon=True)
    thread.start()
    while not ended():
        for source, data in subscriber.poll(_POLL_S):
            relay.take(data, source.node)
    over.set()
    # Messages that are still on the way.
    until = time.monotonic() + 1.0
    while time.monotonic() < until:
        waiting = list(subscriber.poll(0.05))
        if not waiting:
            break
        for source, data in waiting:
            relay.take(data, source.node)


def _knows(node: Master) -> bool:
    """Whether the master lists this node among the publishers of the topic."""
    return node.caller in node.state().publishers.get(TOPIC, ())


def _register(subscriber: RawSubscriber, node: Master, uri: str) -> None:
    # rospy does not register again by itself; subscribers are told by the master.
    node.call("registerPublisher", TOPIC, "std_msgs/String", uri)
    subscriber.register()


def _name(arguments: Sequence[str]) -> str:
    """The node's full name: ``__name`` and ``__ns`` of roslaunch, else the usual one."""
    given = dict(word.split(":=", 1) for word in arguments if ":=" in word)
    namespace = given.get("__ns", os.environ.get("ROS_NAMESPACE", "")).strip("/")
    name = given.get("__name", _NODE).strip("/")
    return f"/{namespace}/{name}" if namespace else f"/{name}"
