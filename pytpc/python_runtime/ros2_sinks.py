"""The sinks under ROS 2: publishers of the hidden node, used by one thread at a time.

The helper thread sends while the program runs, and the thread that ends the process what is left.
"""

from __future__ import annotations

import contextlib
import time
from collections import deque
from time import monotonic_ns
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime import ros_state
from pytpc.python_runtime.errors import many, warn
from pytpc.python_runtime.ros2_nodes import lines_of
from pytpc.python_runtime.sinks import PeriodSummary, summary_line
from pytpc.python_runtime.waiting import BATCH_NS, TOPIC, Waiting, WaitingSink, line_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pytpc.python_runtime.ros2_link import Link
    from pytpc.python_runtime.sites import Reported

_ROSOUT = "/rosout"
_QUEUE_MESSAGES = 512
_ROSOUT_MESSAGES = 1000
# Subscribers are discovered one after the other: the first message waits for this long, and then
# until those that were discovered have connected.
_DISCOVERY_NS = 200_000_000
_GATHER_NS = 1_000_000_000
# Discovery, and the connection to those discovered, may take more than three seconds.
_KNOWN_NS = 4_000_000_000
# Both get longer on a slow machine.
_ACKNOWLEDGED_S = 1.0
# So long the last messages have to arrive: what the process has not sent again by then is lost, and
# Fast DDS asks every three seconds what is missing. ROS gives a process five seconds to end.
_LAST_ACKNOWLEDGED_S = 4.0
# When the process ends, it spares slow subscribers for this long.
_LAST_NS = 2_000_000_000
# A recorder may start later: what keys belong to which node is told again.
_FIRST_AGAIN_NS, _LAST_AGAIN_NS = 1_000_000_000, 32_000_000_000


class TopicSink(WaitingSink):
    """Batches on /threshold_information."""

    topic = TOPIC
    is_asked_for = True
    _batch_ns = BATCH_NS
    # So long after its start a process that ends still searches for subscribers.
    _search_ns = _KNOWN_NS
    # Messages that may be sent at once, and the pause after so many when all has to be sent.
    _burst = _QUEUE_MESSAGES // 2
    _pause_s = 0.0

    def __init__(
        self,
        link: Callable[[], Link | None],
        reported: Callable[[], list[Reported]] = list,
    ) -> None:
        """``link`` gives the present one, ``reported`` every key that may report."""
        super().__init__()
        self._link = link
        self._reported = reported
        # How many keys of other nodes were told of, to how many subscribers, and when again.
        self._told = 0, 0
        self._again_at = 0
        self._again_ns = _FIRST_AGAIN_NS
        self._on: Link | None = None
        self._publisher: Any = None
        self._kind: Any = None
        # Messages that are not sent yet, each with the number of reports in it.
        self._outbox: deque[tuple[Any, int]] = deque()
        # Whether somebody listened when it last looked.
        self._is_known = False
        self.has_sent = False

    def poll(self) -> None:
        """Send what is due."""
        is_due = monotonic_ns() - self._oldest_at >= self._batch_ns
        if (is_due or self._outbox) and self._is_ready(at_once=False):
            self._send()

    def has_waiting(self) -> bool:
        """Whether there is something to send."""
        return bool(self._waiting or self._outbox)

    def wants_to_send(self) -> bool:
        """Whether somebody may wait for it: also one who is not discovered yet."""
        on = self._on
        is_searching = on is None or monotonic_ns() - on.began_ns < self._search_ns * on.slowness()
        return self.has_waiting() and (self._is_known or is_searching)

    def _is_ready(self, *, at_once: bool) -> bool:
        """Whether something waits, and all subscribers that are known have connected."""
        link = self._link()
        if link is None or not self.has_waiting() or not link.is_open():
            return False
        if link is not self._on:
            self._kind, qos = self._offered()
            self._publisher = link.publisher(self._kind, self.topic, qos)
            self._on = link
        age = monotonic_ns() - link.began_ns
        if age < _DISCOVERY_NS and not at_once:
            return False
        connected = self._publisher.get_subscription_count()
        known = link.known_subscribers(self.topic)
        self._is_known = max(connected, known) > 0
        return bool(connected) and (age >= _GATHER_NS or connected >= known)

    def _offered(self) -> tuple[Any, Any]:
        """The type and the quality of service."""
        from rclpy.qos import QoSProfile  # noqa: PLC0415
        from std_msgs.msg import String  # noqa: PLC0415

        # Reliable and volatile, unless one says otherwise.
        return String, QoSProfile(depth=_QUEUE_MESSAGES)

    def _messages(self) -> Iterable[tuple[Any, int]]:
        """The messages of what waits, each with the number of reports in it."""
        batch, dropped = self._take_all()
        batch.extend(self._nodes())
        node = "" if self._on is None else f",node:{self._on.node_name}"
        for text, reports in self._messages_of(batch, dropped, node):
            yield self._kind(data=text), reports

    def _nodes(self) -> list[Waiting]:
        """Lines that say whose the keys of other nodes are, for whoever has not got them."""
        lines = lines_of(self._reported())
        listeners = self._publisher.get_subscription_count()
        told, now = (len(lines), listeners), monotonic_ns()
        if not lines or (told == self._told and now < self._again_at):
            return []
        self._again_ns = _FIRST_AGAIN_NS if told != self._told else 2 * self._again_ns
        self._again_at = now + min(self._again_ns, _LAST_AGAIN_NS)
        self._told = told
        at_ns = ros_state.time_now_ns()
        return [Waiting(at_ns, None, None, f"threshold_name:{line}") for line in lines]

    def _send(self) -> None:
        """Send some messages; without a pause, all of them."""
        if not self._outbox:
            self._outbox.extend(self._messages())
        for number in range(1, len(self._outbox) + 1):
            # It stays there where a signal has shut the context down.
            self._publisher.publish(self._outbox[0][0])
            self._outbox.popleft()
            self.has_sent = True
            if number % self._burst == 0:
                self._wait_for_receivers()
                if self._pause_s:
                    return

    def _wait_for_receivers(self, patience_s: float = _ACKNOWLEDGED_S) -> None:
        """Wait until all subscribers have what was sent, but not long for one that hangs."""
        from rclpy.duration import Duration  # noqa: PLC0415

        wait = getattr(self._publisher, "wait_for_all_acked", None)
        if wait is not None:
            wait(Duration(seconds=patience_s))

    def finish(self) -> None:
        """Send what waits to those who are known to listen.

        Raises:
            Exception: rclpy's own, where a signal shuts the context down meanwhile.
        """
        link = self._link()
        if link is None or not link.is_open():
            return
        slowness = link.slowness()
        while self.is_last and self.has_waiting() and not self._is_ready(at_once=True):
            age = (monotonic_ns() - link.began_ns) / slowness
            is_known = link.known_subscribers(self.topic) > 0
            if not link.is_open() or age >= (_KNOWN_NS if is_known else self._search_ns):
                break
            time.sleep(0.005)
        until = monotonic_ns() + _LAST_NS
        is_heard = self._on is link and self._publisher.get_subscription_count() > 0
        while is_heard and self.has_waiting():
            self._send()
            time.sleep(self._pause_s if monotonic_ns() < until else 0)
        if is_heard:
            self._wait_for_receivers(_LAST_ACKNOWLEDGED_S)

    def status(self) -> str:
        """How many were sent, and whether there are subscribers."""
        is_heard = False
        if self._on is not None and self._on.is_open():
            is_heard = self._publisher.get_subscription_count() > 0
        return (
            f"sent={self._sent} waiting={'yes' if self.has_waiting() else 'no'}"
            f" subscribed={'yes' if is_heard else 'no'}"
        )

    def end(self) -> None:
        """Send what waits, and warn about reports that were not sent."""
        if not self.is_last:
            # A signal may have shut the context down.
            with contextlib.suppress(Exception):
                self.finish()
        count = sum(1 for waiting in self.drain() if waiting.report is not None)
        count += sum(reports for _, reports in self._outbox)
        self._outbox.clear()
        if count and (self.is_asked_for or self.has_sent):
            warn(f"{many(count, 'evaluation')} were not sent on {self.topic}: nobody listened")


