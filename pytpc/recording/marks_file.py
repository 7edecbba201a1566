"""The files of a marking session: each change is in one, on the disk, before the next key."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

from pytpc.base.errors import TpcError
from pytpc.recording.marking_session import MarkChange
from pytpc.recording.marks import Mark, joined, read_marks, write_marks
from pytpc.recording.marks_home import MarksHome

END_PATIENCE_S = 10.0
"""So long waits who cannot try again later; another observer writes for some milliseconds."""
KEY_PATIENCE_S = 0.2
"""So long waits who tries again a moment later."""
_TURN_S = 0.01
# Some file systems cannot lock a folder.
_NO_LOCKS = {errno.EBADF, errno.EINVAL, errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS}


class MarksFile:
    """The marks of a recording, which several observers may change at once.

    Each applies only its own changes to what is on the disk by then. New marks go to one file; a
    mark that is in another file of the recording is changed there. A change that cannot be written
    (full disk) is kept, and tried again with the next one and at the end.
    """

    def __init__(self, home: MarksHome) -> None:
        """Read what is there already.

        Raises:
            InputError: one is no file of marks, and is not going to be overwritten.
            TpcError: the folder cannot be made or written.
        """
        path = home.file
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise TpcError(f"cannot be made: {error.strerror}", path.parent) from error
        if not os.access(path.parent, os.W_OK):
            what = (
                "cannot be written: mark into another file with `pytpc mark RECORDING -o FILE`,"
                " which `rank` reads with --marks FILE"
            )
            raise TpcError(what, path.parent)
        self.path = path
        self._home = home
        self.pending: list[MarkChange] = []
        self.fault: str | None = None
        self.before: tuple[Mark, ...] = joined(self._read([path, *home.files()]))

    def holds(self, mark: Mark) -> bool:
        """Whether a change of this mark changes a file; else it is in the recording itself."""
        return any(mark.order() == known.order() for known in self._read(self._files()))

    def take(self, change: MarkChange) -> None:
        """Add a change for the next ``flush``."""
        self.pending.append(change)

    def flush(self, patience_s: float = 0.0) -> str:
        """Write all pending changes; return what is wrong in one line, or an empty text.

        ``fault`` is what was wrong last. If another observer is writing, it waits for so long.
        """
        if not self.pending:
            return ""
        try:
            files = self._files()
            # A folder that has two names is locked once.
            folders = {os.path.realpath(path.parent) for path in files}
            with _locked(sorted(folders), patience_s):
                self._rewrite(files)
        except BlockingIOError:
            self.fault = f"not saved yet: another observer is writing {self.path.name}"
        except (OSError, TpcError) as error:
            self.fault = f"NOT SAVED: {error}"
        else:
            self.pending.clear()
            return ""
        return self.fault

    def _files(self) -> list[Path]:
        """The file of new marks, and all others with marks of the recording."""
        others = [*self._home.files(), *self._home.files_nearby()]
        return [self.path, *(path for path in others if path != self.path)]

    def _rewrite(self, files: list[Path]) -> None:
        """Apply each change to every file that has its mark, or else to that of new marks."""
        before = {path: self._read([path]) for path in files}
        after = dict(before)
        for change in self.pending:
            holders = [path for path in files if any(map(change.is_about, after[path]))]
            for path in holders or [self.path]:
                after[path] = change.apply(after[path])
        for path in files:
            if after[path] != before[path]:
                write_marks(joined(after[path]), path)

    @staticmethod
    def _read(files: Iterable[Path]) -> tuple[Mark, ...]:
        return tuple(mark for path in files if path.exists() for mark in read_marks(path))


@contextlib.contextmanager
def _locked(folders: Iterable[str], patience_s: float) -> Iterator[None]:
    """Hold a lock on each of the folders, which all processes lock in one order.

    Raises:
        OSError: another process holds one for longer than ``patience_s``, or a folder is gone.
    """
    until = time.monotonic() + patience_s
    with contextlib.ExitStack() as exits:
        for folder in folders:
            descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
            exits.callback(os.close, descriptor)
            _lock(descriptor, until)
        yield


def _lock(descriptor: int, until: float) -> None:
    while True:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > until:
                raise
            time.sleep(_TURN_S)
        except OSError as error:
            if error.errno not in _NO_LOCKS:
                raise
            return
        else:
            return
