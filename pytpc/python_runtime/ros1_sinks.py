"""The sinks under ROS 1, through the rospy that the program has imported."""

from __future__ import annotations

import threading
from collections import deque
from time import monotonic_ns
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime import ros1_state
from pytpc.python_runtime.errors import many, warn
from pytpc.python_runtime.sinks import (
    PeriodSummary,
    Sink,
    dropped_line,
    report_line,
    summary_line,
)
from pytpc.python_runtime.waiting import BATCH_NS, TOPIC, WaitingSink

if TYPE_CHECKING:
    from pytpc.python_runtime.sites import Reported

_QUEUE_MESSAGES = 512
_ROSOUT_MESSAGES = 100
# The first message waits until the subscribers that the master knows have connected.
_GATHER_NS = 1_000_000_000


class RosoutSink(Sink):
    """One line on /rosout for each report, like that of C++ nodes in the thesis.

    It uses a publisher of its own, as rospy's log does in the end. ``loginfo`` costs ten times as
    much: for each line it searches the stack, and writes to the console and to a file.
    """

    def __init__(self) -> None:
        super().__init__()
        self._publisher: Any = None
        self._message: Any = None
        self._inside = threading.local()
        self._lost = 0
        # Lines, each with the number of evaluations in it.
        self._waiting: deque[tuple[str, int]] = deque()

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """One line."""
        self._send(f"threshold_information:{report_line(one, result, cmp, thresh, res)}", 1)

    def edge(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """One line."""
        line = f"threshold_information:{report_line(one, result, cmp, thresh, res)}"
        self._waiting.append((line, 1))

    def summary(self, summary: PeriodSummary) -> None:
        """One line."""
        line = f"threshold_summary:{summary_line(summary)}"
        self._waiting.append((line, summary.evaluations))

    def dropped(self, one: Reported, count: int, flops: int, why: str) -> None:
        """One line."""
        self._waiting.append((f"threshold_dropped:{dropped_line(one, count, flops, why)}", 0))

    def settle(self) -> None:
        """Send the waiting lines, now that no lock of the hook is held."""
        while self._waiting:
            try:
                line, evaluations = self._waiting.popleft()
            except IndexError:
                # Another thread was faster.
                return
            self._send(line, evaluations)

    def _send(self, line: str, evaluations: int) -> None:
        ros = ros1_state.rospy()
        # A signal handler may run, and compare, in the middle of this.
        if ros is None or ros.is_shutdown() or getattr(self._inside, "is_inside", False):
            self._lost += evaluations
            return
        self._inside.is_inside = True
        try:
            if self._publisher is None:
                self._advertise(ros)
            message = self._message(level=self._message.INFO, name=ros.get_name(), msg=line)
            message.header.stamp = ros.Time.now()
            self._publisher.publish(message)
        finally:
            self._inside.is_inside = False

    def _advertise(self, ros: Any) -> None:  # noqa: ANN401
        from rosgraph_msgs.msg import Log  # noqa: PLC0415

        # The same arguments as rospy's own publisher, so that they share connections.
        self._publisher = ros.Publisher("/rosout", Log, latch=True, queue_size=_ROSOUT_MESSAGES)
        self._message = Log

    def status(self) -> str:
        """The number of reports that were not sent."""
        return f"not_sent={self._lost}" if self._lost else ""

    def end(self) -> None:
        """Warn about the reports that were not sent."""
        self.settle()
        lost, self._lost = self._lost, 0
        if lost:
            warn(
                f"{many(lost, 'evaluation')} came before rospy.init_node, after the node's end, or"
                " within another report: they are not on /rosout"
            )


class TopicSink(WaitingSink):
    """Batches on /threshold_information; the helper thread sends them."""

    topic = TOPIC
    is_asked_for = True

    def __init__(self) -> None:
        super().__init__()
        self._publisher: Any = None
        self._message: Any = None
        self._expected = 0
        self._gather_until = 0

    def poll(self) -> None:
        """Advertise, and send batches that are due."""
        ros = ros1_state.rospy()
        if ros is None or ros.is_shutdown():
            return
        if self._publisher is None:
            self._advertise(ros)
            return
        self._send(at_once=False)

    def _advertise(self, ros: Any) -> None:  # noqa: ANN401
        self._expected = _subscribers(ros, self.topic)
        self._gather_until = monotonic_ns() + _GATHER_NS
        self._publisher = self._publisher_of(ros)
        # In this hook of the node's shutdown its topics are still open; later they are not.
        ros.on_shutdown(self._send_last)

    def _send_last(self) -> None:
        self.flush()
        self._send(at_once=True)

    def _publisher_of(self, ros: Any) -> Any:  # noqa: ANN401
        from std_msgs.msg import String  # noqa: PLC0415

        self._message = String
        return ros.Publisher(TOPIC, String, queue_size=_QUEUE_MESSAGES)

    def _publish(self, text: str) -> None:
        self._publisher.publish(self._message(data=text))

    def _send(self, *, at_once: bool) -> None:
        connected = self._publisher.get_num_connections()
        now = monotonic_ns()
        if not connected or (
            not at_once and connected < self._expected and now < self._gather_until
        ):
            return
        with self._lock:
            if not self._waiting or (not at_once and now - self._oldest_at < BATCH_NS):
                return
            taken = self._take_all()
        for text, _ in self._messages_of(*taken):
            self._publish(text)

    def status(self) -> str:
        """How many were sent, and whether there are subscribers."""
        is_heard = self._publisher is not None and self._publisher.get_num_connections() > 0
        return (
            f"sent={self._sent} waiting={'yes' if self._waiting else 'no'}"
            f" subscribed={'yes' if is_heard else 'no'}"
        )

    def end(self) -> None:
        """Warn about reports that were not sent."""
        unsent = sum(1 for waiting in self.drain() if waiting.report is not None)
        if unsent and self.is_asked_for:
            warn(
                f"{many(unsent, 'evaluation')} were not sent on {TOPIC}: nobody listened, or the"
                " node was shut down"
            )


class AutoSink(TopicSink):
    """The default: the same batches as log messages on /rosout."""

    topic = "/rosout"
    is_asked_for = False
    poll_s = 0.1

    def _publisher_of(self, ros: Any) -> Any:  # noqa: ANN401
        from rosgraph_msgs.msg import Log  # noqa: PLC0415

        self._message = Log
        self._ros = ros
        # The same arguments as rospy's own publisher, so that they share connections.
        return ros.Publisher(self.topic, Log, latch=True, queue_size=_ROSOUT_MESSAGES)

    def _publish(self, text: str) -> None:
        ros, kind = self._ros, self._message
        message = kind(level=kind.INFO, name=ros.get_name(), msg=f"threshold_batch:{text}")
        message.header.stamp = ros.Time.now()
        self._publisher.publish(message)


def _subscribers(ros: Any, wanted: str) -> int:  # noqa: ANN401
    """The number of the topic's subscribers that the master knows."""
    try:
        _, _, state = ros.get_master().getSystemState()
        return sum(len(nodes) for topic, nodes in state[1] if topic == wanted)
    except Exception:
        # The master does not answer: wait for nobody.
        return 0
