"""A workspace in the parts that one run of colcon can build: the packages of each ROS.

On a machine with both, packages of one name are in both (std_msgs), and conditions in manifests ask
for ``$ROS_VERSION``: packages of ROS 1 are built without the prefixes of ROS 2, and those of ROS 2
behind them. Plain CMake packages are built with the first part.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import sourced_prefixes
from pytpc.workspace.colcon import Bases, build_environment
from pytpc.workspace.packages import Package, packages_up_to
from pytpc.workspace.ros2 import (
    ROS_VERSION,
    SYSTEM_PYTHON,
    Ros2,
    cmake_python,
    default_ros,
    find_ros2,
    for_ros1,
    for_ros2,
    has_cmake_package,
    how_to_source,
)

_FIRST_LINE = re.compile(rb"#![^\n]*\n")
_COLCONS = f"#!{SYSTEM_PYTHON}\n".encode()


@dataclass(frozen=True, slots=True)
class Part:
    """Packages that one run of colcon builds.

    ``names`` are those that are asked for, as in ``BuildOptions.packages``; ``environment`` is
    colcon's, and ``cmake_args`` are what the packages' CMake is told of this ROS.
    """

    packages: tuple[Package, ...]
    names: tuple[str, ...]
    environment: Mapping[str, str]
    cmake_args: tuple[str, ...] = ()


def require_ros2(packages: Iterable[Package]) -> Ros2 | None:
    """The ROS 2 for those packages that need one; None if none was sourced or activated.

    Raises:
        MissingToolError: a package is built with ament_cmake, which is not there.
    """
    ament = [package for package in packages if package.ros == "2"]
    if not ament:
        return None
    ros2 = find_ros2()
    compiled = next((each for each in ament if each.cmakelists.is_file()), None)
    known = [*sourced_prefixes(), *(ros2.prefixes if ros2 else ()), Path("/usr")]
    if compiled is not None and not has_cmake_package("ament_cmake", known):
        raise MissingToolError(
            f"package {compiled.name} is for ROS 2, and ament_cmake was not found; in this"
            f" terminal, type: {how_to_source()}"
        )
    return ros2


def parts_of(
    packages: Sequence[Package], names: Sequence[str], bases: Bases, ros2: Ros2 | None
) -> list[Part]:
    """The parts of a workspace, in the order in which they are built.

    Args:
        packages: all of the workspace.
        names: those that are to be built, with what they need; empty: all.
        bases: of the build; what the first part installs there is found by the second one.
        ros2: what the packages of ROS 2 are built for.
    """
    caller = build_environment()
    versions = sorted({package.ros for package in packages if package.ros})
    if not versions:
        told = {ROS_VERSION: default_ros(), **caller}
        return [Part(tuple(packages), tuple(names), told)]
    if len(versions) == 1:
        return [_part(versions[0], packages, names, caller, ros2)]
    if _needs_other(packages, "1"):
        versions.reverse()
    reached = {package.name for package in packages_up_to(packages, names)}
    parts: list[Part] = []
    for version in versions:
        mine = [each for each in packages if (each.ros or versions[0]) == version]
        chosen = [each.name for each in mine if each.name in reached]
        if chosen:
            before = [each for part in parts for each in part.packages]
            found = _with_installed(caller, before, bases)
            asked = chosen if names else ()
            parts.append(_part(version, mine, asked, found, ros2))
    return parts


def run_under(bases: Bases, packages: Iterable[Package], ros2: Ros2 | None) -> None:
    """Let the installed scripts of packages in Python alone run under the Python of ROS 2.

    setuptools writes the first line for the Python that colcon runs under, Debian's. Only scripts
    that were copied are changed: a link leads to the user's own file.
    """
    if ros2 is None or ros2.python == SYSTEM_PYTHON:
        return
    line = f"#!{ros2.python}\n".encode()
    for package in packages:
        if package.build_type != "ament_python":
            continue
        for prefix in (bases.install / package.name, bases.install):
            for script in sorted((prefix / "lib" / package.name).glob("*")):
                if script.is_file() and not script.is_symlink():
                    _set_first_line(script, line)


def _set_first_line(script: Path, line: bytes) -> None:
    data = script.read_bytes()
    if data.startswith(_COLCONS):
        script.write_bytes(_FIRST_LINE.sub(lambda _: line, data, count=1))


def _part(
    version: str,
    packages: Sequence[Package],
    names: Sequence[str],
    caller: Mapping[str, str],
    ros2: Ros2 | None,
) -> Part:
    if version == "1":
        return Part(tuple(packages), tuple(names), for_ros1(caller))
    compiles = any(package.cmakelists.is_file() for package in packages)
    told = (f"-DPython3_EXECUTABLE={cmake_python(ros2)}",) if compiles else ()
    return Part(tuple(packages), tuple(names), for_ros2(caller, ros2), told)


def _needs_other(packages: Sequence[Package], version: str) -> bool:
    """Whether packages of one ROS need some of the other one, which are then built first."""
    others = {each.name for each in packages if each.ros not in ("", version)}
    return any(not others.isdisjoint(each.needs) for each in packages if each.ros == version)


def _with_installed(
    environment: Mapping[str, str], packages: Iterable[Package], bases: Bases
) -> dict[str, str]:
    """The environment with the places in front where packages are or will be installed."""
    folders = [str(bases.install / package.name) for package in packages]
    if not folders:
        return dict(environment)
    # That is where all of them are with --merge-install.
    folders.append(str(bases.install))
    listed = [one for one in environment.get("CMAKE_PREFIX_PATH", "").split(os.pathsep) if one]
    return {**environment, "CMAKE_PREFIX_PATH": os.pathsep.join([*folders, *listed])}
