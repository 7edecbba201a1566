"""A program in a terminal of its own, for tests of what it does with keys."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

ESCAPES = re.compile(rb"\x1b\[[0-9;?]*[ -/]*[@-~]|\x1b[=>]")


class Terminal:
    """A context manager: the program runs from ``with`` to its end, killed at the latest then."""

    def __init__(
        self,
        argv: Sequence[str],
        folder: Path,
        *,
        env: Mapping[str, str] | None = None,
        columns: int = 80,
        lines: int = 24,
    ) -> None:
        self.master, child = pty.openpty()
        fcntl.ioctl(child, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
        self.before = termios.tcgetattr(child)
        self.child = child
        self.output = b""
        environment = {**os.environ, "TERM": "xterm", **(env or {})}
        for name in ("COLUMNS", "LINES"):
            environment.pop(name, None)
        self.process = subprocess.Popen(
            # setsid, so that this is the terminal whose end the kernel tells of.
            ["setsid", "--ctty", *argv],
            cwd=folder,
            env=environment,
            stdin=child,
            stdout=child,
            stderr=child,
        )

    def __enter__(self) -> Terminal:
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(ProcessLookupError):
            self.process.kill()
        self.process.wait(10)
        for descriptor in (self.master, self.child):
            with suppress(OSError):
                os.close(descriptor)

    @property
    def text(self) -> str:
        """All that was shown, without what moves the cursor."""
        return ESCAPES.sub(b"", self.output).decode("utf-8", "replace")

    def press(self, keys: str) -> None:
        os.write(self.master, keys.encode())

    def wait_for(self, wanted: str, timeout_s: float = 20.0) -> None:
        """Until ``wanted`` is shown after what was waited for before."""
        until = time.monotonic() + timeout_s
        while wanted not in self.text:
            assert time.monotonic() < until, f"no {wanted!r} in {self.text[-2000:]!r}"
            self._read(0.1)
        self.output = b""

    def wait(self, timeout_s: float = 20.0) -> int:
        """The status with which the program ends."""
        until = time.monotonic() + timeout_s
        while self.process.poll() is None:
            assert time.monotonic() < until, f"still there: {self.text[-2000:]!r}"
            self._read(0.1)
        self._read(0.1)
        return self.process.returncode

    def end(self, number: signal.Signals) -> int:
        self.process.send_signal(number)
        return self.wait()

    def read(self) -> None:
        """Take in what is written within a moment."""
        self._read(0.1)

    def _read(self, timeout_s: float) -> None:
        while select.select([self.master], [], [], timeout_s)[0]:
            try:
                self.output += os.read(self.master, 65536)
            except OSError:
                return
            timeout_s = 0.0


def pytpc(*arguments: str) -> list[str]:
    """The command line of pytpc's own command."""
    return [sys.executable, "-m", "pytpc", *arguments]
