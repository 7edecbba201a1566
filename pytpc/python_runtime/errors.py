"""The error of the hook, which imports nothing of the other packages."""

from __future__ import annotations


class HookError(Exception):
    """A command line, a script or static information that the hook cannot use.

    ``str(error)`` is ``path:line: message``, on one line whatever the message holds.

    Args:
        message: what is wrong, without a final full stop.
        path: the file or folder that it is about.
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
