"""Where things are: the installed C++ half of TPC, and the tools that a build needs."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path

from pytpc.base.errors import MissingToolError

SYSTEM_PATH = "/usr/bin:/bin"

# What TPC writes in a workspace is below this folder, which colcon and catkin skip.
OWN_FOLDER = ".tpc"
MERGED_FILE = "static.json"

# Debian's package for each program, so that a message can say what to install.
BUILD_TOOLS: Mapping[str, str] = {
    "clang-19": "clang-19",
    "clang++-19": "clang-19",
    "ld.lld-19": "lld-19",
    "llvm-ar-19": "llvm-19",
    "llvm-ranlib-19": "llvm-19",
    "cmake": "cmake",
    "make": "make",
    "colcon": "colcon python3-colcon-ros python3-colcon-cmake python3-colcon-bash",
}
ROS_PACKAGES = "ros-core-dev libroscpp-dev"
ROS_PREFIXES = [*sorted(Path("/opt/ros").glob("*")), Path("/usr")]
_CMAKE_FILE = "share/tpc/cmake/tpc.cmake"
_ROS_PLACES = {
    "catkin": "share/catkin/cmake/catkinConfig.cmake",
    "roscpp": "include/ros/ros.h",
}


def project_root() -> Path:
    """The folder of the project: the one that holds the package ``pytpc``."""
    return Path(__file__).resolve().parents[2]


def is_checkout() -> bool:
    """True where pytpc runs from the project's own folder, false where it was installed."""
    return (project_root() / "passes" / "CMakeLists.txt").is_file()


def prefix() -> Path:
    """Where the C++ half is installed; the folder need not exist.

    ``$TPC_PREFIX``; else ``build/install`` of a checkout; else Python's own prefix.
    """
    chosen = os.environ.get("TPC_PREFIX")
    if chosen:
        return Path(chosen).absolute()
    return project_root() / "build" / "install" if is_checkout() else Path(sys.prefix)


def how_to_install() -> str:
    """What to type where the C++ half is not installed."""
    if is_checkout():
        return f"run `make setup` in {project_root()}"
    return "run `make setup` in a checkout of TPC, then export TPC_PREFIX=CHECKOUT/build/install"


def cmake_place() -> Path:
    """Where tpc.cmake is, or would be: it need not exist."""
    return prefix() / _CMAKE_FILE


def installed(place: str) -> Path:
    """A file of the installed C++ half.

    Raises:
        MissingToolError: it is not there; the message says how to install it.
    """
    path = prefix() / place
    if path.is_file():
        return path
    command = how_to_install()
    if os.environ.get("TPC_PREFIX"):
        other = f"unset TPC_PREFIX, or {command}" if is_checkout() else command
        raise MissingToolError(f"missing, and TPC_PREFIX points here; {other}", path)
    raise MissingToolError(f"TPC's compiler plugins are not installed; {command}", path)


cmake_file = partial(installed, _CMAKE_FILE)
plugin = partial(installed, "lib/tpc/TpcPasses.so")
# The plugin of clang that leaves its passes to the link.
defer_plugin = partial(installed, "lib/tpc/TpcDefer.so")
# The library that instrumented nodes report through.
log_library = partial(installed, "lib/libtpc_log.so")


def search_path() -> str:
    """The folders to look for programs in: the system's before those of the caller.

    A Python from somewhere else that comes first on PATH breaks catkin's generators.
    """
    caller = [
        folder
        for folder in os.environ.get("PATH", "").split(os.pathsep)
        if folder and folder not in SYSTEM_PATH.split(os.pathsep)
    ]
    return os.pathsep.join([SYSTEM_PATH, *caller])


def require_tools(names: Iterable[str] = BUILD_TOOLS) -> dict[str, Path]:
    """Find programs.

    Args:
        names: keys of ``BUILD_TOOLS``.

    Returns:
        The path of each program by its name.

    Raises:
        MissingToolError: one line with all that are absent and the command that installs them.
    """
    found: dict[str, Path] = {}
    absent: list[str] = []
    for name in names:
        path = shutil.which(name, path=search_path())
        if path is None:
            absent.append(name)
        else:
            found[name] = Path(path)
    if absent:
        packages = " ".join(dict.fromkeys(BUILD_TOOLS[name] for name in absent))
        raise MissingToolError(
            f"{_listed(absent)} not found on this machine; install it with:"
            f" apt-get install {packages}"
        )
    return found


def require_ros() -> None:
    """Check that ROS 1 (catkin and roscpp) is installed.

    It looks in ``$CMAKE_PREFIX_PATH``, in ``/opt/ros/*`` and in ``/usr``. The two may have
    different prefixes.

    Raises:
        MissingToolError: it is not installed; the message has the command that installs it.
    """
    listed = os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep)
    found = ros_places([*(Path(folder) for folder in listed if folder), *ROS_PREFIXES])
    absent = [name for name in _ROS_PLACES if name not in found]
    if absent:
        raise MissingToolError(
            f"{_listed(absent)} of ROS 1 not found on this machine; install it with:"
            f" apt-get install {ROS_PACKAGES}"
        )


def sourced_prefixes(environment: Mapping[str, str] = os.environ) -> list[Path]:
    """The folders whose set-up files were sourced, as an environment lists them."""
    return [
        Path(folder)
        for variable in ("CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH")
        for folder in environment.get(variable, "").split(os.pathsep)
        if folder
    ]


def ros_places(prefixes: Iterable[Path]) -> dict[str, Path]:
    """The first prefixes that hold catkin and roscpp, by name; without one that is nowhere."""
    found: dict[str, Path] = {}
    for prefix in prefixes:
        for name, place in _ROS_PLACES.items():
            if (prefix / place).is_file():
                found.setdefault(name, prefix)
    return found


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
