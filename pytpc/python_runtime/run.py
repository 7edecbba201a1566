"""Runs a Python node with reports: ``python -m pytpc.python_runtime [OPTION]... node.py ARGS``.

It runs under the node's own interpreter, Python 3.8 or newer. Where TPC is not installed for it,
``python /path/to/pytpc/python_runtime/run.py`` does the same. ``pytpc run`` finds a node's
interpreter and starts this.
"""

from __future__ import annotations

import atexit
import importlib.machinery
import os
import sys
from types import ModuleType
from typing import NamedTuple

if __name__ == "__main__" and not __package__:
    # Started by its path: replace its folder, whose modules the program must not import. With -I
    # and -P the interpreter does not add that folder.
    is_safe = sys.flags.isolated or getattr(sys.flags, "safe_path", False)
    room = os.path.dirname(os.path.abspath(__file__))
    sys.path[: 0 if is_safe else 1] = [os.path.dirname(os.path.dirname(room))]

from pytpc.python_runtime.errors import HookError, many, warn
from pytpc.python_runtime.instrument import Instrument
from pytpc.python_runtime.listed import BUILT, ListedFiles, read_table
from pytpc.python_runtime.loader import install
from pytpc.python_runtime.quiet import foreign_frames
from pytpc.python_runtime.runtime import RUNTIME
from pytpc.python_runtime.sites import unknown_outcomes

USAGE = """\
usage: python -m pytpc.python_runtime [--static FILE]... [--verbose] NODE.py [ARGUMENT]...

Runs a Python node; the comparisons of the static information report.

  --static FILE  static information (JSON), or a folder that contains it; may be given
                 several times. Default: TPC_STATIC, separated by colons.
  --verbose      print at the end which files reported, and what was not found
"""


class CommandLine(NamedTuple):
    """The command line."""

    static: list[str]
    verbose: bool
    script: str
    arguments: list[str]


def parsed(words: list[str]) -> CommandLine | None:
    """Parse the command line; None if it asks for help.

    Raises:
        HookError: an unknown option, or no script.
    """
    static: list[str] = []
    verbose = False
    rest = list(words)
    while rest and rest[0].startswith("-"):
        word = rest.pop(0)
        if word in ("-h", "--help"):
            return None
        if word == "--":
            break
        if word == "--verbose":
            verbose = True
        elif word == "--static" and rest:
            static.append(rest.pop(0))
        elif word.startswith("--static="):
            static.append(word.partition("=")[2])
        else:
            raise HookError(f"{word}: no such option, or its value is missing; see --help")
    if not rest:
        raise HookError("no script given; see --help")
    return CommandLine(static, verbose, rest[0], rest[1:])


def static_around(script: str) -> str | None:
    """The static.json of ``pytpc build`` in a folder above the script, else above the current one.

    It looks above the given path first, then above the file that a symbolic link leads to.
    """
    for start in (os.path.abspath(script), os.path.realpath(script), os.path.join(os.getcwd(), "")):
        folder = os.path.dirname(start)
        while True:
            path = os.path.join(folder, BUILT)
            if os.path.isfile(path):
                return path
            if os.path.dirname(folder) == folder:
                break
            folder = os.path.dirname(folder)
    return None


def prepared(given: CommandLine) -> Instrument:
    """Read the static information of a script and install the hook.

    Raises:
        HookError: a file that the user named cannot be read. A file that was found is left out
            with a warning.
    """
    named = os.environ.get("TPC_STATIC", "").split(os.pathsep)
    static = given.static or [path for path in named if path]
    if static:
        table = read_table(static, given.script)
    else:
        static, table = _found(given)
    instrument = Instrument(table, RUNTIME.register)
    if len(table):
        install(instrument)
    elif static:
        warn(f"no comparisons of Python files in {', '.join(static)}")
    else:
        warn(
            "no static information: give --static FILE, set TPC_STATIC, or run pytpc build in the"
            " workspace"
        )
    return instrument


def _found(given: CommandLine) -> tuple[list[str], ListedFiles]:
    path = static_around(given.script)
    if path is None:
        return [], ListedFiles([])
    if given.verbose:
        warn(f"the static information is {path}")
    try:
        return [path], read_table([path], given.script)
    except HookError as error:
        warn(f"{error}; nothing is reported")
        return [path], ListedFiles([])


def main() -> None:
    """Run a node; if that is not possible, print one line and exit with status 1."""
    try:
        given = parsed(sys.argv[1:])
        if given is None:
            sys.stdout.write(USAGE)
            return
        instrument = prepared(given)
        # Remove the entry for this file, or for `-m`.
        del sys.path[0]
        _hide_command(given)
        if given.verbose:
            _tell_at_end(instrument)
        run_script(given.script, given.arguments, instrument)
    except HookError as error:
        sys.stderr.write(f"pytpc: error: {error}\n")
        sys.exit(1)


def run_script(path: str, arguments: list[str], instrument: Instrument) -> None:
    """Run the file at ``path`` as ``__main__``; return when it has ended.

    ``sys.argv``, ``sys.path[0]`` and the module are as if the script had been started directly. An
    exception leaves with a traceback that begins in the script.

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
        code = instrument.code(data, path) or compile(data, path, "exec", dont_inherit=True)
        exec(code, module.__dict__)
    except SystemExit:
        raise
    except BaseException as error:
        _show(error)
        raise


def _show(error: BaseException) -> None:
    """Give ``sys.excepthook`` the script's own frames, and let the interpreter end as usual.

    The interpreter still sets the exit status, or dies of SIGINT, and prints nothing more.
    """
    error.__traceback__ = foreign_frames(error.__traceback__)
    kind, traceback = type(error), error.__traceback__
    sys.last_type, sys.last_value, sys.last_traceback = kind, error, traceback
    sys.excepthook(kind, error, traceback)
    sys.excepthook = lambda *_: None


def _hide_command(given: CommandLine) -> None:
    """Make ``sys.orig_argv`` look as if the script had been started directly."""
    words: list[str] | None = getattr(sys, "orig_argv", None)
    if words is not None:
        mine = len(words) - len(sys.argv)
        before = words[: mine - 1 if words[mine - 1] == "-m" else mine]
        words[:] = [*before, given.script, *given.arguments]


def _tell_at_end(instrument: Instrument) -> None:
    def tell() -> None:
        for done in instrument.done:
            warn(
                f"{done.path}: {many(done.instrumented, 'comparison')} reported,"
                f" {done.missing} not found"
            )
        unknown = unknown_outcomes()
        if unknown:
            what = "not reported: testing the truth could run code of the program"
            warn(f"{many(unknown, 'outcome')} {what}")
        if RUNTIME.file is not None:
            warn(f"reports are in {RUNTIME.file.path}")

    atexit.register(tell)


if __name__ == "__main__":
    main()
