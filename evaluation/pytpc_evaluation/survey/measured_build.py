"""The builds of a survey: each tree plain and with TPC, measured, by the same commands.

The two differ in the toolchain file alone: ours is ``tpc.cmake``, the plain one names the same
compilers. Processor time is the resource usage of the children that were waited for, colcon and
everything below it. What compilers and linkers take of it is noted by a launcher that CMake puts
before each of their commands, in both builds.
"""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.errors import InputError, RunError, TpcError, WorkspaceError
from pytpc.base.paths import clang_release, cmake_file, installed, require_tools
from pytpc.base.wording import plain
from pytpc.build.fallback import first_error
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import load_link_unit, unit_files
from pytpc.workspace.cmake_syntax import find_fault
from pytpc.workspace.cmake_targets import ask_for_targets, link_targets
from pytpc.workspace.colcon import (
    Bases,
    BuildOptions,
    build_environment,
    colcon_command,
    ended_jobs,
    run_lines,
)
from pytpc.workspace.packages import MANIFEST, Package, package_folders, read_manifest
from pytpc_evaluation.survey.missing_names import missing_names
from pytpc_evaluation.survey.trees import Build, NotBuilt, Tree, TreePackage

BUILD_TYPE = "RelWithDebInfo"
_PROJECT = re.compile(r"^[ \t]*project[ \t]*\(\s*\"?(?P<name>[^\s\"()$]+)", re.I | re.M)
# Bash knows its own children's times to the millisecond; where a comma is the decimal point it
# writes one.
_LAUNCHER = """#!/bin/bash
# Runs a compiler or a linker, and notes its processor time.
TIMEFORMAT='%U %S'
{ time "$@" 2>&3 3>&-; } 3>&2 2>>"${0%/*}/seconds"
"""


@dataclass(frozen=True, slots=True)
class Measured:
    """A build that was measured, and the static information that it left.

    ``without`` are link units that have none, ``unreadable`` what is there and cannot be read.
    """

    build: Build
    units: tuple[LinkUnit, ...] = ()
    without: tuple[str, ...] = ()
    unreadable: tuple[str, ...] = ()


def read_tree(folder: Path, name: str | None = None) -> Tree:
    """The packages of a tree; without any package.xml the folder itself is one plain CMake project.

    What no build can take (a broken package.xml or CMakeLists.txt, a second package of one name) is
    in ``unreadable``.

    Raises:
        WorkspaceError: no such folder, or neither packages nor a CMake project in it.
    """
    if not folder.is_dir():
        raise WorkspaceError("no such folder", folder)
    folder = Path(os.path.normpath(folder.absolute()))
    if any("\ud800" <= character <= "\udfff" for character in str(folder)):
        raise WorkspaceError("the path is not UTF-8, so no table can hold it", plain(str(folder)))
    packages: dict[str, TreePackage] = {}
    unreadable: list[NotBuilt] = []
    for place in package_folders(folder):
        try:
            package = _read_package(place)
            lists = place / "CMakeLists.txt"
            if lists.is_file() and (fault := find_fault(lists.read_bytes())) is not None:
                raise InputError(f"CMake cannot parse this: {fault.message}", lists, fault.line)
        except (InputError, OSError) as error:
            unreadable.append(NotBuilt(plain(place.name), plain(str(error))))
            continue
        first = packages.setdefault(package.name, package)
        if first is not package:
            unreadable.append(NotBuilt(package.name, f"{place}: {first.path} has this name, too"))
    lists = folder / "CMakeLists.txt"
    if not packages and not unreadable and lists.is_file():
        found = _PROJECT.search(lists.read_text("utf-8", "replace"))
        project = found["name"] if found is not None else folder.name
        packages[project] = TreePackage(project, folder, "cmake", frozenset())
    if not packages and not unreadable:
        raise WorkspaceError(f"neither a {MANIFEST} nor a CMakeLists.txt here", folder)
    return Tree(name or folder.name, folder, tuple(packages.values()), tuple(unreadable))


