"""Runs the command of ``pytpc fix --command``, which flies a mission and records it."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import partial
from itertools import count
from pathlib import Path

from pytpc.base.errors import RunError
from pytpc.base.signals import running, signals_end

_SIGINT_S, _SIGTERM_S = 10.0, 5.0
_STDERR = 2


def free_folder(state_file: Path, number: int) -> Path:
    """A folder for the mission of a try that does not exist yet, beside the state file."""
    names = (f"{state_file.stem}-try-{number}{'' if n == 1 else f'-{n}'}" for n in count(1))
    return next(path for name in names if not (path := state_file.with_name(name)).exists())


def run_command(command: str, number: int, mission: Path, timeout_s: float | None) -> None:
    """Run a shell command, with the try's number and the mission's folder in its environment.

    What it prints goes to standard error. It ends with this process: by Ctrl-C, SIGTERM and SIGHUP.

    Raises:
        RunError: it fails, takes too long, or has recorded nothing.
    """
    env = {**os.environ, "TPC_FIX_TRY": str(number), "TPC_FIX_MISSION": str(mission)}
    again = "run `pytpc fix --command CMD` again, or take the value back with `pytpc fix --undo`"
    sys.stdout.flush()
    shell = partial(
        subprocess.Popen[bytes],
        ["/bin/sh", "-c", command],
        env=env,
        stdin=subprocess.DEVNULL,
        stdout=_STDERR,
        start_new_session=True,
    )
    with signals_end(), running(shell, _SIGINT_S, _SIGTERM_S) as process:
        try:
            status = process.wait(timeout_s)
        except subprocess.TimeoutExpired as error:
            raise RunError(
                f"the command of try {number} took longer than {timeout_s:g} s; {again}"
            ) from error
    if status:
        raise RunError(f"the command of try {number} ended with status {status}; {again}")
    if not mission.exists():
        raise RunError(
            f"the command of try {number} recorded nothing; it must record into $TPC_FIX_MISSION;"
            f" {again}",
            mission,
        )
