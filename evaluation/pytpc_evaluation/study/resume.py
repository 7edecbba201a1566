"""One run of a study at a time, one that works on its results, and nothing left of a killed one."""

from __future__ import annotations

import contextlib
import fcntl
import os
import signal
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path

from pytpc.base.errors import RunError, TpcError

_LOCK_FILE = ".lock"
_RESULTS = "results"
_HOME = b"ROS_HOME="
_PATIENCE_S = 3.0


@contextlib.contextmanager
def alone_in(out: Path) -> Iterator[None]:
    """Within it this is the only run in the study's folder; what a killed one left is ended.

    Raises:
        RunError: another run is at work.
        TpcError: the folder cannot be written.
    """
    with _only_one(out, "another run is at work in this folder"):
        end_leftovers(out)
        yield


def alone_with_results(out: Path) -> AbstractContextManager[None]:
    """Within it this is the only command that makes results of the study; others may fly.

    Raises:
        RunError: another command is at work on them.
        TpcError: the folder cannot be written.
    """
    return _only_one(out / _RESULTS, "another command is at work on these results")


@contextlib.contextmanager
def _only_one(folder: Path, refusal: str) -> Iterator[None]:
    path = folder / _LOCK_FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = path.open("wb")
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror}", path) from error
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise RunError(refusal, folder) from error
        yield


def end_leftovers(out: Path) -> int:
    """End the graphs in a study's folder that outlived the run that began them.

    A run that was killed could not end its master and nodes. They are known by their ROS_HOME.

    Returns:
        How many processes there were.
    """
    found = _processes_of(out)
    for number in (signal.SIGTERM, signal.SIGKILL):
        for pid in _processes_of(out):
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(pid, number)
        until = time.monotonic() + _PATIENCE_S
        while time.monotonic() < until and _processes_of(out):
            time.sleep(0.05)
    return len(found)


def _processes_of(out: Path) -> list[int]:
    below = _HOME + os.fsencode(str(out.absolute())) + b"/"
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit() or int(entry.name) == os.getpid():
            continue
        with contextlib.suppress(OSError):
            words = (entry / "environ").read_bytes().split(b"\0")
            if any(word.startswith(below) for word in words):
                found.append(int(entry.name))
    return found
