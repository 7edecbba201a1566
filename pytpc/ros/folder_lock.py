"""One recording at a time writes to a folder: a second one would take away the files of the first.

The lock is a hidden file in the folder, held as long as a process that writes there lives.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path

from pytpc.base.errors import RunError

_NAME = ".recording.lock"


@contextlib.contextmanager
def alone_in(folder: Path) -> Iterator[int]:
    """Hold a folder against other recordings within the block.

    A folder that cannot be locked, as on some network drives, is not checked.

    Returns:
        The descriptor of the lock. A process that inherits it holds the folder, too.

    Raises:
        RunError: another recording is being written there.
        OSError: the folder cannot be written.
    """
    path = folder / _NAME
    descriptor = _held(path)
    try:
        yield descriptor
    finally:
        with contextlib.suppress(OSError):
            path.unlink()
        os.close(descriptor)


def _held(path: Path) -> int:
    """A descriptor of the file, locked."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o644)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            raise RunError(
                "another recording is being written in this folder; wait until it ends, or give"
                " another folder with -o",
                path.parent,
            ) from None
        except OSError:
            return descriptor
        # Whoever held it before may have taken the file away after it was opened here.
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(path.stat(), os.fstat(descriptor)):
                return descriptor
        os.close(descriptor)
