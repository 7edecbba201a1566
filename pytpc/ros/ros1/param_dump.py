"""The values of the parameter server, written by rosparam."""

from __future__ import annotations

import contextlib
import subprocess
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from pytpc.base.errors import MissingToolError, RunError

_PATIENCE_S = 20.0
_HURRIED_S = 3.0
_TURN_S = 0.1


def never() -> bool:
    """No hurry."""
    return False


def dump_params(env: Mapping[str, str], path: Path, hurry: Callable[[], bool] = never) -> None:
    """Write the values of the parameter server.

    Args:
        env: says where the master is.
        path: the file.
        hurry: whether to give up after three seconds.

    Raises:
        RunError: rosparam is not there, or fails.
    """
    beside = path.absolute().with_name(f".{path.name}.new")
    try:
        # A Ctrl-C in the terminal does not reach another session.
        process = subprocess.Popen(
            ["rosparam", "dump", str(beside)],
            env=dict(env),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
    except FileNotFoundError as error:
        raise RunError("rosparam not found; install it with: apt-get install ros-core") from error
    try:
        with process:
            said = _end_of(process, hurry)
        if process.returncode != 0:
            last = said.decode("utf-8", "replace").strip().splitlines()[-1:]
            raise RunError(f"rosparam dump failed: {' '.join(last)}")
        beside.replace(path)
    finally:
        # Half of the values, if it did not end well.
        beside.unlink(missing_ok=True)


def _end_of(process: subprocess.Popen[bytes], hurry: Callable[[], bool]) -> bytes:
    """Wait for the end of a process; what it said on standard error.

    Raises:
        RunError: it takes too long, and was killed.
    """
    began = time.monotonic()
    while True:
        with contextlib.suppress(subprocess.TimeoutExpired):
            return process.communicate(timeout=_TURN_S)[1]
        if time.monotonic() - began > (_HURRIED_S if hurry() else _PATIENCE_S):
            process.kill()
            raise RunError("rosparam dump timed out")


def try_dump(env: Mapping[str, str], path: Path, hurry: Callable[[], bool] = never) -> None:
    """Write the values of the parameter server, or nothing.

    The master may be gone, or rosparam not be installed, and the bag is what matters.
    """
    try:
        dump_params(env, path, hurry)
    except (RunError, MissingToolError):
        path.unlink(missing_ok=True)
