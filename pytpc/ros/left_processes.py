"""Ends what is left of a mission's processes: those with its word in their environment.

A launch file's nodes may be in sessions of their own, and children of processes that are gone.
"""

from __future__ import annotations

import contextlib
import os
import signal
import time
from pathlib import Path

GRAPH_WORD = "TPC_GRAPH"
"""The variable that has the word of a mission."""


def end_processes(word: str) -> None:
    """End what is left of the graph with this word, except this process: SIGTERM, then SIGKILL."""
    for number, patience in ((signal.SIGTERM, 2.0), (signal.SIGKILL, 2.0)):
        left = _processes_with_word(word)
        for pid in left:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(pid, number)
        until = time.monotonic() + patience
        while left and time.monotonic() < until:
            time.sleep(0.05)
            left = _processes_with_word(word)


def _processes_with_word(word: str) -> list[int]:
    """Processes, zombies left out, that have this graph's word in their environment."""
    wanted = f"{GRAPH_WORD}={word}".encode()
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit() or int(entry.name) == os.getpid():
            continue
        with contextlib.suppress(OSError):
            if wanted in (entry / "environ").read_bytes().split(b"\0"):
                found.append(int(entry.name))
    return found
