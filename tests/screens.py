"""What a terminal shows: a screen of pyte's that reads a program's output."""

from __future__ import annotations

import fcntl
import signal
import struct
import termios
import time
from types import TracebackType

import pyte

from terminals import Terminal


class Screen:
    """A context manager around a ``Terminal``: ``lines`` is what its user sees."""

    def __init__(
        self,
        terminal: Terminal,
        columns: int = 80,
        lines: int = 24,
        kind: type[pyte.Screen] = pyte.Screen,
    ) -> None:
        self.terminal = terminal
        self.screen = kind(columns, lines)
        self._stream = pyte.ByteStream(self.screen)

    def __enter__(self) -> Screen:
        self.terminal.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self.terminal.__exit__(kind, error, at)

    @property
    def lines(self) -> list[str]:
        """The lines without spaces at their ends."""
        return [line.rstrip() for line in self.screen.display]

    @property
    def text(self) -> str:
        return "\n".join(self.lines)

    def bold(self, line: int) -> str:
        """The bold characters of a line, spaces for the others."""
        cells = self.screen.buffer[line]
        columns = range(self.screen.columns)
        return "".join(cells[n].data if cells[n].bold else " " for n in columns)

    def colours(self) -> set[str]:
        """All colours on the screen."""
        cells = [cell for line in self.screen.buffer.values() for cell in line.values()]
        return {cell.fg for cell in cells} | {cell.bg for cell in cells}

    def press(self, keys: str) -> None:
        self.terminal.press(keys)

    def wait_for(self, *wanted: str, timeout_s: float = 20.0) -> None:
        """Until all of ``wanted`` are on the screen at once."""
        until = time.monotonic() + timeout_s
        while not all(one in self.text for one in wanted):
            assert time.monotonic() < until, f"no {wanted!r} on\n{self.text}"
            self.read()

    def wait_without(self, gone: str, timeout_s: float = 20.0) -> None:
        """Until ``gone`` is not on the screen."""
        until = time.monotonic() + timeout_s
        while gone in self.text:
            assert time.monotonic() < until, f"still {gone!r} on\n{self.text}"
            self.read()

    def read(self) -> None:
        """Take in what was written within a moment."""
        self.terminal._read(0.1)
        self._stream.feed(self.terminal.output)
        self.terminal.output = b""

    def resize(self, columns: int, lines: int) -> None:
        size = struct.pack("HHHH", lines, columns, 0, 0)
        fcntl.ioctl(self.terminal.master, termios.TIOCSWINSZ, size)
        self.screen.resize(lines, columns)
        self.screen.reset()
        self.terminal.process.send_signal(signal.SIGWINCH)
