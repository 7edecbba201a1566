"""colcon, which builds the packages: its command, its environment, and what its logs say.

The user's own build, install and log folders are not touched: everything goes into ``Bases``.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from glob import escape
from pathlib import Path

from pytpc.base.errors import RunError, WorkspaceError
from pytpc.base.paths import (
    MERGED_FILE,
    OWN_FOLDER,
    conda_prefix,
    search_path,
    without_conda,
)
from pytpc.base.signals import running, signals_end
from pytpc.workspace.packages import Package

_TAIL_LINES = 25
# A disk with fewer free bytes is full: there is no room for one more block of a log.
_FULL = 64 * 1024
_OWN_OPTIONS = ("--build-base", "--install-base", "--log-base", "--paths", "--base-paths")
_HANDLERS = ("console_direct+", "console_cohesion-", "console_stderr-", "summary-")
_ALL_OF_COLCON = "logger_all.log"
_ERROR = re.compile(r"\[[0-9.]+s\] ERROR:colcon\.[^:]*:(.*)")
_EVENT = re.compile(
    r"^\[[0-9.]+\] \((?P<name>[^)]*)\) Job(?P<what>Ended|Skipped): (?P<data>\{.*\})$"
)
# Lists of folders that programs, compilers and CMake search, and flags.
_SEARCHED = {
    "CMAKE_PREFIX_PATH",
    "CPATH",
    "LD_LIBRARY_PATH",
    "LIBRARY_PATH",
    "PKG_CONFIG_PATH",
    "PYTHONPATH",
}
_FLAGS = ("CC", "CXX", "CPP", "LD", "AR", "CFLAGS", "CXXFLAGS", "CPPFLAGS", "LDFLAGS", "CMAKE_ARGS")
_STATUS = re.compile(r"'rc': (?P<rc>[^}]+)\}$")
# Done, interrupted because another one failed, or never begun for that reason.
_NO_FAULT = ("0", "'SIGINT'", "skipped")


@dataclass(frozen=True, slots=True)
class Bases:
    """Where a build puts things: ``build``, ``install`` and ``log`` below ``root``."""

    root: Path

    @classmethod
    def of(cls, workspace: Path) -> Bases:
        """The bases within a workspace: its hidden folder ``.tpc``."""
        return cls(workspace.absolute() / OWN_FOLDER)

    @property
    def build(self) -> Path:
        """CMake's build folders, one per package, and the static information in them."""
        return self.root / "build"

    @property
    def install(self) -> Path:
        """The folder into which packages are installed; see ``workspace_env``."""
        return self.root / "install"

    @property
    def devel(self) -> Path:
        """The prefix in which packages are their source folders; see `build.devel_space`."""
        return self.root / "devel"

    @property
    def log(self) -> Path:
        """Colcon's logs."""
        return self.root / "log"

    @property
    def static_info(self) -> Path:
        """The merged static information of the last build."""
        return self.root / MERGED_FILE


@dataclass(frozen=True, slots=True)
class BuildOptions:
    """How to build a workspace.

    Attributes:
        packages: names; these and the packages that they need are built. Empty: all.
        build_type: CMAKE_BUILD_TYPE.
        rules: the user's own rules, in addition to those of TPC.
        cmake_args: further arguments for each package's CMake.
        colcon_args: further arguments for colcon.
        constants: report comparisons with constants, too.
        tests: analyse test programs and scripts in folders of tests, and have them report.
        fallback: build a package without TPC if it does not build with TPC.
        retry: build packages with TPC again that earlier builds left alone.
        python: analyse Python nodes; if false, those of an earlier build are forgotten.
        python_rules: the user's own rules for Python.
        processes: analyse processes as a whole, across libraries and plugins; if false, each link
            unit alone.
        process_seconds: processor time for each of them; beyond it, its units are analysed alone.
        bases: the folders of the build; None: ``.tpc`` in the workspace.
    """

    packages: Sequence[str] = ()
    build_type: str = "RelWithDebInfo"
    rules: Path | None = None
    cmake_args: Sequence[str] = ()
    colcon_args: Sequence[str] = ()
    constants: bool = False
    tests: bool = False
    fallback: bool = True
    retry: bool = False
    python: bool = True
    python_rules: Path | None = None
    processes: bool = True
    process_seconds: int = 600
    bases: Bases | None = None


