"""A file of recorded messages that is whole whatever ends the recording: a kill, or a full disk."""

from __future__ import annotations

import os
import time
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from pytpc.base.errors import RunError
from pytpc.recording.marks import MarkMessages
from pytpc.ros.source import Source

KEEP_S = 1.0
"""The seconds of a mission that are lost at most when the recorder is killed."""


class KeptFile(ABC):
    """A file that gets its name only when it is complete; before, it ends with ``.active``.

    If it can no longer be written, it gets an index and its name before the error. Room for the
    index is kept free beside it from the beginning.

    Attributes:
        messages: the number of those in the file, by topic.
    """

    kind: ClassVar[str]
    """What to call it."""
    remedy: ClassVar[str]
    """What to do with one that could not be closed."""

    def __init__(self, path: Path) -> None:
        """Open ``<path>.active``; what an earlier run left there is deleted.

        Raises:
            OSError: it cannot be written.
        """
        self.messages: Counter[str] = Counter()
        self._path = path
        self._active = path.with_name(path.name + ".active")
        self._active.unlink(missing_ok=True)
        self._reserve = path.with_name(f".{path.name}.reserve")
        self._reserved = 0
        self._ended: RunError | None = None
        self._kept_at = time.monotonic()
        try:
            self._open()
        except OSError:
            self._abandon()
            self._reserve.unlink(missing_ok=True)
            self._active.unlink(missing_ok=True)
            raise

    def write(self, source: Source, time_ns: int, data: bytes) -> None:
        """Add one message.

        Raises:
            RunError: it cannot be written; the file is closed, and has what was written before.
        """
        self._try(lambda: self._write(source, time_ns, data))

    def close(self) -> None:
        """Write the index and give the file its name.

        Raises:
            RunError: not all of it could be written.
        """
        self._try(self._finish)

    def _is_due(self, topic: str = "") -> bool:
        """Whether what waits has to be written now: after a while, and at once with a mark."""
        is_old = time.monotonic() - self._kept_at > KEEP_S
        return is_old or MarkMessages.message_type(topic) is not None

    def _keep_room(self, needed: int, least: int) -> None:
        """Keep so many bytes free for the index, and more at a time.

        Raises:
            OSError: the disk is full.
        """
        if needed >= self._reserved:
            more = max(2 * needed, least)
            with self._reserve.open("ab") as stream:
                os.posix_fallocate(stream.fileno(), 0, more)
            self._reserved = more

    def _try(self, step: Callable[[], None]) -> None:
        if self._ended is not None:
            raise self._ended
        try:
            step()
        except OSError as error:
            self._ended = self._rescue(error)
            raise self._ended from error

    def _rescue(self, error: OSError) -> RunError:
        """Close the file after its last whole chunk; the error says what became of it."""
        why = error.strerror or str(error)
        try:
            self._reserve.unlink(missing_ok=True)
            lost = self._cut()
            self._finish()
        except OSError:
            self._abandon()
            return RunError(f"cannot be written: {why}; make room; {self.remedy}", self._active)
        return RunError(
            f"the recording ended: {why}; the {self.kind} is closed and has all but the last"
            f" {lost} messages; make room before you record again",
            self._path,
        )

    def _name(self) -> None:
        """Give the file its name: it is complete, and on the disk."""
        self._active.replace(self._path)
        self._reserve.unlink(missing_ok=True)

    @abstractmethod
    def _open(self) -> None:
        """Open the file, and keep room for its index.

        Raises:
            OSError: it cannot be written.
        """

    @abstractmethod
    def _write(self, source: Source, time_ns: int, data: bytes) -> None:
        """See ``write``.

        Raises:
            OSError: the disk is full.
        """

    @abstractmethod
    def _finish(self) -> None:
        """Write what waits and the index, and call ``_name``.

        Raises:
            OSError: the disk is full.
        """

    @abstractmethod
    def _cut(self) -> int:
        """Take what is behind the last whole chunk away; the number of messages that were there.

        Raises:
            OSError: the file cannot be changed.
        """

    @abstractmethod
    def _abandon(self) -> None:
        """Close the stream, whatever it says."""
