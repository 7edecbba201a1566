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
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pytpc.base.atomic import write_atomic
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
from pytpc.build.fallback import LeftAlone
from pytpc.build.python_nodes import python_of_build
from pytpc.build.python_units import names_of
from pytpc.build.reconcile import left_out_units, stale_files
from pytpc.python_analysis.rules_file import Rules, load_rules
from pytpc.static.rules import check_rules
from pytpc.static.static_info import (
    LeftOut,
    LinkUnit,
    StaticInfo,
    is_python_file,
    load_link_unit,
    unit_files,
)
from pytpc.workspace.cmake_targets import ask_for_targets
from pytpc.workspace.colcon import Bases, BuildError, colcon_command, run_colcon
from pytpc.workspace.packages import (
    Package,
    find_packages,
    packages_up_to,
    read_cmakelists,
    refuse_cycles,
    select_packages,
)


@dataclass(frozen=True, slots=True)
class BuildResult:
    """A build that succeeded.

    ``left_alone`` are packages that build only without TPC, each with the reason; ``seconds`` is
    wall time.
    """

    bases: Bases
    packages: tuple[Package, ...]
    static: StaticInfo
    left_alone: dict[str, str]
    seconds: float

    @property
    def units(self) -> tuple[LinkUnit, ...]:
        """The link units, the failed ones among them."""
        return self.static.units


def build_workspace(
    workspace: Path,
    *,
    packages: Sequence[str] = (),
    build_type: str = "RelWithDebInfo",
    rules: Path | None = None,
    cmake_args: Sequence[str] = (),
    colcon_args: Sequence[str] = (),
    constants: bool = False,
    tests: bool = False,
    fallback: bool = True,
    retry: bool = False,
    python: bool = True,
    python_rules: Path | None = None,
    bases: Bases | None = None,
    on_output: Callable[[str], None] | None = None,
    on_scripts: Callable[[int, int], None] | None = None,
) -> BuildResult:
    """Build a workspace with analysis and instrumentation, and read what the analysis found.

    The Python nodes are analysed when the packages are built; nothing is done to them.

    Args:
        workspace: folder with packages; no file of theirs is changed.
        packages: names; these and what they need are built, or all where empty.
        build_type: CMAKE_BUILD_TYPE.
        rules: the user's own rules, beside those that come with TPC.
        cmake_args: further arguments for each package's CMake.
        colcon_args: further arguments for colcon.
        constants: have comparisons with constants reported, too.
        tests: have test programs analysed and reporting, too; and scripts in folders of tests.
        fallback: build a package that does not build with TPC without it.
        retry: try the packages again that earlier builds left alone.
        python: analyse Python nodes; without, those of an earlier build are forgotten.
        python_rules: the user's own rules for Python.
        bases: where everything is put; ``.tpc`` in the workspace by default.
        on_output: called with each line that colcon writes.
        on_scripts: called with (scripts analysed, scripts in all).

    Raises:
        WorkspaceError: no packages, an unknown name, a folder that cannot be written or that
            another build is at work in, or a build folder that was configured without TPC.
        InputError: a broken package.xml, CMakeLists.txt, file of rules or static information.
        MissingToolError: TPC's C++ half, a compiler, colcon or ROS is absent.
        BuildError: a package does not build.
        RunError: colcon itself fails.
    """
    began = time.monotonic()
    if ".." in workspace.parts:
        # colcon and CMake take that out of a path, and the names of folders have to be theirs.
        workspace = workspace.resolve()
    found = find_packages(workspace)
    refuse_cycles(found, workspace)
    chosen = select_packages(found, packages)
    for package in chosen:
        read_cmakelists(package)
    if rules is not None:
        check_rules(rules)
    for_python = _python_rules(python_rules, (*cmake_args, *colcon_args), constants=constants)
    toolchain = _require_all(found)
    place = bases if bases is not None else Bases.of(workspace)
    with_ours = not any("CMAKE_TOOLCHAIN_FILE" in one for one in (*cmake_args, *colcon_args))
    if with_ours:
        _require_toolchain(place, chosen, toolchain)
    with _alone_in(place):
        alone = _prepare(place, found, retry=retry)
        while True:
            command = colcon_command(
                place,
                found,
                toolchain,
                only=packages,
                build_type=build_type,
                rules=rules,
                # Said both ways: a build folder keeps what it was told last.
                cmake_args=(
                    f"-DTPC_CONSTANTS={'ON' if constants else 'OFF'}",
                    f"-DTPC_TESTS={'ON' if tests else 'OFF'}",
                    f"-DTPC_LEFT_ALONE={';'.join(map(str, alone.folders))}",
                    *cmake_args,
                ),
                colcon_args=colcon_args,
            )
            try:
                run_colcon(command, workspace, place, on_output)
            except BuildError as error:
                if not (fallback and with_ours and alone.can_try(error)):
                    alone.give_up(error)
                    raise
                if on_output is not None:
                    on_output(f"{error.package} does not build with TPC; building it without")
                alone.begin(error)
                _ask(place, found)
            else:
                alone.keep()
                break
        static = _gather(
            workspace,
            place,
            found,
            alone.reasons,
            chosen=packages_up_to(found, packages),
            rules=for_python if python else None,
            tests=tests,
            on_scripts=on_scripts,
        )
        static.save(place.static_info)
    seconds = time.monotonic() - began
    return BuildResult(place, tuple(chosen), static, alone.reasons, seconds)


