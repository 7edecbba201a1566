"""The errors that a user of TPC can meet: one small family, one line each."""

from __future__ import annotations

from os import PathLike, fspath

from pytpc.base.wording import plain


class TpcError(Exception):
    """A problem that the user can fix.

    The command line prints ``str(error)`` as one line and ends with status 1.

    Args:
        message: what is wrong, and where possible what to do, without a final full stop.
        path: the file or folder that it is about.
        line: the line in it, counted from 1.
    """

    def __init__(
        self, message: str, path: str | PathLike[str] | None = None, line: int | None = None
    ) -> None:
        """Keep the parts, so that a caller can show them in another form."""
        super().__init__(message)
        self.message = message
        self.path = None if path is None else fspath(path)
        self.line = line

    def __str__(self) -> str:
        """``path:line: message``, on one line and printable whatever the two hold."""
        place = "" if self.path is None else f"{self.path}:"
        if place and self.line is not None:
            place += f"{self.line}:"
        text = " ".join(self.message.split())
        return plain(f"{place} {text}" if place else text)


class InputError(TpcError):
    """A file that cannot be read, or is not of the expected format."""


class WorkspaceError(TpcError):
    """A workspace that cannot be patched, built or collected from."""


class MissingToolError(TpcError):
    """A program or file that TPC needs is not installed."""


class RunError(TpcError):
    """A program that TPC started failed."""
