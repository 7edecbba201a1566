"""Checks of the machine: programs, installed parts, environment, space. No check touches it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.paths import BUILD_TOOLS, ROS_PACKAGES, sourced_prefixes
from pytpc.workspace.doctor.finding import Finding, error, note, warning

# cmake_language(DEFER), by which tpc.cmake sees the finished targets, came with 3.19.
CMAKE_NEEDED = (3, 19)
RELEASE_TOOLS = ("clang-19", "clang++-19", "ld.lld-19", "llvm-ar-19", "llvm-ranlib-19")
COLCON_EXTENSIONS = (
    "colcon-bash",
    "colcon-cmake",
    "colcon-metadata",
    "colcon-output",
    "colcon-package-selection",
    "colcon-parallel-executor",
    "colcon-recursive-crawl",
    "colcon-ros",
)
MODULES: Mapping[str, str] = {"em": "python3-empy", "catkin_pkg": "python3-catkin-pkg"}
# Flags with which the compiler instruments the code by itself, and those of static programs.
UNSUITED = re.compile(
    r"-fsanitize=[^\s;\")]+|--coverage\b|-ftest-coverage\b|-fcoverage-mapping\b"
    r"|-fprofile-[^\s;\")]+|(?<![\w-])-static(?:-pie)?(?![\w-])"
)
_MIB = 1024 * 1024


@dataclass(frozen=True, slots=True)
class Program:
    """A program on PATH and its version as numbers; none where it says none."""

    path: Path
    version: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Machine:
    """What ``look_at_machine`` saw.

    ``programs`` by name; ``python`` is the first python3 on the caller's PATH, ``modules`` the
    versions of what /usr/bin/python3 can import, ``extensions`` those of colcon that it has;
    ``missing_parts`` files of TPC's installed half that are not there; ``trial`` what went wrong
    when a small program was built with it; ``ros`` names and prefixes of the ROS packages that a
    build needs; spaces are in bytes; ``setup`` is what installs TPC's own half.
    """

    programs: Mapping[str, Program] = field(default_factory=dict)
    python: Path | None = None
    modules: Mapping[str, str] = field(default_factory=dict)
    extensions: frozenset[str] = frozenset()
    prefix: Path = Path("/")
    missing_parts: tuple[str, ...] = ()
    trial: str | None = None
    ros: Mapping[str, Path] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)
    folders: frozenset[Path] = frozenset()
    disk_folder: Path = Path("/")
    disk_free: int = 1 << 40
    memory_free: int = 1 << 40
    setup: str = "make setup"
    ccache: Mapping[str, str] = field(default_factory=dict)


def check_machine(machine: Machine) -> list[Finding]:
    """All findings about a machine, in the order in which they are best mended."""
    return [
        *_programs(machine),
        *_python(machine),
        *_installed(machine),
        *_ros(machine),
        *_environment(machine),
        *_space(machine),
        *_ccache(machine),
    ]


def _programs(machine: Machine) -> Iterator[Finding]:
    for name, packages in BUILD_TOOLS.items():
        if name not in machine.programs:
            yield error(f"{name} is not installed", mend=f"apt-get install {packages}")
    versions = {
        name: machine.programs[name].version
        for name in RELEASE_TOOLS
        if name in machine.programs and machine.programs[name].version
    }
    if len(set(versions.values())) > 1:
        told = ", ".join(f"{name} {_dotted(version)}" for name, version in versions.items())
        yield warning(
            f"compiler, linker and archiver come from different releases: {told}",
            mend="apt-get install --only-upgrade clang-19 lld-19 llvm-19",
        )
    cmake = machine.programs.get("cmake")
    if cmake is not None and cmake.version and cmake.version < CMAKE_NEEDED:
        yield error(
            f"CMake {_dotted(cmake.version)} is too old: {_dotted(CMAKE_NEEDED)} is needed",
            cmake.path,
            "pip install cmake",
        )
    absent = [name for name in COLCON_EXTENSIONS if name not in machine.extensions]
    if "colcon" in machine.programs and absent:
        yield error(
            f"colcon has no {', '.join(name.removeprefix('colcon-') for name in absent)}",
            mend=f"apt-get install {' '.join('python3-' + name for name in absent)}",
        )


def _python(machine: Machine) -> Iterator[Finding]:
    for module, package in MODULES.items():
        if module not in machine.modules:
            yield error(
                f"/usr/bin/python3 cannot import {module}, which catkin's generators need",
                mend=f"apt-get install {package}",
            )
    if machine.modules.get("em", "3").startswith(("4", "5")):
        yield error(
            f"empy {machine.modules['em']} is too new for catkin's generators",
            mend="/usr/bin/python3 -m pip uninstall empy && apt-get install python3-empy",
        )
    if machine.python is not None and machine.python != Path("/usr/bin/python3"):
        yield note(
            "the first python3 on PATH is not the system's; `pytpc build` does not use it,"
            " but CMake does",
            machine.python,
            "cmake -DPYTHON_EXECUTABLE=/usr/bin/python3 ...",
        )


def _installed(machine: Machine) -> Iterator[Finding]:
    if machine.missing_parts:
        yield error(
            f"the installed part of TPC is incomplete: {', '.join(machine.missing_parts)} missing",
            machine.prefix,
            "unset TPC_PREFIX" if "TPC_PREFIX" in machine.environment else machine.setup,
        )
    elif machine.trial is not None:
        yield error(
            f"a small program cannot be built with TPC: {machine.trial}",
            machine.prefix,
            machine.setup,
        )


def _ros(machine: Machine) -> Iterator[Finding]:
    absent = [name for name in ("catkin", "roscpp") if name not in machine.ros]
    if absent:
        yield warning(
            f"{' and '.join(absent)} of ROS 1 not found: catkin packages cannot be built",
            mend=f"apt-get install {ROS_PACKAGES}",
        )
    told = sourced_prefixes(machine.environment)
    found = (re.match(r"/opt/ros/([^/]+)", str(folder)) for folder in told)
    distributions = list(dict.fromkeys(match[1] for match in found if match))
    sourced = machine.environment.get("ROS_DISTRO")
    if len(distributions) > 1:
        yield warning(
            f"set-up files of several ROS distributions were sourced: {', '.join(distributions)}",
            "CMAKE_PREFIX_PATH",
            "start a new shell and source one of them",
        )
    elif sourced and distributions and distributions != [sourced]:
        yield warning(
            f"ROS_DISTRO is {sourced}, but the paths are those of {distributions[0]}",
            "ROS_DISTRO",
            "start a new shell and source one of them",
        )
    for folder in dict.fromkeys(told):
        if folder not in machine.folders:
            yield warning(
                "a set-up file of a folder that does not exist was sourced",
                folder,
                "start a new shell and source an existing set-up file",
            )


def _environment(machine: Machine) -> Iterator[Finding]:
    for name in ("CC", "CXX"):
        value = machine.environment.get(name, "")
        if value and not re.search(r"clang(\+\+)?(-19)?$", value):
            yield note(
                f"{name}={value} is ignored: TPC's CMake file chooses clang 19",
                name,
                f"unset {name}",
            )
    for name in ("CFLAGS", "CXXFLAGS", "CPPFLAGS", "LDFLAGS"):
        found = UNSUITED.search(machine.environment.get(name, ""))
        if found is not None:
            yield warning(
                f"{found[0]} cannot be combined with TPC: nothing will be instrumented",
                name,
                f"unset {name}",
            )
    if machine.environment.get("TPC_DISABLE", "").upper() not in ("", "0", "OFF", "NO", "FALSE"):
        yield warning("the compiler wrappers are switched off", "TPC_DISABLE", "unset TPC_DISABLE")


def _space(machine: Machine) -> Iterator[Finding]:
    free = machine.disk_free // _MIB
    if free < 200:
        yield error(f"{free} MiB are free on this disk", machine.disk_folder, "df -h")
    elif free < 2048:
        yield warning(
            f"{free} MiB are free on this disk; a workspace with debug information may take more",
            machine.disk_folder,
            "df -h",
        )
    memory = machine.memory_free // _MIB
    if memory < 2048:
        yield warning(
            f"{memory} MiB of memory are free; the link of a large node may take more",
            mend="pytpc build WS -- --executor sequential",
        )


def _ccache(machine: Machine) -> Iterator[Finding]:
    if machine.ccache.get("compiler_check") == "none":
        yield warning(
            "ccache ignores which compiler runs and may return objects of another one",
            "ccache",
            "ccache --set-config compiler_check=mtime",
        )
    if machine.ccache.get("run_second_cpp") == "false":
        yield warning(
            "ccache compiles preprocessed source, so that columns are reported wrongly",
            "ccache",
            "ccache --set-config run_second_cpp=true",
        )


def _dotted(version: tuple[int, ...]) -> str:
    return ".".join(map(str, version))
