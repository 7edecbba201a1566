"""Runs a script as the interpreter would, with reports."""

from __future__ import annotations

import importlib.machinery
import os
import sys
from types import CodeType, ModuleType

from pytpc.python_runtime.errors import HookError
from pytpc.python_runtime.instrument import Instrument
from pytpc.python_runtime.quiet import foreign_frames
from pytpc.python_runtime.relay import relayed


def run_script(path: str, arguments: list[str], instrument: Instrument) -> None:
    """Run the file at ``path`` as ``__main__``; returns when it is through.

    ``sys.argv``, ``sys.path[0]`` and the module are as if it had been started by itself. What it
    raises goes on with a traceback that begins in the script.

    Raises:
        HookError: there is no such file.
    """
    try:
        with open(path, "rb") as stream:
            data = stream.read()
    except OSError as error:
        raise HookError(f"cannot be run: {error.strerror or error}", path) from error
    sys.argv[:] = [path, *arguments]
    if sys.version_info >= (3, 9):
        path = os.path.abspath(path)
    module = ModuleType("__main__")
    loader = importlib.machinery.SourceFileLoader("__main__", path)
    module.__dict__.update(
        __annotations__={},
        __builtins__=sys.modules["builtins"],
        __cached__=None,
        __file__=path,
        __loader__=loader,
        __package__=None,
        __spec__=None,
    )
    module.__doc__ = None
    if not (sys.flags.isolated or getattr(sys.flags, "safe_path", False)):
        sys.path.insert(0, os.path.dirname(os.path.realpath(path)))
    sys.modules["__main__"] = module
    try:
        exec(_code(data, path, instrument), module.__dict__)
    except SystemExit:
        raise
    except BaseException as error:
        _show(error)
        raise


def _code(data: bytes, path: str, instrument: Instrument) -> CodeType:
    found = instrument.code(data, path) or relayed(data, path, instrument)
    return found or compile(data, path, "exec", dont_inherit=True)


def _show(error: BaseException) -> None:
    """Let ``sys.excepthook`` see the script's own frames, and the interpreter end as always.

    The interpreter then takes the exit status, or dies of SIGINT, by itself, but has nothing more
    to say.
    """
    error.__traceback__ = foreign_frames(error.__traceback__)
    kind, traceback = type(error), error.__traceback__
    sys.last_type, sys.last_value, sys.last_traceback = kind, error, traceback
    sys.excepthook(kind, error, traceback)
    sys.excepthook = _silent


def _silent(*_: object) -> None:
    return
