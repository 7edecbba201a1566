"""Checks of the machine: programs, installed parts, environment, space. Nothing is changed.

``look_at_machine`` runs programs and reads files; the checks are functions of what it has seen.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.paths import (
    COLCON_EXTENSIONS,
    ROS_DISTRIBUTIONS,
    ROS_PACKAGES,
    ROS_PREFIXES,
    SYSTEM_PATH,
    build_tools,
    clang_release,
    conda_prefix,
    how_to_install,
    is_checkout,
    other_clangs,
    prefix,
    ros_places,
    search_path,
    sourced_prefixes,
    unsuited_clangs,
)
from pytpc.workspace.doctor.finding import Finding, error, note, warning
from pytpc.workspace.ros2 import find_ros2, has_module

# cmake_language(DEFER), by which tpc.cmake sees the finished targets, came with 3.19.
CMAKE_NEEDED = (3, 19)
MODULES: Mapping[str, str] = {"em": "python3-empy", "catkin_pkg": "python3-catkin-pkg"}
# Flags with which the compiler instruments the code by itself, and those of static programs.
UNSUITED = re.compile(
    r"-fsanitize=[^\s;\")]+|--coverage\b|-ftest-coverage\b|-fcoverage-mapping\b"
    r"|-fprofile-[^\s;\")]+|(?<![\w-])-static(?:-pie)?(?![\w-])"
)
_SYSTEM_PROGRAMS = Path("/usr/bin").resolve()
_MIB = 1024 * 1024
_PARTS = (
    "lib/tpc/TpcPasses.so",
    "lib/tpc/TpcDefer.so",
    "lib/libtpc_log.so",
    "share/tpc/cmake/tpc.cmake",
    "share/tpc/flags",
    "share/tpc/rules/ros1.json",
    "bin/tpc-clang++",
    "bin/tpc-merge",
    "bin/tpc-relink",
)
# What the log library loads in a node of ROS 1.
_ROS1_PART = "lib/libtpc_log_ros1.so"
# The same for ROS 2; it is built where rcl's headers are.
_ROS2_PART = "lib/libtpc_log_ros2.so"
_RCL, _RCL_HEADER = "lib/librcl.so", "include/rcl/rcl/rcl.h"
_PATIENCE_S = 60
# What /usr/bin/python3 is asked: a dictionary with "modules" and "colcon".
_QUESTION = """
import importlib, importlib.metadata as metadata, json, sys
modules, extensions = {}, []
for name in json.loads(sys.argv[1]):
    try:
        modules[name] = str(getattr(importlib.import_module(name), "__version__", ""))
    except Exception:
        pass
for name in json.loads(sys.argv[2]):
    try:
        metadata.distribution(name)
        extensions.append(name)
    except Exception:
        pass
print(json.dumps({"modules": modules, "colcon": extensions}))
"""


@dataclass(frozen=True, slots=True)
class InstalledProgram:
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
    build needs; spaces are in bytes; ``setup`` is what installs TPC's own half. ``release`` is
    that of the clang in use, ``other_clangs`` are those that TPC does not work with; ``unlinked``
    are libraries that the log library needs in a node of ROS 1 and that are not found; ``conda`` is
    the environment of conda that is active; ``rcl`` is the prefix of a ROS 2 that has rcl, with its
    headers if ``has_rcl_header``, and ``has_ros2_part`` is whether the log library can use it.
    """

    programs: Mapping[str, InstalledProgram] = field(default_factory=dict)
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
    release: str = "19"
    other_clangs: tuple[str, ...] = ()
    unlinked: tuple[str, ...] = ()
    conda: Path | None = None
    rcl: Path | None = None
    has_rcl_header: bool = True
    has_ros2_part: bool = True


def look_at_machine(folder: Path) -> Machine:
    """See what this machine has.

    Args:
        folder: the free space of its disk is checked; it need not exist.
    """
    programs = {
        name: InstalledProgram(Path(path), version_of(output_of([path, "--version"])))
        for name in build_tools()
        if (path := shutil.which(name, path=search_path())) is not None
    }
    python = shutil.which("python3")
    modules, extensions = _ask_python()
    missing = tuple(part for part in _PARTS if not (prefix() / part).exists())
    told = sourced_prefixes()
    release = clang_release()
    disk = folder.absolute()
    while not disk.exists():
        disk = disk.parent
    rcl = _prefix_of_rcl(os.environ)
    return Machine(
        programs=programs,
        python=None if python is None else Path(python),
        modules=modules,
        extensions=extensions,
        prefix=prefix(),
        missing_parts=missing,
        trial=None if missing or f"clang++-{release}" not in programs else _try_build(),
        ros=ros_places([*told, *ROS_PREFIXES]),
        environment=dict(os.environ),
        folders=frozenset(path for path in told if path.is_dir()),
        disk_folder=disk,
        disk_free=shutil.disk_usage(disk).free,
        memory_free=_free_memory(Path("/proc/meminfo")),
        setup="make setup" if is_checkout() else how_to_install(),
        ccache=ccache_settings(output_of(["ccache", "--show-config"])),
        release=release,
        other_clangs=tuple(other_clangs()),
        unlinked=_unlinked(prefix() / _ROS1_PART),
        conda=conda_prefix(),
        rcl=rcl,
        has_rcl_header=rcl is not None and (rcl / _RCL_HEADER).is_file(),
        has_ros2_part=(prefix() / _ROS2_PART).exists(),
    )


