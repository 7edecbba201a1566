"""Building a workspace with TPC: colcon, with tpc.cmake as the toolchain, in bases of its own.

The user's own build, install and log folders are not touched: everything goes below ``.tpc`` in the
workspace. ``build_workspace`` does it all; what it runs is worked out by pure functions.
"""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from glob import escape
from pathlib import Path

from pytpc.atomic import write_atomic
from pytpc.cmake_targets import LinkTarget, ask_for_targets, link_targets
from pytpc.errors import RunError, WorkspaceError
from pytpc.paths import (
    MERGED_FILE,
    OWN_FOLDER,
    SYSTEM_PATH,
    cmake_file,
    log_library,
    plugin,
    require_ros,
    require_tools,
    search_path,
)
from pytpc.rules import check_rules
from pytpc.static_info import LinkUnit, StaticInfo, collect, unit_files
from pytpc.workspace import Package, find_packages, read_cmakelists, select_packages

_TAIL_LINES = 25
_OWN_OPTIONS = ("--build-base", "--install-base", "--log-base", "--paths", "--base-paths")
_HANDLERS = ("console_direct+", "console_cohesion-", "console_stderr-", "summary-")
_JOB_ENDED = re.compile(
    r"^\[[0-9.]+\] \([^)]*\) JobEnded: \{'identifier': '(?P<name>[^']+)', 'rc': (?P<rc>.+)\}$",
    re.MULTILINE,
)


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
        """What the nodes are run from; see ``workspace_env``."""
        return self.root / "install"

    @property
    def log(self) -> Path:
        """Colcon's logs."""
        return self.root / "log"

    @property
    def static_info(self) -> Path:
        """The merged static information of the last build."""
        return self.root / MERGED_FILE


@dataclass(frozen=True, slots=True)
class BuildResult:
    """A build that succeeded.

    ``missing`` are targets that were linked and not analysed; ``seconds`` is wall time.
    """

    bases: Bases
    packages: tuple[Package, ...]
    static: StaticInfo
    missing: tuple[LinkTarget, ...]
    seconds: float

    @property
    def units(self) -> tuple[LinkUnit, ...]:
        """The link units, the failed ones among them."""
        return self.static.units


class BuildError(RunError):
    """A package did not build; ``tail`` is the end of what it wrote to standard error."""

    def __init__(self, message: str, path: Path, package: str, tail: Sequence[str]) -> None:
        """Keep the tail apart, because the message is one line."""
        super().__init__(message, path)
        self.package = package
        self.tail = tuple(tail)


def colcon_command(
    bases: Bases,
    packages: Sequence[Package],
    toolchain: Path,
    *,
    only: Iterable[str] = (),
    build_type: str = "RelWithDebInfo",
    rules: Path | None = None,
    cmake_args: Sequence[str] = (),
    colcon_args: Sequence[str] = (),
) -> list[str]:
    """The command that builds packages with TPC.

    Args:
        bases: where everything is put.
        packages: the packages of the workspace; colcon is told their folders and searches none.
        toolchain: tpc.cmake.
        only: names; these and what they need are built, or all where empty.
        build_type: CMAKE_BUILD_TYPE.
        rules: the user's own rules.
        cmake_args: further arguments for each package's CMake.
        colcon_args: further arguments for colcon; a ``--cmake-args`` in them adds to ours.

    Raises:
        WorkspaceError: ``colcon_args`` has an option that TPC sets itself.
    """
    for argument in colcon_args:
        if argument.partition("=")[0] in _OWN_OPTIONS:
            raise WorkspaceError(f"{argument.partition('=')[0]} cannot be given: TPC sets it")
    for_cmake = [
        "--cmake-args",
        f"-DCMAKE_TOOLCHAIN_FILE={toolchain}",
        f"-DCMAKE_BUILD_TYPE={build_type}",
        # Empty, so that those of an earlier build do not stay in CMake's cache.
        f"-DTPC_RULES={rules.absolute() if rules is not None else ''}",
        "-DPYTHON_EXECUTABLE=/usr/bin/python3",
        *cmake_args,
    ]
    # Of several --cmake-args the last one counts, so each of the user's has to begin with ours.
    further: list[str] = []
    for argument in colcon_args:
        further += for_cmake if argument == "--cmake-args" else [argument]
    names = list(only)
    if "--cmake-args" not in colcon_args:
        further += for_cmake
    # Colcon takes an option that it does not know for a value of the option before it, so what
    # the user gives stands where there is none and a slip of his is an error.
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
        *(["--packages-up-to", *names] if names else []),
    ]


