"""The sinks that use ROS, through the rospy that the program has imported."""

from __future__ import annotations

import os
import threading
from collections import deque
from time import monotonic_ns
from typing import TYPE_CHECKING, Any, NamedTuple

from pytpc.python_runtime import ros_state
from pytpc.python_runtime.errors import many, warn
from pytpc.python_runtime.light import LightSummary, short_line
from pytpc.python_runtime.sinks import (
    PeriodSummary,
    Sink,
    dropped_line,
    report_line,
    seconds,
    summary_line,
)

if TYPE_CHECKING:
    from pytpc.python_runtime.sites import Reported

TOPIC = "/threshold_information"
_MOST_WAITING = 65536
_MESSAGE_BYTES = 64 * 1024
_QUEUE_MESSAGES = 512
_ROSOUT_MESSAGES = 100
_BATCH_NS = 190_000_000
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
        ros = ros_state.rospy()
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


class _Waiting(NamedTuple):
    """A line to send: an unformatted report, or a finished line. ``at_ns`` is ROS time."""

    at_ns: int
    one: Reported | None
    report: tuple[bool, float, float, bool] | None
    line: str


class TopicSink(Sink):
    """Batches on /threshold_information; the helper thread sends them."""

    # Subscribers come and go.
    is_polled = True
    topic = TOPIC
    is_asked_for = True

    def __init__(self) -> None:
        super().__init__()
        self._waiting: deque[_Waiting] = deque()
        self._lock = threading.RLock()
        self._publisher: Any = None
        self._message: Any = None
        self._expected = 0
        self._gather_until = 0
        self._oldest_at = 0
        self._sent = 0
        self._evicted: dict[Reported, list[int]] = {}
        self._last_evicted: dict[Reported, bool] = {}
        self._dropped_in_all = 0

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """Keep it until the next batch."""
        self._keep(_Waiting(ros_state.time_now_ns(), one, (result, cmp, thresh, res), ""))

    def summary(self, summary: PeriodSummary) -> None:
        """Keep it until the next batch."""
        if isinstance(summary, LightSummary):
            self._short(summary)
            return
        line = f"threshold_summary:{summary_line(summary)}"
        self._keep(_Waiting(summary.end_ros_ns, None, None, line))

    def _short(self, summary: LightSummary) -> None:
        begin, end = seconds(summary.begin_ros_ns, 7), seconds(summary.end_ros_ns, 7)
        line = f"{begin};{end}\n{short_line(summary)}"
        self._keep(_Waiting(summary.end_ros_ns, None, None, line))

    def dropped(self, one: Reported, count: int, flops: int, why: str) -> None:
        """Keep it until the next batch."""
        line = f"threshold_dropped:{dropped_line(one, count, flops, why)}"
        self._dropped_in_all += count
        self._keep(_Waiting(ros_state.time_now_ns(), None, None, line))

    def _keep(self, waiting: _Waiting) -> None:
        with self._lock:
            if not self._waiting:
                self._oldest_at = monotonic_ns()
            self._waiting.append(waiting)
            if len(self._waiting) > _MOST_WAITING:
                self._evict(self._waiting.popleft())

    def _evict(self, oldest: _Waiting) -> None:
        """Count, for its comparison, a report that was dropped to make space."""
        if oldest.one is None or oldest.report is None:
            return
        counts = self._evicted.setdefault(oldest.one, [0, 0])
        last = self._last_evicted.get(oldest.one)
        self._last_evicted[oldest.one] = oldest.report[0]
        counts[0] += 1
        counts[1] += last is not None and last != oldest.report[0]
        self._dropped_in_all += 1

    def poll(self) -> None:
        """Advertise, and send batches that are due."""
        ros = ros_state.rospy()
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
            if not self._waiting or (not at_once and now - self._oldest_at < _BATCH_NS):
                return
            batch, self._waiting = self._waiting, deque()
            evicted, self._evicted = self._evicted, {}
            dropped = self._dropped_in_all
        at_ns = ros_state.time_now_ns()
        for one, (count, flops) in evicted.items():
            line = f"threshold_dropped:{dropped_line(one, count, flops, 'process')}"
            batch.append(_Waiting(at_ns, None, None, line))
        for reports, text in _messages(batch):
            head = (
                f"#seq:{self._sent},count:{reports},dropped:{dropped},pid:{os.getpid()}"
                f",steady:{seconds(monotonic_ns(), 9)}"
            )
            self._sent += reports
            self._publish(head + text)

    def status(self) -> str:
        """How many were sent, and whether there are subscribers."""
        is_heard = self._publisher is not None and self._publisher.get_num_connections() > 0
        return (
            f"sent={self._sent} waiting={'yes' if self._waiting else 'no'}"
            f" subscribed={'yes' if is_heard else 'no'}"
        )

    def end(self) -> None:
        """Warn about reports that were not sent."""
        with self._lock:
            unsent = sum(1 for waiting in self._waiting if waiting.report is not None)
            self._waiting.clear()
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


def _messages(batch: deque[_Waiting]) -> list[tuple[int, str]]:
    """The texts of messages of about 64 KiB, each with the number of its numbered reports."""
    messages: list[tuple[int, str]] = []
    lines: list[str] = []
    count = size = 0
    span = ""
    for waiting in batch:
        line = waiting.line
        if waiting.one is not None and waiting.report is not None:
            line = report_line(waiting.one, *waiting.report)
        mine, _, short = line.partition("\n")
        if short:
            lines.append(f"\n~{short}" if mine == span else f"\n@{mine}\n~{short}")
            span = mine
        else:
            lines.append(f"\n{seconds(waiting.at_ns, 7)},{line}")
        count += waiting.one is not None
        size += len(lines[-1])
        if size >= _MESSAGE_BYTES:
            messages.append((count, "".join(lines)))
            lines, count, size, span = [], 0, 0, ""
    return [*messages, (count, "".join(lines))] if lines else messages


def _subscribers(ros: Any, wanted: str) -> int:  # noqa: ANN401
    """The number of the topic's subscribers that the master knows."""
    try:
        _, _, state = ros.get_master().getSystemState()
        return sum(len(nodes) for topic, nodes in state[1] if topic == wanted)
    except Exception:
        # The master does not answer: wait for nobody.
        return 0
