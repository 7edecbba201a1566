"""The ROS 2 of this machine: where it is, the Python that has it, and how a build is told of it.

A ROS 2 is taken if it was sourced (AMENT_PREFIX_PATH), or if its Python packages are in the virtual
environment that is active. One in ``/opt/ros`` that was not sourced is only named: which one is
meant, and with which workspaces, is the user's to say.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.paths import ROS_PREFIXES, ros_places

AMENT = "AMENT_PREFIX_PATH"
NAMED_PYTHON = "TPC_ROS2_PYTHON"
"""The variable by which a user names the Python that has rclpy."""
COLCON = "COLCON_PREFIX_PATH"
ROS_VERSION = "ROS_VERSION"
MARKERS = Path("share/ament_index/resource_index/packages")
"""Where a prefix has a file for each of its packages of ROS 2."""
SYSTEM_PYTHON = Path("/usr/bin/python3")
# Where a prefix has its Python packages: PyPI's and Debian's layouts, and that of Humble.
_PYTHON_PLACES = ("lib/python3*/*-packages", "local/lib/python3*/*-packages")
_CONFIG = "share/{0}/cmake/{0}Config.cmake"
# Lists of folders in which a build for ROS 1 would find packages of ROS 2 with the same names.
_SEARCHED = ("CMAKE_PREFIX_PATH", "LD_LIBRARY_PATH", "PKG_CONFIG_PATH", "PYTHONPATH", "PATH")


@dataclass(frozen=True, slots=True)
class Ros2:
    """A ROS 2: its prefixes, the first one first, and the Python under which its nodes run.

    ``is_sourced`` is false for a virtual environment, which no set-up file names.
    """

    prefixes: tuple[Path, ...]
    python: Path
    is_sourced: bool = True

    @property
    def words(self) -> str:
        """Which Python it is, and why."""
        if not self.is_sourced:
            return f"{self.python}, which has rclpy"
        return f"{self.python}, of the ROS 2 in {AMENT}"

    def has(self, package: str) -> bool:
        """Whether a CMake or Python package is in one of the prefixes."""
        return any(_has_package(prefix, package) for prefix in self.prefixes)


def find_ros2(environment: Mapping[str, str] = os.environ) -> Ros2 | None:
    """The ROS 2 that was sourced, else that of the active virtual environment; None without.

    Its Python is the one that the user names, if there is one.
    """
    sourced = _folders(environment, AMENT)
    named = named_python(environment)
    with_rclpy = next((prefix for prefix in sourced if has_module(prefix, "rclpy")), None)
    if with_rclpy is not None:
        # A prefix of conda or of PyPI's wheels has a Python of its own, one of Debian has none.
        own = with_rclpy / "bin/python3"
        return Ros2(tuple(sourced), named or (own if own.is_file() else SYSTEM_PYTHON))
    for python in [*([named] if named else []), *_other_pythons(environment)]:
        prefix = python.parent.parent
        if has_module(prefix, "rclpy"):
            return Ros2((prefix, *sourced), python, is_sourced=False)
    return Ros2(tuple(sourced), SYSTEM_PYTHON) if sourced else None


def named_python(environment: Mapping[str, str]) -> Path | None:
    """The Python that the user names; None where there is no such program."""
    named = environment.get(NAMED_PYTHON)
    found = shutil.which(named, path=environment.get("PATH", os.defpath)) if named else None
    return None if found is None else Path(found).absolute()


def likely_pythons(environment: Mapping[str, str]) -> list[Path]:
    """The Pythons that may have the rclpy of an environment, the likeliest first.

    Some may not: rclpy can be in any folder of PYTHONPATH.
    """
    named, ros2 = named_python(environment), find_ros2(environment)
    first = [named] if named else [] if ros2 is None else [ros2.python]
    return list(dict.fromkeys([*first, *_other_pythons(environment)]))


def setups_with_rclpy(prefixes: Iterable[Path] = ROS_PREFIXES) -> list[Path]:
    """The set-up files (for any shell) of installed distributions, the newest first."""
    return sorted(
        (
            prefix / "setup.sh"
            for prefix in prefixes
            if (prefix / "setup.sh").is_file() and has_module(prefix, "rclpy")
        ),
        reverse=True,
    )


def unsourced(
    environment: Mapping[str, str] = os.environ, prefixes: Iterable[Path] = ROS_PREFIXES
) -> list[Path]:
    """The set-up files of installed ROS 2 distributions that were not sourced, the newest first."""
    told = set(_folders(environment, AMENT))
    found = [
        prefix / "setup.bash"
        for prefix in prefixes
        if prefix not in told
        and (prefix / "share/ament_index").is_dir()
        and (prefix / "setup.bash").is_file()
    ]
    return sorted(found, reverse=True)


def how_to_source(
    environment: Mapping[str, str] = os.environ, prefixes: Iterable[Path] = ROS_PREFIXES
) -> str:
    """The command that gives a shell a ROS 2."""
    found = unsourced(environment, prefixes)
    return f"source {found[0] if found else '/opt/ros/DISTRO/setup.bash'}"


def default_ros(environment: Mapping[str, str] = os.environ) -> str:
    """The ROS of a package that is for both: what the environment says, else what is here."""
    told = environment.get(ROS_VERSION, "")
    if told in ("1", "2"):
        return told
    if environment.get(AMENT):
        return "2"
    listed = _folders(environment, "CMAKE_PREFIX_PATH")
    has_catkin = "catkin" in ros_places([*listed, *ROS_PREFIXES])
    return "2" if not has_catkin and find_ros2(environment) is not None else "1"


def for_ros2(environment: Mapping[str, str], ros2: Ros2 | None) -> dict[str, str]:
    """The environment of a build for ROS 2; what the caller has sourced comes first."""
    changed = {**environment, ROS_VERSION: "2"}
    if ros2 is not None:
        for name in ("CMAKE_PREFIX_PATH", AMENT):
            changed[name] = _joined([*_folders(environment, name), *ros2.prefixes])
    return changed


def for_ros1(environment: Mapping[str, str]) -> dict[str, str]:
    """The environment of a build for ROS 1, without the ROS 2 that was sourced beside it."""
    changed = {**environment, ROS_VERSION: "1"}
    of_ros2 = _folders(environment, AMENT)
    changed.pop(AMENT, None)
    for name in _SEARCHED if of_ros2 else ():
        kept = [
            folder
            for folder in _folders(environment, name)
            if not any(folder.is_relative_to(prefix) for prefix in of_ros2)
        ]
        if name in environment:
            changed[name] = _joined(kept)
    # Colcon's set-up files source the workspaces that are listed here.
    workspaces = _folders(changed, COLCON)
    if workspaces:
        changed[COLCON] = _joined(
            one for one in workspaces if not any(each.is_relative_to(one) for each in of_ros2)
        )
    return changed


def cmake_python(ros2: Ros2 | None) -> Path:
    """The Python under which the CMake files of ament run: it has ament_package."""
    if ros2 is not None:
        home = ros2.python.parent.parent
        if ros2.python != SYSTEM_PYTHON and has_module(home, "ament_package"):
            return ros2.python
    return SYSTEM_PYTHON


def has_module(prefix: Path, name: str) -> bool:
    """Whether a prefix has a Python package."""
    return any(
        (folder / name / "__init__.py").is_file()
        for place in _PYTHON_PLACES
        for folder in prefix.glob(place)
    )


def has_cmake_package(package: str, prefixes: Iterable[Path]) -> bool:
    """Whether `find_package` finds a package of ament in one of the prefixes."""
    return any((prefix / _CONFIG.format(package)).is_file() for prefix in prefixes)


def _has_package(prefix: Path, package: str) -> bool:
    return (prefix / "share" / package / "package.xml").is_file() or has_module(prefix, package)


def _other_pythons(environment: Mapping[str, str]) -> Iterator[Path]:
    """The Python of the active virtual environment, and the first one on the PATH."""
    active = environment.get("VIRTUAL_ENV")
    if active and (Path(active) / "bin/python3").is_file():
        yield Path(active).absolute() / "bin/python3"
    first = shutil.which("python3", path=environment.get("PATH", os.defpath))
    if first is not None:
        yield Path(first).absolute()


def _folders(environment: Mapping[str, str], name: str) -> list[Path]:
    return [Path(one) for one in environment.get(name, "").split(os.pathsep) if one]


def _joined(folders: Iterable[Path]) -> str:
    return os.pathsep.join(dict.fromkeys(map(str, folders)))
