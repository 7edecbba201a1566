"""Finds the launch file of a package, as roslaunch does."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from pathlib import Path

from pytpc.base.errors import RunError
from pytpc.values.trace import roslaunch_python

_PATIENCE_S = 30.0
_ASK = """
import sys
from roslaunch.rlutil import resolve_launch_arguments
print(resolve_launch_arguments(sys.argv[1:])[0])
"""


def find_launch(env: Mapping[str, str], package: str, name: str) -> Path:
    """The launch file that ``roslaunch PACKAGE NAME`` would run in this environment.

    Raises:
        RunError: there is no such package or file, or several; the message is roslaunch's own.
        MissingToolError: roslaunch is not installed.
    """
    what = f"{package} {name}"
    try:
        ran = subprocess.run(
            [roslaunch_python(env), "-c", _ASK, package, name],
            env=dict(env),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_PATIENCE_S,
            check=False,
            # A Ctrl-C is for the program that asks, which may go on.
            start_new_session=True,
        )
    except subprocess.TimeoutExpired as error:
        raise RunError(f"roslaunch did not find {what} in {_PATIENCE_S:.0f} s") from error
    found = ran.stdout.strip().splitlines()[-1:]
    if ran.returncode != 0 or not found or not Path(found[0]).is_file():
        said = (ran.stderr.strip() or "no such launch file").splitlines()[-1]
        raise RunError(
            f"no launch file {what} in the workspace and those that are sourced:"
            f" {said.rpartition('Exception: ')[2]}"
        )
    return Path(found[0])