def _prefix_of_rcl(environment: Mapping[str, str]) -> Path | None:
    """That of the ROS 2 in use, else one where ROS is installed; one with headers comes first."""
    ros2 = find_ros2(environment)
    places = [*(ros2.prefixes if ros2 else ()), *ROS_PREFIXES]
    having = [place for place in places if (place / _RCL).exists()]
    return next((one for one in having if (one / _RCL_HEADER).is_file()), next(iter(having), None))


def version_of(said: str) -> tuple[int, ...]:
    """The first dotted number in the output of ``--version``; empty if there is none."""
    found = re.search(r"\b(\d+(?:\.\d+)+)", said)
    return tuple(map(int, found[1].split("."))) if found else ()


def ccache_settings(said: str) -> dict[str, str]:
    """The settings that ``ccache --show-config`` tells, each line as ``(origin) name = value``."""
    lines = re.findall(r"^\([^)]*\) (\w+) = (.*)$", said, re.MULTILINE)
    return dict(lines)


def _unlinked(library: Path) -> tuple[str, ...]:
    """What a library needs and does not find; itself where it was not built."""
    return unlinked_in(output_of(["ldd", str(library)])) if library.exists() else (library.name,)


def unlinked_in(said: str) -> tuple[str, ...]:
    """The libraries that ``ldd`` does not find."""
    return tuple(re.findall(r"^\s*(\S+) => not found$", said, re.MULTILINE))


def _ask_python() -> tuple[Mapping[str, str], frozenset[str]]:
    names = [json.dumps(list(MODULES)), json.dumps(COLCON_EXTENSIONS)]
    said = output_of(["/usr/bin/python3", "-c", _QUESTION, *names])
    try:
        answer = json.loads(said)
    except ValueError:
        return {}, frozenset()
    return answer["modules"], frozenset(answer["colcon"])


def _try_build() -> str | None:
    """Build a program with the wrapper, so that each installed part has to load."""
    with tempfile.TemporaryDirectory(prefix="tpc-doctor-") as name:
        source = Path(name) / "trial.cpp"
        source.write_text("int main() { return 0; }\n", encoding="utf-8")
        command = [str(prefix() / "bin/tpc-clang++"), source.name, "-o", "trial"]
        ran = _run(command, cwd=name)
        if ran is None:
            return "the compiler cannot be started or does not finish"
        if ran.returncode != 0:
            return next((line for line in ran.stderr.splitlines() if line), "it says nothing")
        if not (Path(name) / "tpc/trial.json").is_file():
            return "the passes were not run"
        return None


def _free_memory(file: Path) -> int:
    try:
        found = re.search(r"^MemAvailable:\s+(\d+) kB", file.read_text("ascii"), re.MULTILINE)
    except OSError:
        found = None
    return int(found[1]) * 1024 if found else 1 << 40


def output_of(command: Sequence[str]) -> str:
    """The output of a program; empty if it is not installed or takes too long."""
    ran = _run(command)
    return "" if ran is None else ran.stdout