def installed(workspace: Path) -> Path:
    """The folder whose ``setup.bash`` is a workspace's: of ``pytpc build``, else of another build.

    Of these ``install`` comes before ``devel``. That of ``pytpc build`` where there is none.
    """
    ours = Bases.of(workspace).install
    places = (ours, workspace / "install", workspace / "devel")
    return next((place for place in places if (place / "setup.bash").is_file()), ours)


def workspace_env(install_base: Path, begin: Mapping[str, str] | None = None) -> dict[str, str]:
    """The environment in which the nodes of an installed workspace run.

    Args:
        install_base: the folder with ``setup.bash``.
        begin: the environment in which that is sourced. None: that of a fresh login; of the
            caller's own only home, user, language, terminal and time zone are in it.

    Raises:
        WorkspaceError: the folder is not an install base.
        RunError: the set-up script fails.
    """
    script = install_base.absolute() / "setup.bash"
    if not script.is_file():
        raise WorkspaceError("no setup.bash here: build the workspace first", install_base)
    if begin is None:
        kept = ("HOME", "USER", "LOGNAME", "LANG", "LC_ALL", "TERM", "TZ", "TMPDIR")
        clean = {name: os.environ[name] for name in kept if name in os.environ}
        begin = {**clean, "PATH": SYSTEM_PATH}
    ran = subprocess.run(
        ["/bin/bash", "--norc", "--noprofile", "-c", 'source "$1" >&2 && env -0', "bash", script],
        env=dict(begin),
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


@contextlib.contextmanager
def _alone_in(bases: Bases) -> Iterator[None]:
    """See that no other build is at work in the bases: two would take each other's folders away.

    Where the folder cannot be locked, as on some network drives, nothing is seen to.
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
                    "another pytpc build is at work in this folder; wait for its end, or give"
                    " this one a folder of its own with --base",
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
    workspace: Path,
    bases: Bases,
    packages: Sequence[Package],
    left_alone: Mapping[str, str],
    *,
    chosen: Sequence[Package],
    rules: Rules | None,
    tests: bool,
    on_scripts: Callable[[int, int], None] | None,
) -> StaticInfo:
    """What the linker left of all packages, and the Python of those that were built."""
    folders = [
        folder for folder in (bases.build / each.name for each in packages) if folder.is_dir()
    ]
    _drop_stale(folders)
    units = [load_link_unit(path) for folder in folders for path in _compiled(folder)]
    left_out = [*_left_out(folders, left_alone)]
    nodes = python_of_build(
        workspace,
        bases.build,
        packages,
        {*names_of(units), *names_of(left_out)},
        chosen=chosen,
        rules=rules,
        tests=tests,
        on_progress=on_scripts,
    )
    units += nodes.units
    found = (*left_out, *nodes.left_out)
    return StaticInfo.of(units, bases.build, find_copies(units), found)


def _drop_stale(folders: Iterable[Path]) -> None:
    for folder in folders:
        for stale in stale_files(folder, _compiled(folder)):
            stale.unlink()


def _compiled(folder: Path) -> list[Path]:
    """The files of what CMake links; those of scripts are `pytpc.build.python_nodes`'s."""
    return [path for path in unit_files(folder) if not is_python_file(path)]


def _python_rules(own: Path | None, arguments: Sequence[str], *, constants: bool) -> Rules:
    """The rules for Python: constants and profile are those that C++ is analysed with."""
    profile = "thesis" if "-DTPC_PROFILE=thesis" in arguments else "default"
    return replace(load_rules(profile, own), constants=constants)


def _left_out(folders: Iterable[Path], left_alone: Mapping[str, str]) -> Iterator[LeftOut]:
    """The link units without static information; those of a package left alone for that reason."""
    for folder in folders:
        for unit in left_out_units(folder):
            if folder.name in left_alone:
                yield replace(unit, reason="its package does not build with TPC")
            else:
                yield unit