PLAIN_BUILD = BuildOptions()
"""The default settings."""


class BuildError(RunError):
    """A package did not build.

    ``tail`` is the end of what it wrote to standard error, ``finished`` are the packages that were
    built before that.
    """

    def __init__(
        self,
        message: str,
        path: Path,
        package: str,
        tail: Sequence[str],
        finished: frozenset[str] = frozenset(),
    ) -> None:
        """Keep the tail apart, because the message is one line."""
        super().__init__(message, path)
        self.package = package
        self.tail = tuple(tail)
        self.finished = finished


def colcon_command(
    bases: Bases,
    packages: Sequence[Package],
    toolchain: Path,
    options: BuildOptions = PLAIN_BUILD,
    *,
    exactly: bool = False,
) -> list[str]:
    """The command that builds packages with TPC.

    Args:
        bases: where everything is put.
        packages: the packages of the workspace; colcon is told their folders and searches none.
        toolchain: tpc.cmake.
        options: its ``packages``, ``build_type``, ``rules``, ``cmake_args`` and ``colcon_args``; a
            ``--cmake-args`` in the latter adds to ours.
        exactly: do not build what these packages need.

    Raises:
        WorkspaceError: ``colcon_args`` has an option that TPC sets itself.
    """
    rules, colcon_args = options.rules, options.colcon_args
    for argument in colcon_args:
        if argument.partition("=")[0] in _OWN_OPTIONS:
            raise WorkspaceError(f"{argument.partition('=')[0]} cannot be given: TPC sets it")
    for_cmake = [
        "--cmake-args",
        f"-DCMAKE_TOOLCHAIN_FILE={toolchain}",
        f"-DCMAKE_BUILD_TYPE={options.build_type}",
        # Empty, so that those of an earlier build do not stay in CMake's cache.
        f"-DTPC_RULES={rules.absolute() if rules is not None else ''}",
        f"-DTPC_BASE={bases.root}",
        "-DPYTHON_EXECUTABLE=/usr/bin/python3",
        *options.cmake_args,
    ]
    # Only the last of several --cmake-args counts, so each of the user's begins with ours.
    further: list[str] = []
    for argument in colcon_args:
        further += for_cmake if argument == "--cmake-args" else [argument]
    names = list(options.packages)
    if "--cmake-args" not in colcon_args:
        further += for_cmake
    # Colcon takes an unknown option for a value of the option before it. The user's options come
    # where no option is before them, so a misspelt one is an error.
    return [
        "colcon",
        "--log-base",
        str(bases.log),
        "build",
        *further,
        "--build-base",
        str(bases.build),
        "--install-base",
        str(bases.install),
        "--event-handlers",
        *_HANDLERS,
        "--paths",
        *(_unglobbed(str(package.path.absolute())) for package in packages),
        *([f"--packages-{'select' if exactly else 'up-to'}", *names] if names else []),
    ]


def build_environment() -> dict[str, str]:
    """The caller's environment without its Python's, conda's and make's settings; system first.

    The pipe of the job server of ``make -j`` does not reach us: a make below would run one job."""
    own = {"PYTHONHOME", "VIRTUAL_ENV", "PATH", "MAKELEVEL", "MFLAGS"}
    if "--jobserver" in os.environ.get("MAKEFLAGS", ""):
        own.add("MAKEFLAGS")
    conda = conda_prefix()
    if conda is not None:
        own |= {name for name in os.environ if name.startswith(("CONDA_", "_CE_"))}
        # Its compiler packages set these, for its own libraries.
        own |= {name for name in _FLAGS if str(conda) in os.environ.get(name, "")}
    environment = {name: value for name, value in os.environ.items() if name not in own}
    for name in _SEARCHED & environment.keys():
        environment[name] = without_conda(name, environment[name])
    return {**environment, "PATH": search_path(), "PYTHONUNBUFFERED": "1"}


