"""Python's cyclic garbage collector, which reading a large document should not wake."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_collector() -> Iterator[None]:
    """Make many objects that stay, without a search for garbage among them.

    The collector looks through all objects again and again while their number grows, which takes
    longer than to make them. Nothing here makes cycles that have to be found.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
