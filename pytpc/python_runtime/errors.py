"""The error of the hook, and its warnings: each is one line on standard error, as in C++."""

from __future__ import annotations

import os


class HookError(Exception):
    """A command line, a script or static information that the hook cannot use.

    ``str(error)`` is ``path:line: message``, always on one line.

    Args:
        message: what is wrong, without a final full stop.
        path: the file or folder with the error.
        line: the line in it, counted from 1.
    """

    def __init__(self, message: str, path: str | None = None, line: int | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.path = path
        self.line = line

    def __str__(self) -> str:
        place = [str(part) for part in (self.path, self.line if self.path else None) if part]
        text = " ".join(self.message.split())
        return f"{':'.join(place)}: {text}" if place else text


def warn(text: str) -> None:
    """Write one line. It is a single write, so that lines of several processes do not mix."""
    try:
        os.write(2, ("tpc: " + " ".join(text.split()) + "\n").encode("utf-8", "replace"))
    except OSError:
        # The program has closed standard error.
        return


def many(count: int, noun: str) -> str:
    """``1 comparison``, ``2 comparisons``."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
