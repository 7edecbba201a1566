"""How tests wait for what must come, on a machine that others use, too."""

from __future__ import annotations

import time
from collections.abc import Callable

PATIENCE_S = 600.0
"""The longest time; a test never depends on how fast the machine is."""


def wait_for(done: Callable[[], object]) -> None:
    """Wait until it is so."""
    until = time.monotonic() + PATIENCE_S
    while not done():
        assert time.monotonic() < until
        time.sleep(0.02)