def _run(command: Sequence[str], cwd: str | None = None) -> subprocess.CompletedProcess[str] | None:
    own = {"PYTHONHOME", "PYTHONPATH", "VIRTUAL_ENV"}
    kept = {
        name: value
        for name, value in os.environ.items()
        if name not in own and not name.startswith("TPC_")
    }
    try:
        return subprocess.run(
            list(command),
            cwd=cwd,
            env={**kept, "PATH": search_path() or SYSTEM_PATH},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_PATIENCE_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None


def check_machine(machine: Machine, *, for_ros1: bool = True) -> list[Finding]:
    """All findings about a machine, in the order in which they are best mended.

    Args:
        machine: what was seen.
        for_ros1: false if only packages of ROS 2 are to be built.
    """
    return [
        *_programs(machine),
        *_python(machine),
        *_installed(machine),
        *_ros(machine, for_ros1=for_ros1),
        *_environment(machine),
        *_space(machine),
        *_ccache(machine),
    ]


def _programs(machine: Machine) -> Iterator[Finding]:
    release = machine.release
    for name, packages in build_tools().items():
        if name not in machine.programs:
            others = unsuited_clangs(machine.other_clangs) if name == f"clang-{release}" else ""
            yield error(f"{name} is not installed{others}", mend=f"apt-get install {packages}")
    versions = {
        name: program.version
        for name, program in machine.programs.items()
        if name.endswith(f"-{release}") and program.version
    }
    if len(set(versions.values())) > 1:
        told = ", ".join(f"{name} {_dotted(version)}" for name, version in versions.items())
        yield warning(
            f"compiler, linker and archiver come from different releases: {told}",
            mend=f"apt-get install --only-upgrade clang-{release} lld-{release} llvm-{release}",
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
    if machine.conda is not None:
        yield note(
            "an environment of conda is active; `pytpc build` leaves its programs and libraries"
            " out, but other builds and nodes may use them",
            machine.conda,
            "conda deactivate",
        )
    elif machine.python is not None and machine.python.parent.resolve() != _SYSTEM_PROGRAMS:
        folder = machine.python.parent
        if has_module(folder.parent, "rclpy"):
            # It is the Python of ROS 2, which builds and nodes use.
            return
        owner, mend = "not the system's", 'export PATH="/usr/bin:$PATH"'
        if folder.name == "shims":
            owner = "pyenv's"
        elif machine.environment.get("VIRTUAL_ENV") == str(folder.parent):
            owner, mend = "that of a virtual environment", "deactivate"
        yield note(
            f"the first python3 on PATH is {owner}; `pytpc build`, `record` and `run` use"
            " /usr/bin/python3 all the same, but catkin_make, cmake and nodes that you start"
            " yourself in this terminal use the first one, which may have no ROS",
            machine.python,
            mend,
        )


def _installed(machine: Machine) -> Iterator[Finding]:
    if machine.missing_parts:
        yield error(
            f"the installed part of TPC is incomplete: {', '.join(machine.missing_parts)} missing",
            machine.prefix,
            "unset TPC_PREFIX" if "TPC_PREFIX" in machine.environment else machine.setup,
        )
    elif machine.unlinked and "roscpp" in machine.ros:
        yield error(
            f"the log library was built for another ROS: {', '.join(machine.unlinked)} not found",
            machine.prefix / _ROS1_PART,
            _build_log_library(machine.prefix, machine.release),
        )
    elif machine.trial is not None:
        yield error(
            f"a small program cannot be built with TPC: {machine.trial}",
            machine.prefix,
            machine.setup,
        )
    if not machine.missing_parts and machine.rcl is not None:
        yield _part_of_ros2(machine, machine.rcl)


def _part_of_ros2(machine: Machine, rcl: Path) -> Finding:
    if machine.has_ros2_part:
        return note("C++ nodes report to ROS 2: the log library was built for it", rcl)
    what = "the log library has no part for ROS 2, so C++ nodes of ROS 2 write files alone"
    if not machine.has_rcl_header:
        what += "; to build it, install the headers of rcl"
        is_debian = rcl.parent == ROS_DISTRIBUTIONS
        return warning(what, rcl, f"apt-get install ros-{rcl.name}-rcl" if is_debian else None)
    return warning(what, rcl, _build_log_library(machine.prefix, machine.release, rcl))


def _build_log_library(prefix: Path, release: str, rcl: Path | None = None) -> str:
    """The command; its compiler is one that is needed anyway, as there may be no g++."""
    place = shlex.quote(str(prefix))
    compilers = f"-DCMAKE_C_COMPILER=clang-{release} -DCMAKE_CXX_COMPILER=clang++-{release}"
    ros2 = "" if rcl is None else f" -DTPC_ROS2_PREFIX={shlex.quote(str(rcl))}"
    return (
        f"build=$(mktemp -d) && cmake -S {place}/share/tpc/runtime_log -B $build {compilers}"
        f" -DCMAKE_INSTALL_PREFIX={place}{ros2} && cmake --build $build --target install"
    )


def _ros(machine: Machine, *, for_ros1: bool) -> Iterator[Finding]:
    absent = [name for name in ("catkin", "roscpp") if name not in machine.ros]
    if absent and for_ros1:
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
        if value and not re.search(rf"clang(\+\+)?(-{machine.release})?$", value):
            yield note(
                f"{name}={value} is ignored: TPC's CMake file chooses clang {machine.release}",
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
