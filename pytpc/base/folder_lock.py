"""One process at a time writes to a folder, or to a file in it: a second one would destroy it.

The lock is a hidden file in the folder, held as long as a process that writes there lives.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path

from pytpc.base.errors import RunError

_RECORDING = (
    "another recording is being written in this folder; wait until it ends, or give another folder"
    " with -o"
)


@contextlib.contextmanager
def alone_in(folder: Path, what: str = "recording", in_use: str = _RECORDING) -> Iterator[int]:
    """Hold a folder against others who do the same within the block.

    A folder that cannot be locked, as on some network drives, is not checked.

    Args:
        folder: it exists.
        what: what is written there; something else may be written at the same time.
        in_use: what to say if somebody else writes it.

    Returns:
        The descriptor of the lock. A process that inherits it holds the folder, too.

    Raises:
        RunError: somebody else does; for example, another recording is being written there.
        OSError: the folder cannot be written.
    """
    path = folder / f".{what}.lock"
    descriptor = _held(path, in_use)
    try:
        yield descriptor
    finally:
        with contextlib.suppress(OSError):
            path.unlink()
        os.close(descriptor)


def _held(path: Path, in_use: str) -> int:
    """A descriptor of the file, locked."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o644)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            raise RunError(in_use, path.parent) from None
        except OSError:
            return descriptor
        # Whoever held it before may have taken the file away after it was opened here.
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(path.stat(), os.fstat(descriptor)):
                return descriptor
        os.close(descriptor)
