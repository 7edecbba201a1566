"""Signals: what ends this process, and the processes that it started."""

from __future__ import annotations

import contextlib
import os
import signal
import stat
import subprocess
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from types import FrameType
from typing import Any, AnyStr

_TURN_S = 0.1


@contextlib.contextmanager
def _handling(handlers: Mapping[int, Any]) -> Iterator[None]:
    """Give signals these handlers within the block, and then those that they had."""
    before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


@contextlib.contextmanager
def signals_end() -> Iterator[None]:
    """Make SIGTERM and SIGHUP raise SystemExit within the block, so that started processes end.

    A SIGHUP that is ignored, as under nohup, stays so. A process in the background ignores SIGINT
    and goes on doing so, but the processes that it starts do not: SIGINT must end them.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def leave(number: int, _frame: FrameType | None) -> None:
        raise SystemExit(128 + number)

    handlers: dict[int, Any] = {signal.SIGTERM: leave}
    if not _hang_up_is_ignored():
        handlers[signal.SIGHUP] = leave
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        handlers[signal.SIGINT] = lambda *_: None
    with _handling(handlers):
        yield


@contextlib.contextmanager
def running(
    start: Callable[[], subprocess.Popen[AnyStr]], sigint_s: float, sigterm_s: float
) -> Iterator[subprocess.Popen[AnyStr]]:
    """A process, the leader of its group, that ends when the block ends, however that is.

    A signal that comes while the process starts is delivered when it has: otherwise, nobody would
    know the process any more, and it would go on.

    Args:
        start: starts it.
        sigint_s: see `end_group`.
        sigterm_s: see `end_group`.
    """
    held: list[int] = []
    heard: list[int] = []
    if threading.current_thread() is threading.main_thread():
        every = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
        heard = [number for number in every if signal.getsignal(number) != signal.SIG_IGN]
    with _handling(dict.fromkeys(heard, lambda came, _frame: held.append(came))):
        process = start()
    with process:
        try:
            for late in held:
                signal.raise_signal(late)
            yield process
        finally:
            if process.poll() is None:
                end_group(process, sigint_s, sigterm_s)


@contextlib.contextmanager
def stop_on_signals() -> Iterator[threading.Event]:
    """An event that SIGINT and SIGTERM set within the block, instead of ending the process."""
    stop = threading.Event()
    numbers = (signal.SIGINT, signal.SIGTERM)
    with _handling(dict.fromkeys(numbers, lambda *_: stop.set())):
        yield stop


class Stop:
    """Whether this process was asked to stop, and asked again while it did.

    It has no lock: a signal's handler may interrupt that of another signal.

    Args:
        reply: what to say on standard error to the first SIGINT or SIGTERM.
    """

    def __init__(self, reply: str = "") -> None:
        """Nobody asked."""
        self._reply = reply
        self._asked = False
        self._asked_again = False

    def is_set(self) -> bool:
        """Whether it was asked to stop."""
        return self._asked

    @property
    def in_a_hurry(self) -> bool:
        """Whether it was asked again: what can be left out is left out."""
        return self._asked_again

    def set(self) -> None:
        """Ask it to stop."""
        self._asked = True

    def set_again(self) -> None:
        """Ask it to stop; from the second time on, not to wait for anything."""
        self._asked_again = self._asked
        self._asked = True

    @contextlib.contextmanager
    def on_signals(self) -> Iterator[None]:
        """Have SIGINT, SIGTERM and SIGHUP ask within the block; call it in the main thread.

        SIGHUP says that the terminal is gone. What is written to it from then on is lost, but is
        no error. Where SIGHUP is ignored, as under nohup, it stays so.
        """

        def hang_up(*_: object) -> None:
            self.set()
            _leave_terminal()

        def ask(*_: object) -> None:
            if self._reply and not self._asked:
                # Streams of Python may be in the middle of a write.
                with contextlib.suppress(OSError):
                    os.write(2, f"\n{self._reply}\n".encode())
            self.set_again()

        handlers: dict[int, Any] = {signal.SIGINT: ask, signal.SIGTERM: ask}
        if not _hang_up_is_ignored():
            handlers[signal.SIGHUP] = hang_up
        with _handling(handlers):
            yield


def _hang_up_is_ignored() -> bool:
    return signal.getsignal(signal.SIGHUP) == signal.SIG_IGN


def _leave_terminal() -> None:
    """Send standard output and error to nowhere, where they are a terminal."""
    nowhere = os.open(os.devnull, os.O_RDWR)
    for descriptor in (1, 2):
        # isatty() says no of a terminal that is gone, but it is still no file and no pipe.
        if stat.S_ISCHR(os.fstat(descriptor).st_mode):
            os.dup2(nowhere, descriptor)
    os.close(nowhere)


def end_group(
    process: subprocess.Popen[Any],
    sigint_s: float,
    sigterm_s: float,
    hurry: Callable[[], bool] = lambda: False,
) -> int:
    """End a process and its group: SIGINT, after a while SIGTERM, then SIGKILL.

    Args:
        process: the leader of its group.
        sigint_s: how long to wait after SIGINT.
        sigterm_s: the same after SIGTERM.
        hurry: whether not to wait any longer after SIGINT.

    Returns:
        Its exit status.
    """
    for number, patience in ((signal.SIGINT, sigint_s), (signal.SIGTERM, sigterm_s)):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, number)
        until = time.monotonic() + patience
        while process.poll() is None and time.monotonic() < until:
            if number == signal.SIGINT and hurry():
                break
            with contextlib.suppress(subprocess.TimeoutExpired):
                return process.wait(_TURN_S)
        if process.poll() is not None:
            return process.wait()
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    return process.wait()
