"""What one page may ask for: sizes, numbers and rates."""

from __future__ import annotations

import time
from collections.abc import Callable

MOST_PAGES = 24
"""So many pages are served at a time."""
LONGEST_MESSAGE = 8192
"""Bytes of a message of a page: a note has at most 500 characters, of at most 12 bytes in JSON."""
RATE_PER_S = 20.0
BURST = 60.0
"""Messages of one page: a key that is held down makes some 30 a second."""
BOARDS_ON_THE_WAY = 2
"""A page gets no new board while so many are not confirmed."""


class Rate:
    """A bucket that fills with so many tokens a second, up to a burst.

    Args:
        per_s: tokens a second.
        burst: the most that it holds; it is full at first.
        clock: seconds of a steady clock.
    """

    def __init__(
        self,
        per_s: float = RATE_PER_S,
        burst: float = BURST,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """See the class."""
        self._per_s = per_s
        self._burst = burst
        self._clock = clock
        self._left = burst
        self._at = clock()

    def take(self) -> bool:
        """Take a token; False if there is none."""
        now = self._clock()
        self._left = min(self._burst, self._left + (now - self._at) * self._per_s)
        self._at = now
        if self._left < 1:
            return False
        self._left -= 1
        return True