class AutoSink(TopicSink):
    """The default: the same, few a second."""

    is_asked_for = False
    poll_s = 0.1
    _search_ns = 500_000_000


class RosoutSink(TopicSink):
    """One message on /rosout for each report, at the report's own time."""

    topic = _ROSOUT
    # 5,000 a second: a subscriber whose queue is full loses the oldest in silence.
    _burst = 100
    _pause_s = 0.02
    _batch_ns = 0

    def summary(self, summary: PeriodSummary) -> None:
        """One line."""
        line = f"threshold_summary:{summary_line(summary)}"
        self._keep(Waiting(summary.end_ros_ns, None, None, line))

    def _offered(self) -> tuple[Any, Any]:
        from rcl_interfaces.msg import Log  # noqa: PLC0415
        from rclpy.qos import DurabilityPolicy, QoSProfile  # noqa: PLC0415

        return Log, QoSProfile(depth=_ROSOUT_MESSAGES, durability=DurabilityPolicy.TRANSIENT_LOCAL)

    def _messages(self) -> Iterable[tuple[Any, int]]:
        from builtin_interfaces.msg import Time  # noqa: PLC0415

        batch, _ = self._take_all()
        batch.extend(self._nodes())
        name = "" if self._on is None else self._on.node_name.strip("/").replace("/", ".")
        info = self._kind.INFO
        level = info if isinstance(info, int) else info[0]
        for waiting in batch:
            second, rest = divmod(max(0, waiting.at_ns), 1_000_000_000)
            stamp = Time(sec=second, nanosec=rest)
            line = line_of(waiting)
            is_report = waiting.report is not None
            if is_report:
                line = f"threshold_information:{line}"
                self._sent += 1
            own = "" if waiting.one is None else waiting.one.node
            logger = own.strip("/").replace("/", ".") or name
            yield self._kind(stamp=stamp, level=level, name=logger, msg=line), int(is_report)
