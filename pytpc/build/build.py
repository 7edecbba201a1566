"""Building a workspace with TPC: colcon, with tpc.cmake as the toolchain, in bases of its own.

``build_workspace`` does it all; ``pytpc.workspace.colcon`` runs the tool, ``pytpc.build.reconcile``
says what of the build was analysed.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import subprocess
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import check_rules
from pytpc.base.errors import RunError, WorkspaceError
from pytpc.base.paths import (
    SYSTEM_PATH,
    cmake_file,
    cmake_place,
    log_library,
    plugin,
    require_ros,
    require_tools,
)
from pytpc.build.collect import find_copies
from pytpc.build.devel_space import write_devel_space
from pytpc.build.doubled import doubled_sources
from pytpc.build.fallback import LeftAlone
from pytpc.build.missing import hint
from pytpc.build.python_nodes import PythonBuild, python_of_build
from pytpc.build.python_units import names_of
from pytpc.build.reconcile import left_out_units, stale_files
from pytpc.build.ros_parts import Part, parts_of, require_ros2, run_under
from pytpc.python_analysis.rules_file import Rules, load_rules
from pytpc.static.link_unit import LeftOut, LinkUnit
from pytpc.static.sources import with_source_digests
from pytpc.static.static_info import (
    StaticInfo,
    is_python_file,
    load_link_unit,
    manifest_of,
    unit_files,
)
from pytpc.workspace.cmake_targets import ask_for_targets
from pytpc.workspace.colcon import (
    PLAIN_BUILD,
    Bases,
    BuildError,
    BuildOptions,
    colcon_command,
    run_colcon,
)
from pytpc.workspace.enclosing import refuse_inside
from pytpc.workspace.packages import (
    Package,
    find_packages,
    packages_up_to,
    read_cmakelists,
    refuse_cycles,
    select_packages,
)
from pytpc.workspace.path_characters import refuse_characters
from pytpc.workspace.ros2 import Ros2, how_to_source

# How long a set-up script may take; those of large workspaces take seconds.
_SET_UP_S = 120.0


class Between(Protocol):
    """What happens to the link units of a build between its two links; see `pytpc.processes`."""

    def begin(self, folders: Sequence[Path]) -> None:
        """Before the first one.

        Args:
            folders: the build folders of the packages that are built.
        """

    def at_once(self, folder: Path) -> bool:
        """A package does not build so: let its units wait no longer; whether any did.

        Args:
            folder: its build folder.
        """

    def link_again(self) -> Collection[str]:
        """After it: the packages with units that have to be linked again."""


@dataclass(frozen=True, slots=True)
class BuildResult:
    """A build that succeeded.

    ``left_alone`` are packages that build only without TPC, each with the reason; ``seconds`` is
    wall time; ``ros2`` is what packages of ROS 2 were built for.
    """

    bases: Bases
    packages: tuple[Package, ...]
    static: StaticInfo
    left_alone: dict[str, str]
    seconds: float
    ros2: Ros2 | None = None

    @property
    def units(self) -> tuple[LinkUnit, ...]:
        """The link units, the failed ones among them."""
        return self.static.units


def build_workspace(
    workspace: Path,
    options: BuildOptions = PLAIN_BUILD,
    *,
    on_output: Callable[[str], None] | None = None,
    on_scripts: Callable[[int, int], None] | None = None,
    between: Between | None = None,
) -> BuildResult:
    """Build a workspace with analysis and instrumentation, and read what the analysis found.

    The Python nodes are analysed when the packages are built; their files stay as they are.

    Args:
        workspace: folder with packages; no file of theirs is changed.
        options: how it is to be built.
        on_output: called with each line that colcon writes.
        on_scripts: called with (scripts analysed, scripts in all).
        between: analyses what the units are part of; None: each unit is analysed when it is linked.

    Raises:
        WorkspaceError: no packages, an unknown name, a folder inside a workspace, one that cannot
            be written or that another build is at work in, or a build folder that was configured
            without TPC.
        InputError: a broken package.xml, CMakeLists.txt, file of rules or static information.
        MissingToolError: TPC's C++ half, a compiler, colcon or ROS is absent.
        BuildError: a package does not build.
        RunError: colcon itself fails.
    """
    began = time.monotonic()
    if ".." in workspace.parts:
        # colcon and CMake take that out of a path, and the names of folders have to be theirs.
        workspace = workspace.resolve()
    refuse_characters(workspace)
    found = find_packages(workspace)
    if options.bases is None:
        refuse_inside(workspace)
    refuse_cycles(found, workspace)
    chosen = select_packages(found, options.packages)
    for package in chosen:
        read_cmakelists(package)
    if options.rules is not None:
        check_rules(options.rules)
    rules = _python_rules(options)
    toolchain = _require_all(found)
    for package in chosen:
        refuse_characters(package.path)
    bases = options.bases if options.bases is not None else Bases.of(workspace)
    refuse_characters(bases.root)
    ros2 = require_ros2(found)
    build = _Build(workspace, bases, found, toolchain, options, ros2, between)
    if build.with_ours:
        _require_toolchain(bases, chosen, toolchain)
    scripts = PythonBuild(
        workspace,
        bases.build,
        found,
        chosen=packages_up_to(found, options.packages),
        rules=rules if options.python else None,
        tests=options.tests,
    )
    with _alone_in(bases):
        alone = build.run(on_output)
        write_devel_space(bases, found)
        build.run_again(alone, on_output)
        static = with_source_digests(_gather(scripts, alone.reasons, on_scripts))
        static.save(bases.static_info)
    seconds = time.monotonic() - began
    return BuildResult(bases, tuple(chosen), static, alone.reasons, seconds, ros2)


@dataclass(frozen=True, slots=True)
class _Build:
    """One build: colcon is run until all packages are built, with TPC or without."""

    workspace: Path
    bases: Bases
    packages: Sequence[Package]
    toolchain: Path
    options: BuildOptions
    ros2: Ros2 | None
    between: Between | None = None

    @property
    def with_ours(self) -> bool:
        """Whether the user did not choose another toolchain."""
        given = (*self.options.cmake_args, *self.options.colcon_args)
        return not any("CMAKE_TOOLCHAIN_FILE" in one for one in given)

    def run(self, on_output: Callable[[str], None] | None) -> LeftAlone:
        """Build the packages, and return those that are left alone.

        Raises:
            BuildError: a package builds neither with TPC nor without.
        """
        alone = _prepare(self.bases, self.packages, retry=self.options.retry)
        if self.between is not None and self.with_ours:
            chosen = packages_up_to(self.packages, self.options.packages)
            self.between.begin([self.bases.build / package.name for package in chosen])
        for part in parts_of(self.packages, self.options.packages, self.bases, self.ros2):
            self._run_part(part, alone, on_output)
        run_under(self.bases, self.packages, self.ros2)
        return alone

    def run_again(self, alone: LeftAlone, on_output: Callable[[str], None] | None) -> None:
        """Link again what has changed since the first time, and what uses it.

        Raises:
            BuildError: a package builds neither with TPC nor without.
        """
        if self.between is None or not self.with_ours:
            return
        wanted = set(self.between.link_again())
        chosen = packages_up_to(self.packages, self.options.packages)
        # What uses a library is out of date when that has been linked.
        names = [
            package.name
            for package in chosen
            if not wanted.isdisjoint(
                each.name for each in packages_up_to(self.packages, [package.name])
            )
        ]
        if not names:
            return
        for part in parts_of(self.packages, names, self.bases, self.ros2):
            self._run_part(part, alone, on_output, exactly=True)
        run_under(self.bases, self.packages, self.ros2)

    def _run_part(
        self,
        part: Part,
        alone: LeftAlone,
        on_output: Callable[[str], None] | None,
        *,
        exactly: bool = False,
    ) -> None:
        while True:
            command = self._command(part, alone, exactly=exactly)
            try:
                run_colcon(command, self.workspace, self.bases, on_output, part.environment)
            except BuildError as error:
                # Some code can only be linked after it was optimised.
                if any("ld.lld: " in line for line in error.tail) and self._waits(error.package):
                    continue
                if not (self.options.fallback and self.with_ours and alone.can_try(error)):
                    alone.give_up(error)
                    raise self._explained(error) from None
                if on_output is not None:
                    on_output(f"{error.package} does not build with TPC; building it without")
                alone.begin(error)
                _ask(self.bases, self.packages)
            else:
                alone.keep()
                return

    def _waits(self, package: str) -> bool:
        """Let the units of a package be analysed by their links; false if they were."""
        if self.between is None or not self.with_ours:
            return False
        return self.between.at_once(self.bases.build / package)

    def _explained(self, error: BuildError) -> BuildError:
        """The error, with what a package of ROS 2 lacks."""
        package = next((one for one in self.packages if one.name == error.package), None)
        if package is not None:
            said = hint(package, error.tail, self.ros2, how_to_source())
            error.message += f"; {said}" if said else ""
        return error

    def _command(self, part: Part, alone: LeftAlone, *, exactly: bool = False) -> list[str]:
        options = self.options
        by_process = options.processes and self.between is not None
        # Said both ways: a build folder keeps what it was told last.
        for_cmake = (
            f"-DTPC_CONSTANTS={'ON' if options.constants else 'OFF'}",
            f"-DTPC_TESTS={'ON' if options.tests else 'OFF'}",
            f"-DTPC_PROCESSES={'ON' if by_process else 'OFF'}",
            f"-DTPC_LEFT_ALONE={';'.join(map(str, alone.folders))}",
            *part.cmake_args,
            *options.cmake_args,
        )
        asked = replace(options, cmake_args=for_cmake, packages=part.names)
        return colcon_command(self.bases, part.packages, self.toolchain, asked, exactly=exactly)


def installed(workspace: Path) -> Path:
    """The folder with the ``setup.bash`` of a workspace.

    That is the folder of ``pytpc build`` if it was built, else ``install``, else ``devel``. If none
    is there, it is the folder of ``pytpc build``.
    """
    ours = Bases.of(workspace).install
    places = (ours, workspace / "install", workspace / "devel")
    return next((place for place in places if (place / "setup.bash").is_file()), ours)


def workspace_env(install_base: Path, begin: Mapping[str, str] | None = None) -> dict[str, str]:
    """The environment in which the nodes of an installed workspace run.

    Args:
        install_base: the folder with ``setup.bash``.
        begin: the environment in which it is sourced. None: that of a fresh login, with the
            caller's home, user, language, terminal and time zone.

    Raises:
        WorkspaceError: the folder is not an install base.
        RunError: the set-up script fails, or does not end.
    """
    script = install_base.absolute() / "setup.bash"
    if not script.is_file():
        raise WorkspaceError(
            "no setup.bash here; build the workspace first, with `pytpc build`", install_base
        )
    if begin is None:
        kept = ("HOME", "USER", "LOGNAME", "LANG", "LC_ALL", "TERM", "TZ", "TMPDIR")
        clean = {name: os.environ[name] for name in kept if name in os.environ}
        begin = {**clean, "PATH": SYSTEM_PATH}
    bash = ["/bin/bash", "--norc", "--noprofile", "-c"]
    try:
        ran = subprocess.run(
            [*bash, 'source "$1" >&2 && env -0', "bash", script],
            env=dict(begin),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_SET_UP_S,
            check=False,
            # A Ctrl-C is for the program that asks, which may go on.
            start_new_session=True,
        )
    except subprocess.TimeoutExpired as error:
        raise RunError(f"does not end within {_SET_UP_S:.0f} s", script) from error
    if ran.returncode != 0:
        said = ran.stderr.decode(errors="replace").strip().splitlines() or ["it says nothing"]
        raise RunError(f"fails with status {ran.returncode}: {said[-1]}", script)
    pairs = (os.fsdecode(entry).partition("=") for entry in ran.stdout.split(b"\0") if entry)
    shell_own = ("_", "SHLVL", "PWD", "OLDPWD")
    return {name: value for name, _, value in pairs if name not in shell_own}


def _require_all(packages: Sequence[Package]) -> Path:
    """Check that every tool is installed before anything is written; return tpc.cmake."""
    if not any(package.cmakelists.is_file() for package in packages):
        # Nothing is compiled: colcon is all that a workspace in Python alone needs.
        require_tools(["colcon"])
        return cmake_place()
    require_tools()
    if any(package.build_type == "catkin" for package in packages):
        require_ros()
    plugin()
    log_library()
    return cmake_file()


def _require_toolchain(bases: Bases, packages: Sequence[Package], toolchain: Path) -> None:
    """Check that no build folder was configured without this toolchain.

    CMake asks for the toolchain once, keeps it in CMakeSystem.cmake and ignores another one, so
    that the package would be built with the compiler of that time and not be analysed.
    """
    for package in packages:
        folder = bases.build / package.name
        for path in sorted(folder.glob("CMakeFiles/*/CMakeSystem.cmake")):
            if f'include("{toolchain}")' not in path.read_text("utf-8", "replace"):
                raise WorkspaceError(
                    "was configured without TPC, or with a TPC that has moved, and CMake keeps the"
                    " compiler of a build folder; delete this folder and build again",
                    folder,
                )


@contextlib.contextmanager
def _alone_in(bases: Bases) -> Iterator[None]:
    """Hold the bases against other builds: two would remove each other's folders.

    Where the folder cannot be locked, as on some network drives, nothing is checked.
    """
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            bases.root.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(bases.root, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
            stack.callback(os.close, descriptor)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise WorkspaceError(
                    "another pytpc build is running in this folder; wait until it ends, or build"
                    " in another folder with --base",
                    bases.root,
                ) from None
        yield


def _prepare(bases: Bases, packages: Sequence[Package], *, retry: bool) -> LeftAlone:
    try:
        _ask(bases, packages)
        alone = LeftAlone(bases, packages, retry=retry)
    except OSError as error:
        raise WorkspaceError(f"cannot be written: {error.strerror}", bases.root) from error
    ignore = bases.root / ".gitignore"
    if not ignore.exists():
        write_atomic(ignore, b"*\n")
    return alone


def _ask(bases: Bases, packages: Sequence[Package]) -> None:
    for package in packages:
        if package.cmakelists.is_file():
            ask_for_targets(bases.build / package.name)


def _gather(
    scripts: PythonBuild,
    left_alone: Mapping[str, str],
    on_scripts: Callable[[int, int], None] | None,
) -> StaticInfo:
    """The static information of all packages: the linker's, and that of Python scripts."""
    base = scripts.build_base
    folders = [
        folder for folder in (base / each.name for each in scripts.packages) if folder.is_dir()
    ]
    for folder in folders:
        for stale in stale_files(folder, _compiled(folder)):
            stale.unlink()
            manifest_of(stale).unlink(missing_ok=True)
    units = [load_link_unit(path) for folder in folders for path in _compiled(folder)]
    left_out = [*_left_out(folders, left_alone)]
    nodes = python_of_build(scripts, {*names_of(units), *names_of(left_out)}, on_scripts)
    units += nodes.units
    found = (*left_out, *nodes.left_out)
    return StaticInfo.of(units, base, find_copies(units), found, doubled_sources(folders, units))


def _compiled(folder: Path) -> list[Path]:
    """The files of the link units that CMake links; `pytpc.build.python_nodes` has the scripts."""
    return [path for path in unit_files(folder) if not is_python_file(path)]


def _python_rules(options: BuildOptions) -> Rules:
    """The rules for Python, with the constants and the profile of the analysis of C++."""
    given = (*options.cmake_args, *options.colcon_args)
    profile = "thesis" if "-DTPC_PROFILE=thesis" in given else "default"
    return replace(load_rules(profile, options.python_rules), constants=options.constants)


def _left_out(folders: Iterable[Path], left_alone: Mapping[str, str]) -> Iterator[LeftOut]:
    """The link units without static information; those of a package left alone for that reason."""
    for folder in folders:
        for unit in left_out_units(folder):
            if folder.name in left_alone:
                yield replace(unit, reason="its package does not build with TPC")
            else:
                yield unit
