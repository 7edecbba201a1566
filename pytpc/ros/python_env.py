"""The environment in which Python nodes report without anything being changed for them.

Three variables do it (docs/reference/python-runtime.md). Whoever starts nodes, or has them started,
adds them: a mission, a user's shell.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from pytpc import python_runtime
from pytpc.base.errors import InputError
from pytpc.python_runtime.errors import HookError
from pytpc.python_runtime.listed import read_table

ON_PATH = Path(python_runtime.__file__).resolve().parent / "on_path"
SWITCH = "TPC_PYTHON"
STATIC = "TPC_STATIC"
_MODULES = "PYTHONPATH"


def has_python(static: Path) -> bool:
    """Whether a file of static information has comparisons in Python sources.

    Raises:
        InputError: it cannot be read, or is none.
    """
    try:
        return len(read_table([str(static)])) > 0
    except HookError as error:
        raise InputError(error.message, error.path, error.line) from error


def with_python(env: Mapping[str, str], static: Path) -> dict[str, str]:
    """The environment ``env``, in which the Python nodes of ``static`` report."""
    return {
        **env,
        SWITCH: "1",
        STATIC: str(static.absolute()),
        _MODULES: os.pathsep.join([str(ON_PATH), *_other_folders(env)]),
    }


def without_python(env: Mapping[str, str]) -> dict[str, str]:
    """What ``with_python`` was given: nothing of ours is in it."""
    others = _other_folders(env)
    rest = {name: value for name, value in env.items() if name not in (SWITCH, STATIC, _MODULES)}
    return {**rest, _MODULES: os.pathsep.join(others)} if others else rest


def mission_env(env: Mapping[str, str], static: Path) -> dict[str, str]:
    """The environment ``env`` of nodes, with reports of those in Python where there are any.

    Raises:
        InputError: ``static`` is there, and cannot be read.
    """
    if static.is_file() and has_python(static):
        return with_python(env, static)
    return dict(env)


def _other_folders(env: Mapping[str, str]) -> list[str]:
    folders = env[_MODULES].split(os.pathsep) if env.get(_MODULES) else []
    # An empty one is Python's own word for the current folder.
    return [folder for folder in folders if folder != str(ON_PATH)]