def underlaid(setups: Sequence[Path], jobs: int) -> dict[str, str]:
    """The environment of a survey's builds: the caller's, with set-up scripts sourced in order.

    Raises:
        WorkspaceError: a script is not there.
        RunError: a script fails.
    """
    for setup in setups:
        if not setup.is_file():
            raise WorkspaceError("no such set-up script", setup)
    if not setups:
        return _for_builds(build_environment(), jobs)
    ran = subprocess.run(
        [
            "/bin/bash",
            "--norc",
            "--noprofile",
            "-c",
            'for setup in "$@"; do source "$setup" >&2 || exit; done; env -0',
            "bash",
            *(str(setup.absolute()) for setup in setups),
        ],
        env=build_environment(),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        check=False,
    )
    if ran.returncode != 0:
        said = ran.stderr.decode(errors="replace").strip().splitlines() or ["it says nothing"]
        raise RunError(f"fails with status {ran.returncode}: {said[-1]}", setups[-1])
    pairs = (os.fsdecode(entry).partition("=") for entry in ran.stdout.split(b"\0") if entry)
    return _for_builds({name: value for name, _, value in pairs if name != "_"}, jobs)


@dataclass(frozen=True, slots=True)
class BuildWay:
    """How a tree is built.

    ``environment`` is that of the build (see ``underlaid``). ``instrumented`` is with tpc.cmake,
    else the same compilers are used and nothing else. ``jobs`` packages, and compilers in each, run
    at a time. ``cmake_args`` are further arguments for each package's CMake.
    """

    environment: Mapping[str, str]
    instrumented: bool
    jobs: int
    cmake_args: tuple[str, ...] = ()


def measure(
    tree: Tree,
    bases: Bases,
    way: BuildWay,
    on_output: Callable[[str], None] | None = None,
) -> Measured:
    """Build a tree from nothing, with TPC or without, and measure it.

    Args:
        tree: its packages that can be built; one that fails does not stop the others.
        bases: where everything is put; what is there is removed before.
        way: how it is built.
        on_output: called with each line that colcon writes.

    Raises:
        MissingToolError: a compiler, colcon or TPC's C++ half is absent.
        TpcError: the folder cannot be written.
    """
    require_tools()
    packages = [Package(one.name, one.path, one.build_type) for one in tree.packages]
    if not packages:
        return Measured(Build(0.0, 0.0, 0.0, tree.unreadable))
    try:
        if bases.root.exists():
            shutil.rmtree(bases.root)
        launcher = _write_launcher(bases.root)
        toolchain = cmake_file() if way.instrumented else _write_plain_toolchain(bases.root)
        for package in packages:
            if package.cmakelists.is_file():
                ask_for_targets(bases.build / package.name)
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror}", bases.root) from error
    kinds = [f"{language}_{kind}" for language in ("C", "CXX") for kind in ("COMPILER", "LINKER")]
    command = colcon_command(
        bases,
        packages,
        toolchain,
        BuildOptions(
            build_type=BUILD_TYPE,
            cmake_args=[
                *(f"-DCMAKE_{kind}_LAUNCHER={launcher}" for kind in kinds),
                *way.cmake_args,
            ],
            colcon_args=["--continue-on-error", "--parallel-workers", str(way.jobs)],
        ),
    )
    wall, processor, last = _run(command, tree.path, way.environment, on_output)
    faults = (*tree.unreadable, *_not_built(packages, bases.log / "latest_build", last))
    build = Build(wall, processor, _noted(launcher.with_name("seconds")), faults)
    if not way.instrumented:
        return Measured(build)
    return _static_information(build, packages, bases)


def _for_builds(environment: Mapping[str, str], jobs: int) -> dict[str, str]:
    """The environment with the number of jobs, without ccache and with flags for both builds."""
    changed = {**environment, "MAKEFLAGS": f"-j{jobs}", "CCACHE_DISABLE": "1"}
    # Else packages of ROS and Boost 1.74 would build with gcc and TPC, and not with clang alone.
    flags = installed("share/tpc/flags").read_text("utf-8").splitlines()
    accepted = " ".join(
        line.removeprefix("accept ") for line in flags if line.startswith("accept ")
    )
    for name in ("CFLAGS", "CXXFLAGS"):
        changed[name] = f"{accepted} {changed.get(name, '')}".strip()
    return changed