def build_environment() -> dict[str, str]:
    """The caller's environment without his Python's and make's, the system's programs first.

    Under ``make -j`` the job server's pipe does not reach us, and a make below would run one job.
    """
    own = {"PYTHONHOME", "VIRTUAL_ENV", "PATH", "MAKELEVEL", "MFLAGS"}
    if "--jobserver" in os.environ.get("MAKEFLAGS", ""):
        own.add("MAKEFLAGS")
    environment = {name: value for name, value in os.environ.items() if name not in own}
    return {**environment, "PATH": search_path(), "PYTHONUNBUFFERED": "1"}


def build_workspace(
    workspace: Path,
    *,
    packages: Sequence[str] = (),
    build_type: str = "RelWithDebInfo",
    rules: Path | None = None,
    cmake_args: Sequence[str] = (),
    colcon_args: Sequence[str] = (),
    constants: bool = False,
    bases: Bases | None = None,
    on_output: Callable[[str], None] | None = None,
) -> BuildResult:
    """Build a workspace with analysis and instrumentation, and read what the analysis found.

    Args:
        workspace: folder with packages; no file of theirs is changed.
        packages: names; these and what they need are built, or all where empty.
        build_type: CMAKE_BUILD_TYPE.
        rules: the user's own rules, beside those that come with TPC.
        cmake_args: further arguments for each package's CMake.
        colcon_args: further arguments for colcon.
        constants: have comparisons with constants reported, too.
        bases: where everything is put; ``.tpc`` in the workspace by default.
        on_output: called with each line that colcon writes.

    Raises:
        WorkspaceError: no packages, an unknown name, a folder that cannot be written, or a build
            folder that was configured without TPC.
        InputError: a broken package.xml, CMakeLists.txt, file of rules or static information.
        MissingToolError: TPC's C++ half, a compiler, colcon or ROS is absent.
        BuildError: a package does not build.
        RunError: colcon itself fails.
    """
    began = time.monotonic()
    found = find_packages(workspace)
    chosen = select_packages(found, packages)
    for package in chosen:
        read_cmakelists(package)
    if rules is not None:
        check_rules(rules)
    toolchain = _require_all(found)
    place = bases if bases is not None else Bases.of(workspace)
    command = colcon_command(
        place,
        found,
        toolchain,
        only=packages,
        build_type=build_type,
        rules=rules,
        # Said both ways: a build folder keeps what it was told last.
        cmake_args=(f"-DTPC_CONSTANTS={'ON' if constants else 'OFF'}", *cmake_args),
        colcon_args=colcon_args,
    )
    if not any("CMAKE_TOOLCHAIN_FILE" in argument for argument in (*cmake_args, *colcon_args)):
        _require_toolchain(place, chosen, toolchain)
    _prepare(place, found)
    _run_colcon(command, workspace, place, on_output)
    missing = _reconcile(place, found)
    folders = (place.build / package.name for package in found)
    units = (unit for folder in folders if folder.is_dir() for unit in collect(folder).units)
    static = StaticInfo.of(units, place.build)
    static.save(place.static_info)
    return BuildResult(place, tuple(chosen), static, missing, time.monotonic() - began)


def workspace_env(install_base: Path) -> dict[str, str]:
    """The environment in which the nodes of an installed workspace run.

    It is what a fresh login would have after sourcing ``setup.bash``: of the caller's own
    environment only home, user, language, terminal and time zone are in it.

    Raises:
        WorkspaceError: the folder is not an install base.
        RunError: the set-up script fails.
    """
    script = install_base.absolute() / "setup.bash"
    if not script.is_file():
        raise WorkspaceError("no setup.bash here: build the workspace first", install_base)
    kept = ("HOME", "USER", "LOGNAME", "LANG", "LC_ALL", "TERM", "TZ", "TMPDIR")
    clean = {name: os.environ[name] for name in kept if name in os.environ}
    ran = subprocess.run(
        ["/bin/bash", "--norc", "--noprofile", "-c", 'source "$1" >&2 && env -0', "bash", script],
        env={**clean, "PATH": SYSTEM_PATH},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        check=False,
    )
    if ran.returncode != 0:
        said = ran.stderr.decode(errors="replace").strip().splitlines() or ["it says nothing"]
        raise RunError(f"fails with status {ran.returncode}: {said[-1]}", script)
    pairs = (os.fsdecode(entry).partition("=") for entry in ran.stdout.split(b"\0") if entry)
    shell_own = ("_", "SHLVL", "PWD", "OLDPWD")
    return {name: value for name, _, value in pairs if name not in shell_own}


