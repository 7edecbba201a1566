"""Tries of connections in a few threads, so that none waits behind a host that does not answer."""

from __future__ import annotations

import heapq
import threading
import time
from collections.abc import Callable

_MOST_THREADS = 32

Key = tuple[str, str]


class Connector:
    """Makes each try when it is due.

    ``concurrent.futures`` would wait for its threads when the program ends.

    Args:
        attempt: tries once; in how many seconds to try again, None if not.
    """

    def __init__(self, attempt: Callable[[Key], float | None]) -> None:
        """See the class; threads begin when there is something to do."""
        self._attempt = attempt
        self._due: list[tuple[float, Key]] = []
        self._changed = threading.Condition()
        self._pending = 0
        self._threads = 0
        self._closed = False

    def add(self, key: Key, pause_s: float = 0.0) -> None:
        """Try this after a pause."""
        with self._changed:
            self._pending += 1
            heapq.heappush(self._due, (time.monotonic() + pause_s, key))
            if self._threads < min(self._pending, _MOST_THREADS):
                self._threads += 1
                threading.Thread(target=self._work, daemon=True).start()
            self._changed.notify()

    def close(self) -> None:
        """Begin no more tries. Those that are under way end by themselves."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def _work(self) -> None:
        while (key := self._next()) is not None:
            again_s = self._attempt(key)
            with self._changed:
                self._pending -= 1
            if again_s is not None:
                self.add(key, again_s)

    def _next(self) -> Key | None:
        """Wait for a try that is due; None when closed."""
        with self._changed:
            while not self._closed:
                pause_s = self._due[0][0] - time.monotonic() if self._due else None
                if pause_s is not None and pause_s <= 0:
                    return heapq.heappop(self._due)[1]
                self._changed.wait(pause_s)
            return None
