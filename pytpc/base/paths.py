"""Where things are: the installed C++ half of TPC, and the tools that a build needs."""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path

from pytpc.base.errors import MissingToolError, TpcError

SYSTEM_PATH = "/usr/bin:/bin"

# What TPC writes in a workspace is below this folder, which colcon and catkin skip.
OWN_FOLDER = ".tpc"
MERGED_FILE = "static.json"

# The releases of clang and LLVM that TPC works with; the first is taken if nothing says otherwise.
RELEASES = ("19", "22")
# Those without which colcon builds no catkin package.
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
ROS_PACKAGES = "ros-core-dev libroscpp-dev"
ROS_DISTRIBUTIONS = Path("/opt/ros")
ROS_PREFIXES = [*sorted(ROS_DISTRIBUTIONS.glob("*")), Path("/usr")]
_CMAKE_FILE = "share/tpc/cmake/tpc.cmake"
_RELEASE_FILE = "share/tpc/clang-version"
# The wheel has the C++ half here, in a folder per release: llvm-19, llvm-22.
_CARRIED = Path(__file__).resolve().parents[1] / "native"
# The Debian package has all of its Python side here.
_DEBIAN_HOME = Path("/usr/lib/pytpc")
_DEBIAN_PACKAGES = Path("/usr/lib/python3/dist-packages")
_ROS_PLACES = {
    "catkin": "share/catkin/cmake/catkinConfig.cmake",
    "roscpp": "include/ros/ros.h",
}


def home() -> Path:
    """The user's home folder.

    Raises:
        TpcError: there is none: HOME is not set, and the user has no account, as in a container.
    """
    try:
        return Path.home()
    except RuntimeError as error:
        raise TpcError("this user has no home folder; set HOME to one") from error


def project_root() -> Path:
    """The folder of the project: the one that holds the package ``pytpc``."""
    return Path(__file__).resolve().parents[2]


def is_checkout() -> bool:
    """True where pytpc runs from the project's own folder, false where it was installed."""
    return (project_root() / "passes" / "CMakeLists.txt").is_file()


def prefix() -> Path:
    """Where the C++ half is installed; the folder need not exist.

    ``$TPC_PREFIX``; else ``build/install`` of a checkout; else what the wheel carries for
    ``$TPC_CLANG_VERSION``, or for the first release whose compiler is installed.
    """
    chosen = os.environ.get("TPC_PREFIX")
    if chosen:
        return Path(chosen).absolute()
    if is_checkout():
        return project_root() / "build" / "install"
    return _CARRIED / f"llvm-{_wanted_release()}"


def _wanted_release() -> str:
    chosen = os.environ.get("TPC_CLANG_VERSION")
    if chosen:
        return Path(chosen).name
    there = (one for one in RELEASES if (_CARRIED / f"llvm-{one}").is_dir())
    path = search_path()
    return next((one for one in there if shutil.which(f"clang++-{one}", path=path)), RELEASES[0])


def clang_release() -> str:
    """The release of clang that the installed C++ half is for; the wanted one if none is there."""
    try:
        return (prefix() / _RELEASE_FILE).read_text("ascii").strip()
    except (OSError, ValueError):
        return RELEASES[0] if is_checkout() else _wanted_release()


def build_tools() -> Mapping[str, str]:
    """Debian's package for each program that a build needs."""
    release = clang_release()
    return {
        f"clang-{release}": f"clang-{release}",
        f"clang++-{release}": f"clang-{release}",
        f"ld.lld-{release}": f"lld-{release}",
        f"llvm-ar-{release}": f"llvm-{release}",
        f"llvm-ranlib-{release}": f"llvm-{release}",
        "cmake": "cmake",
        "make": "make",
        "colcon": " ".join(["colcon", *(f"python3-{name}" for name in COLCON_EXTENSIONS)]),
    }


def how_to_install() -> str:
    """What to type where the C++ half is not installed."""
    if is_checkout():
        return f"run `make setup` in {project_root()}"
    if _DEBIAN_HOME in _CARRIED.parents:
        return "apt-get install --reinstall pytpc"
    wheel = f"{sys.executable} -m pip install --force-reinstall --no-deps WHEEL"
    return f"{wheel}, with the WHEEL that `make package` writes in a checkout of TPC"


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
    release = os.environ.get("TPC_CLANG_VERSION")
    if release and release not in RELEASES:
        raise MissingToolError(
            f"TPC_CLANG_VERSION is {release}: TPC works with clang {_listed([*RELEASES])};"
            " unset TPC_CLANG_VERSION"
        )
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
        for folder in without_conda("PATH", os.environ.get("PATH", "")).split(os.pathsep)
        if folder and folder not in SYSTEM_PATH.split(os.pathsep)
    ]
    return os.pathsep.join([SYSTEM_PATH, *caller])


def conda_prefix() -> Path | None:
    """The environment of conda that is active, unless it has ROS itself."""
    told = os.environ.get("CONDA_PREFIX")
    if not told or ros_places([Path(told)]):
        return None
    return Path(told)


def without_conda(name: str, value: str) -> str:
    """A list of folders without those of conda's environment, nor those of pyenv's shims.

    Their libraries, CMake files and Python are not those that Debian's ROS is built with.
    """
    conda = conda_prefix()
    kept = []
    for folder in value.split(os.pathsep):
        path = Path(folder)
        of_conda = conda is not None and (path == conda or conda in path.parents)
        is_shims = name == "PATH" and path.name == "shims" and (path.parent / "versions").is_dir()
        if not (of_conda or is_shims):
            kept.append(folder)
    return os.pathsep.join(kept)


def other_clangs(path: str | None = None) -> list[str]:
    """The releases of clang on this machine that TPC does not work with, in order."""
    found = {
        release[1]
        for folder in (path or search_path()).split(os.pathsep)
        for program in Path(folder).glob("clang-[1-9]*")
        if (release := re.fullmatch(r"clang-(\d+)", program.name)) and release[1] not in RELEASES
    }
    return sorted(found, key=int)


def unsuited_clangs(releases: Sequence[str]) -> str:
    """A remark on the compilers that are here but of no use; empty if there are none."""
    if not releases:
        return ""
    return f" (here is clang {_listed(releases)}; TPC works with clang {_listed(RELEASES)})"


def require_tools(names: Iterable[str] | None = None) -> dict[str, Path]:
    """Find programs.

    Args:
        names: keys of ``build_tools``; None: all.

    Returns:
        The path of each program by its name.

    Raises:
        MissingToolError: one line with all that are absent and the command that installs them.
    """
    found: dict[str, Path] = {}
    absent: list[str] = []
    tools = build_tools()
    for name in tools if names is None else names:
        path = shutil.which(name, path=search_path())
        if path is None:
            absent.append(name)
        else:
            found[name] = Path(path)
    if absent:
        packages = " ".join(dict.fromkeys(tools[name] for name in absent))
        lacks_clang = any(name.startswith("clang") for name in absent)
        others = unsuited_clangs(other_clangs()) if lacks_clang else ""
        raise MissingToolError(
            f"{_listed(absent)} not found on this machine{others}; install it with:"
            f" apt-get install {packages}"
        )
    return found


def reach_debians_packages() -> None:
    """Let this Python import rospy and its kin from where Debian installs them.

    A virtual environment does not look there. What it has itself comes first.
    """
    if str(_DEBIAN_PACKAGES) not in sys.path:
        sys.path.append(str(_DEBIAN_PACKAGES))


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


def _listed(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
