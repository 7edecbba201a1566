"""The CSV file of a marking session: each change is in it, on the disk, before the next key."""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path

from pytpc.base.errors import TpcError
from pytpc.recording.marking_session import MarkChange
from pytpc.recording.marks import Mark, read_marks, write_marks


class MarksFile:
    """A file that several observers may write at once. Each applies only its own changes.

    A change that cannot be written (full disk) is kept, and tried again with the next one and at
    the end.
    """

    def __init__(self, path: Path) -> None:
        """Read what is there already.

        Raises:
            InputError: it is no file of marks, and is not going to be overwritten.
            TpcError: its folder cannot be made.
        """
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise TpcError(f"cannot be made: {error.strerror}", path.parent) from error
        self.path = path
        self.pending: list[MarkChange] = []
        self.fault: str | None = None
        self.before: tuple[Mark, ...] = read_marks(path) if path.exists() else ()

    def take(self, change: MarkChange) -> None:
        """Add a change for the next ``flush``."""
        self.pending.append(change)

    def flush(self) -> str:
        """Write all pending changes; return what is wrong in one line, or an empty text.

        ``fault`` is what was wrong last.
        """
        if not self.pending:
            return ""
        try:
            with _locked(self.path.parent):
                marks = read_marks(self.path) if self.path.exists() else ()
                for change in self.pending:
                    marks = change.apply(marks)
                write_marks(marks, self.path)
        except BlockingIOError:
            self.fault = f"not saved yet: another observer is writing {self.path.name}"
        except (OSError, TpcError) as error:
            self.fault = f"NOT SAVED: {error}"
        else:
            self.pending.clear()
            return ""
        return self.fault


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Hold a lock on the folder.

    Raises:
        OSError: another process holds it, or there is no such folder.
    """
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    finally:
        os.close(descriptor)