def _require_all(packages: Sequence[Package]) -> Path:
    """See that everything is there before anything is written; returns tpc.cmake."""
    require_tools()
    if any(package.build_type == "catkin" for package in packages):
        require_ros()
    plugin()
    log_library()
    return cmake_file()


def _require_toolchain(bases: Bases, packages: Sequence[Package], toolchain: Path) -> None:
    """See that no build folder was configured without this toolchain.

    CMake asks for the toolchain once, keeps it in CMakeSystem.cmake and ignores another one, so
    that the package would be built with the compiler of that time and not be analysed.
    """
    for package in packages:
        folder = bases.build / package.name
        for path in sorted(folder.glob("CMakeFiles/*/CMakeSystem.cmake")):
            if f'include("{toolchain}")' not in path.read_text("utf-8", "replace"):
                raise WorkspaceError(
                    "was configured without TPC, or with one that was elsewhere, and CMake keeps"
                    " the compiler of a build folder; remove this folder",
                    folder,
                )


def _prepare(bases: Bases, packages: Sequence[Package]) -> None:
    try:
        for package in packages:
            if package.cmakelists.is_file():
                ask_for_targets(bases.build / package.name)
    except OSError as error:
        raise WorkspaceError(f"cannot be written: {error.strerror}", bases.root) from error
    ignore = bases.root / ".gitignore"
    if not ignore.exists():
        write_atomic(ignore, b"*\n")


def _run_colcon(
    command: list[str], workspace: Path, bases: Bases, on_output: Callable[[str], None] | None
) -> None:
    before = _latest_log(bases)
    said: list[str] = []
    with subprocess.Popen(
        command,
        cwd=workspace,
        env=build_environment(),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    ) as process:
        try:
            for line in process.stdout or ():
                said = [*said[-_TAIL_LINES:], line.rstrip()]
                if on_output is not None:
                    on_output(line.rstrip())
        except BaseException:
            end_group(process)
            raise
    latest = _latest_log(bases)
    if latest is not None and latest != before:
        _raise_for_failed_package(latest)
    if process.returncode != 0:
        end = next((line for line in reversed(said) if line), "it says nothing")
        raise RunError(f"colcon ends with status {process.returncode}: {end}")


def end_group(process: subprocess.Popen[str]) -> None:
    """End colcon and the compilers below it, gently first: colcon then records what it left."""
    for end, patience in ((signal.SIGINT, 10), (signal.SIGTERM, 5), (signal.SIGKILL, None)):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, end)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(timeout=patience)
            return


def _latest_log(bases: Bases) -> Path | None:
    link = bases.log / "latest_build"
    return link.resolve() if link.exists() else None


def _raise_for_failed_package(log: Path) -> None:
    for name, status in failed_jobs((log / "events.log").read_text("utf-8", "replace")):
        folder = log / name
        tail = _tail(folder / "stderr.log") or _tail(folder / "stdout.log")
        raise BuildError(
            f"package {name} does not build (status {status}); this is its output",
            folder / "stdout_stderr.log",
            name,
            tail,
        )


def failed_jobs(events: str) -> list[tuple[str, str]]:
    """The packages that failed by themselves, with their status, from colcon's events.log.

    Packages that were interrupted because another one failed are left out.
    """
    ended = [(match["name"], match["rc"]) for match in _JOB_ENDED.finditer(events)]
    return [(name, status) for name, status in ended if status not in ("0", "'SIGINT'")]


def _tail(path: Path) -> list[str]:
    if not path.is_file():
        return []
    return path.read_text("utf-8", "replace").rstrip().splitlines()[-_TAIL_LINES:]


def _reconcile(bases: Bases, packages: Sequence[Package]) -> tuple[LinkTarget, ...]:
    """Drop files of targets that are no more; return the targets that have no file."""
    missing: list[LinkTarget] = []
    for package in packages:
        folder = bases.build / package.name
        targets = link_targets(folder)
        if targets is None:
            continue
        names = {target.name for target in targets}
        files = unit_files(folder)
        for stale in (path for path in files if path.stem not in names):
            stale.unlink()
        analysed = {path.stem for path in files}
        missing += [target for target in targets if target.built and target.name not in analysed]
    return tuple(missing)


def _unglobbed(path: str) -> str:
    """Colcon expands a path with a star in it, and only such a path."""
    return escape(path) if "*" in path else path
