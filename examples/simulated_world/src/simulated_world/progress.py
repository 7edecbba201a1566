"""How far it is, for people at a terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Iterator
from typing import TypeVar

QUIET_S = 2.0
EVERY_S = 0.2

ItemT = TypeVar("ItemT")


class Progress:
    """One line on stderr, from the third second on and only on a terminal."""

    def __init__(self, what: str, total: int) -> None:
        """``total`` is the number of items."""
        self._what = what
        self._total = max(total, 1)

    def over(self, items: Iterable[ItemT]) -> Iterator[ItemT]:
        """The same items, counted."""
        if not sys.stderr.isatty():
            yield from items
            return
        due = time.monotonic() + QUIET_S
        shown = False
        try:
            for count, item in enumerate(items):
                now = time.monotonic()
                if now >= due:
                    due, shown = now + EVERY_S, True
                    percent = 100 * count // self._total
                    print(f"\r{self._what}: {percent} %", end="", file=sys.stderr, flush=True)
                yield item
        finally:
            if shown:
                print("\r\033[K", end="", file=sys.stderr, flush=True)
