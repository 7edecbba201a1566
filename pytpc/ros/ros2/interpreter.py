"""Finds the Python interpreter that has rclpy, which pytpc's own need not have."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import project_root
from pytpc.values.trace import interpreter_of
from pytpc.workspace.ros2 import (
    NAMED_PYTHON,
    SYSTEM_PYTHON,
    likely_pythons,
    named_python,
    setups_with_rclpy,
)

HOW_TO = (
    "source ROS 2 (`. /opt/ros/DISTRO/setup.sh`), or name the interpreter that has rclpy:"
    f" export {NAMED_PYTHON}=/path/to/python3"
)
_RCLPY = ("rclpy",)
_LAUNCH = ("launch", "launch_ros")
_PATIENCE_S = 20.0
_NOT_FOR_IT = re.compile(r"TPC_|PYTHONHOME$|PYTHONSTARTUP$|COVERAGE|COV_")


class Interpreter(NamedTuple):
    """An interpreter, and the environment in which it is to run."""

    path: str
    env: Mapping[str, str]


def interpreters(env: Mapping[str, str]) -> Iterator[Interpreter]:
    """The interpreters that may have rclpy, the likeliest first.

    Raises:
        MissingToolError: the one that the user names is not there.
    """
    clean = _without_tpc(env)
    if env.get(NAMED_PYTHON):
        named = named_python(env)
        if named is None:
            raise MissingToolError(f"{NAMED_PYTHON} names no program: {env[NAMED_PYTHON]}")
        yield Interpreter(str(named), clean)
        return
    own = project_root() / ".venv-ros2/bin/python"
    for place in dict.fromkeys([*likely_pythons(env), own]):
        if os.access(place, os.X_OK) and _has_packages(str(place), clean, _RCLPY):
            yield Interpreter(str(place), clean)
    for setup in setups_with_rclpy():
        yield Interpreter(str(SYSTEM_PYTHON), _sourced(setup, clean))


def launch_interpreter(env: Mapping[str, str]) -> str:
    """The interpreter that has launch of ROS 2 in this environment.

    Raises:
        MissingToolError: none has it.
    """
    clean = _without_tpc(env)
    found = [one.path for one in interpreters(env)]
    for python in dict.fromkeys([interpreter_of("ros2", env.get("PATH")), *found]):
        if _has_packages(python, clean, _LAUNCH):
            return python
    raise MissingToolError(
        "launch of ROS 2 is not found; source ROS 2 (`. /opt/ros/DISTRO/setup.sh`), or start"
        " executables without it: pytpc run WORKSPACE PACKAGE EXECUTABLE... [-- --ros-args ...]"
    )


def _has_packages(python: str, env: Mapping[str, str], names: Sequence[str]) -> bool:
    """Whether an interpreter finds packages; they are not imported, which takes a while."""
    code = (
        "import importlib.util as u, sys;"
        " sys.exit(any(u.find_spec(one) is None for one in sys.argv[1:]))"
    )
    try:
        ran = subprocess.run(
            [python, "-c", code, *names],
            env=dict(env),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=_PATIENCE_S,
            check=False,
            # A Ctrl-C ends the recording, and not this.
            start_new_session=True,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return ran.returncode == 0


def _without_tpc(env: Mapping[str, str]) -> dict[str, str]:
    """The environment without TPC's hook: the agent is no node that reports."""
    kept = {name: value for name, value in env.items() if not _NOT_FOR_IT.match(name)}
    entries = [one for one in env.get("PYTHONPATH", "").split(os.pathsep) if one]
    root = str(project_root())
    others = [one for one in entries if not one.startswith(root)]
    kept.pop("PYTHONPATH", None)
    if others:
        kept["PYTHONPATH"] = os.pathsep.join(others)
    return kept


def _sourced(setup: Path, env: Mapping[str, str]) -> dict[str, str]:
    """The environment after sourcing a setup.sh."""
    try:
        ran = subprocess.run(
            ["sh", "-c", '. "$0" >/dev/null 2>&1; env -0', str(setup)],
            env=dict(env),
            capture_output=True,
            timeout=_PATIENCE_S,
            check=False,
            # A Ctrl-C ends the recording, and not this.
            start_new_session=True,
        )
    except (OSError, subprocess.TimeoutExpired):
        return dict(env)
    pairs = (one.partition("=") for one in ran.stdout.decode("utf-8", "replace").split("\0"))
    return {name: value for name, equals, value in pairs if equals} or dict(env)