def _read_package(folder: Path) -> TreePackage:
    manifest = read_manifest(folder)
    needs = {*manifest.build_depends, *manifest.run_depends, *manifest.test_depends}
    return TreePackage(manifest.name, folder, manifest.build_type, frozenset(needs))


def _write_launcher(root: Path) -> Path:
    launcher = root / "launch" / "noted"
    launcher.parent.mkdir(parents=True)
    launcher.write_text(_LAUNCHER, encoding="ascii")
    launcher.chmod(0o755)
    return launcher


def _write_plain_toolchain(root: Path) -> Path:
    release = clang_release()
    names = (f"clang-{release}", f"clang++-{release}")
    compilers = require_tools(names)
    path = root / "launch" / "plain.cmake"
    path.write_text(
        f'set(CMAKE_C_COMPILER "{compilers[names[0]]}")\n'
        f'set(CMAKE_CXX_COMPILER "{compilers[names[1]]}")\n',
        encoding="utf-8",
    )
    return path


def _run(
    command: Sequence[str],
    folder: Path,
    environment: Mapping[str, str],
    on_output: Callable[[str], None] | None,
) -> tuple[float, float, str]:
    """Run colcon; returns wall and processor seconds, and what it says of itself at the end.

    That is all from the first line on that it calls an error, or else its last line.
    """
    used, began = _children(), time.monotonic()
    said: list[str] = []

    def hear(line: str) -> None:
        if said and "] ERROR:" in said[0]:
            said.append(line)
        elif line:
            said[:] = [line]
        if on_output is not None:
            on_output(line)

    run_lines(command, folder, environment, hear)
    return time.monotonic() - began, _children() - used, " ".join(" ".join(said).split())


def _children() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _noted(seconds: Path) -> float:
    """The sum of what the launcher wrote: a line of user and system seconds for each command."""
    if not seconds.is_file():
        return 0.0
    text = seconds.read_text("ascii", "replace").replace(",", ".")
    return sum(float(number) for number in text.split())


def _not_built(packages: Sequence[Package], log: Path, last: str) -> list[NotBuilt]:
    """The packages that were not built; ``last`` is colcon's last word where it built none."""
    events = log / "events.log"
    statuses = ended_jobs(events.read_text("utf-8", "replace")) if events.is_file() else {}
    if not statuses:
        reason = f"colcon builds nothing: {last or 'it says nothing'}"
        return [NotBuilt(package.name, reason) for package in packages]
    faults: list[NotBuilt] = []
    for package in packages:
        status = statuses.get(package.name, "skipped")
        if status == "skipped":
            faults.append(NotBuilt(package.name, "skipped: what it needs does not build"))
        elif status != "0":
            output = log / package.name / "stdout_stderr.log"
            text = output.read_text("utf-8", "replace") if output.is_file() else ""
            faults.append(NotBuilt(package.name, first_error(text), missing_names(text)))
    return faults


def _static_information(build: Build, packages: Sequence[Package], bases: Bases) -> Measured:
    """The build with the link units of its packages."""
    units: list[LinkUnit] = []
    without: list[str] = []
    unreadable: list[str] = []
    for package in packages:
        folder = bases.build / package.name
        files = unit_files(folder) if folder.is_dir() else []
        analysed = {path.stem for path in files}
        for path in files:
            try:
                units.append(load_link_unit(path))
            except InputError as error:
                unreadable.append(f"{package.name}/{path.stem}: {error}")
        try:
            targets = link_targets(folder) or []
        except InputError as error:
            unreadable.append(f"{package.name}/: {error}")
            continue
        without += [
            f"{package.name}/{target.name}"
            for target in targets
            if target.built and target.name not in analysed
        ]
    return Measured(build, tuple(units), tuple(without), tuple(unreadable))
