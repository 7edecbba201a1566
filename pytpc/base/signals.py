"""Signals: what ends this process, and the processes that it started."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import threading
from collections.abc import Iterator
from types import FrameType
from typing import Any


@contextlib.contextmanager
def signals_end() -> Iterator[None]:
    """Make SIGTERM and SIGHUP raise SystemExit within the block, so that started processes end.

    A process in the background ignores SIGINT and goes on doing so, but the processes that it
    starts do not: SIGINT must end them.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def leave(number: int, _frame: FrameType | None) -> None:
        raise SystemExit(128 + number)

    before = {number: signal.signal(number, leave) for number in (signal.SIGTERM, signal.SIGHUP)}
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        before[signal.SIGINT] = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def stop_on_signals() -> threading.Event:
    """An event that SIGINT and SIGTERM set, instead of ending the process."""
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    return stop


def end_group(process: subprocess.Popen[Any], sigint_s: float, sigterm_s: float) -> int:
    """End a process and its group: SIGINT, after a while SIGTERM, then SIGKILL.

    Args:
        process: the leader of its group.
        sigint_s: how long to wait after SIGINT.
        sigterm_s: the same after SIGTERM.

    Returns:
        Its exit status.
    """
    for number, patience in ((signal.SIGINT, sigint_s), (signal.SIGTERM, sigterm_s)):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            return process.wait(patience)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    return process.wait()
