"""The command that runs a node with reports: its interpreter, or a C++ node itself."""

from __future__ import annotations

import os
import shlex
import shutil
from collections.abc import Sequence
from pathlib import Path

from pytpc import python_runtime
from pytpc.base.errors import InputError

_RUN = Path(python_runtime.__file__).resolve().parent / "run.py"
_LONGEST_LINE = 512


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
    return [*words, str(_RUN), *options, "--", str(node), *arguments]


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
        words = shlex.split(line[2:].decode("utf-8", "replace"))
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