def run_colcon(
    command: list[str],
    workspace: Path,
    bases: Bases,
    on_output: Callable[[str], None] | None,
    environment: Mapping[str, str],
) -> None:
    """Run colcon to its end; an interruption ends the compilers below it, too.

    Raises:
        BuildError: a package does not build.
        RunError: colcon itself fails, or the disk is full.
    """
    before = _latest_log(bases)
    said: list[str] = []

    def hear(line: str) -> None:
        said[:] = [*said[-_TAIL_LINES:], line]
        if on_output is not None:
            on_output(line)

    status = run_lines(command, workspace, environment, hear)
    if status != 0 and shutil.disk_usage(bases.root).free < _FULL:
        # No package is at fault, and colcon fails in many ways.
        raise RunError("the disk is full; free some space and build again", bases.root)
    latest = _latest_log(bases)
    if latest is not None and latest != before:
        _raise_for_failed_package(latest)
    if status != 0:
        end = next((line for line in reversed(said) if line), "it says nothing")
        raise RunError(f"colcon ends with status {status}: {end}")


def run_lines(
    command: Sequence[str],
    folder: Path,
    environment: Mapping[str, str],
    on_line: Callable[[str], None],
) -> int:
    """Run a program and return its status; it and its children end when this process ends.

    Args:
        command: the program and its arguments.
        folder: where it runs.
        environment: the whole environment.
        on_line: called with each line of both its outputs, without white space at the end.
    """
    program = partial(
        subprocess.Popen[str],
        command,
        cwd=folder,
        env=dict(environment),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    # SIGINT first: colcon then records what it did not build.
    with signals_end(), running(program, 10, 5) as process:
        for line in process.stdout or ():
            on_line(line.rstrip())
        return process.wait()


def _latest_log(bases: Bases) -> Path | None:
    link = bases.log / "latest_build"
    return link.resolve() if link.exists() else None


def ended_jobs(events: str) -> dict[str, str]:
    """Each package that ended or was skipped, with its status, from colcon's events.log.

    A status is a number as text, ``'SIGINT'`` in quotes, or ``skipped``.
    """
    statuses: dict[str, str] = {}
    for line in events.splitlines():
        event = _EVENT.match(line)
        if event is None:
            continue
        status = _STATUS.search(event["data"])
        statuses[event["name"]] = status["rc"] if status is not None else "skipped"
    return statuses


def _raise_for_failed_package(log: Path) -> None:
    events = log / "events.log"
    if not events.is_file():
        # colcon ended before the first package, and says why.
        return
    jobs = ended_jobs(events.read_text("utf-8", "replace"))
    finished = frozenset(name for name, status in jobs.items() if status == "0")
    for name, status in jobs.items():
        if status in _NO_FAULT:
            continue
        folder = log / name
        if not folder.is_dir() and (why := _own_error(log)):
            raise RunError(f"colcon itself fails: {why}", log / _ALL_OF_COLCON)
        tail = _tail(folder / "stderr.log") or _tail(folder / "stdout.log")
        raise BuildError(
            f"package {name} does not build (status {status}); this is its output",
            folder / "stdout_stderr.log",
            name,
            tail,
            finished,
        )


def _own_error(log: Path) -> str:
    """The last error of colcon itself, which ran no command; empty if there is none."""
    path = log / _ALL_OF_COLCON
    said = path.read_text("utf-8", "replace").splitlines() if path.is_file() else []
    return next((found[1] for line in reversed(said) if (found := _ERROR.match(line))), "")


def _tail(path: Path) -> list[str]:
    if not path.is_file():
        return []
    return path.read_text("utf-8", "replace").rstrip().splitlines()[-_TAIL_LINES:]


def _unglobbed(path: str) -> str:
    """Colcon expands a path with a star in it, and only such a path."""
    return escape(path) if "*" in path else path
