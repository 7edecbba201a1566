"""Lets the simulated time wait for a node that answers."""

import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.node import Node

LONGEST_HOLD_S = 2.0
"""A node that is gone must not stop the time for ever."""
REMIND_S = 0.1


class Lockstep:
    """Hears the answers of one node, whose stamps say what they answer; times in ms."""

    def __init__(
        self, node: Node, kind: type, topic: str, then: Callable[[Any], None] | None = None
    ) -> None:
        self._node = node
        self._then = then
        self._sent_ms = 0
        self._answered_ms = 0
        self._subscription = node.create_subscription(kind, topic, self._on_answer, 10)

    def is_there(self) -> bool:
        """Whether somebody may answer."""
        return self._node.count_publishers(self._subscription.topic_name) > 0

    def sent(self, now_ms: int) -> None:
        """Something is to be answered."""
        self._sent_ms = now_ms

    def hold(self, lag_ms: int, remind: Callable[[], None] | None = None) -> None:
        """Wait until the last answer is at most so much older than what was sent.

        ``remind`` is called now and then: the time goes over a connection that may lose it.
        """
        if self._answered_ms == 0 and self._sent_ms > 1000 * LONGEST_HOLD_S:
            return
        until = time.monotonic() + LONGEST_HOLD_S
        while rclpy.ok() and self._sent_ms - self._answered_ms > lag_ms:
            left = until - time.monotonic()
            if left <= 0.0:
                return
            rclpy.spin_once(self._node, timeout_sec=min(left, REMIND_S))
            if remind is not None and self._sent_ms - self._answered_ms > lag_ms:
                remind()

    def _on_answer(self, message: Any) -> None:  # noqa: ANN401
        stamp = message.header.stamp
        self._answered_ms = stamp.sec * 1000 + stamp.nanosec // 1_000_000
        if self._then is not None:
            self._then(message)
