"""How nodes are started so that they report: the environment, and the command of one node.

Unchanged Python nodes report if three variables are set (docs/reference/python-runtime.md). A
mission sets them, and so does a user's shell.
"""

from __future__ import annotations

import os
import shlex
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from pytpc import python_runtime
from pytpc.base.errors import InputError
from pytpc.python_runtime.errors import HookError
from pytpc.python_runtime.listed import read_table

ON_PATH = Path(python_runtime.__file__).resolve().parent / "on_path"
SWITCH = "TPC_PYTHON"
STATIC = "TPC_STATIC"
_MODULES = "PYTHONPATH"
RUN = Path(python_runtime.__file__).resolve().parent / "run.py"
_LONGEST_LINE = 512


def has_python(static: Path) -> bool:
    """Whether a file of static information has comparisons in Python sources.

    Raises:
        InputError: it cannot be read, or is not static information.
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
    """The environment that ``with_python`` was given."""
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


def command_of(
    node: Path, arguments: Sequence[str], static: Sequence[Path], *, verbose: bool = False
) -> list[str]:
    """The command line that runs ``node``.

    A Python script is run by the interpreter of its first line, else by ``python3``; anything else,
    such as a C++ node, is run directly.

    Raises:
        InputError: the file does not exist, or nothing can run it.
    """
    words = interpreter_of(node)
    if words is None:
        if not os.access(node, os.X_OK):
            raise InputError("neither a Python script nor executable", node)
        return [str(node), *arguments]
    options = [word for path in static for word in ("--static", str(path))]
    if verbose:
        options.append("--verbose")
    return [*words, str(RUN), *options, "--", str(node), *arguments]


def interpreter_of(node: Path) -> list[str] | None:
    """The words of a script's first line, without ``env``; None if it is not a Python script.

    Raises:
        InputError: it cannot be read.
    """
    try:
        with node.open("rb") as stream:
            line = stream.readline(_LONGEST_LINE)
    except OSError as error:
        raise InputError(f"cannot be run: {error.strerror or error}", node) from error
    if line.startswith(b"#!"):
        words = _words(line[2:].decode("utf-8", "replace"))
        if words and Path(words[0]).name == "env":
            words = [word for word in words[1:] if word != "-S" and "=" not in word]
        if words and Path(words[0]).name.startswith(("python", "pypy")):
            found = shutil.which(words[0])
            if found is None:
                raise InputError(f"its interpreter {words[0]} is not installed", node, 1)
            return [found, *words[1:]]
        return None
    if node.suffix != ".py":
        return None
    found = shutil.which("python3")
    if found is None:
        raise InputError("python3 is not installed", node)
    return [found]


def _words(line: str) -> list[str]:
    try:
        return shlex.split(line)
    except ValueError:
        # A quotation mark without its pair: the kernel knows no quotation marks.
        return line.split()


def _other_folders(env: Mapping[str, str]) -> list[str]:
    folders = env[_MODULES].split(os.pathsep) if env.get(_MODULES) else []
    # An empty one is Python's own word for the current folder.
    return [folder for folder in folders if folder != str(ON_PATH)]


def files_folder(env: Mapping[str, str]) -> Path:
    """Where nodes write their files that are started with this environment."""
    folder = Path(f"/tmp/tpc-{os.geteuid()}")
    if home := env.get("HOME"):
        folder = Path(home) / ".ros/tpc"
    if ros_home := env.get("ROS_HOME"):
        folder = Path(ros_home) / "tpc"
    return Path(env.get("TPC_FOLDER") or folder)
